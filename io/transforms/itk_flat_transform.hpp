/// @file itk_flat_transform.hpp
/// Transforms of ITK that are of two dimensions.
#pragma once
#include <string>

#include "io/transforms/itk_transform.hpp"

namespace tetwarp {

/// Distance of grid points along the third axis that fields of slices get: they are the same in all
/// planes across it that an image may have [mm].
inline constexpr double flat_thickness = 0x1p20;

/// Whether a transform takes points of two dimensions to such points.
bool is_flat(const ItkTransform& transform);

/// The transform of three dimensions that is this one in all planes across the third axis; one of a
/// type that is not read as it is.
/// @throws IoError  on other numbers of parameters
ItkTransform lifted(const std::string& path, const ItkTransform& transform);

}  // namespace tetwarp
