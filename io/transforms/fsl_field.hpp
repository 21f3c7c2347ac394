/// @file fsl_field.hpp
/// Warp fields of FSL.
#pragma once
#include <string>

#include <tetwarp/transform_file.hpp>

#include "io/nifti/nifti_header.hpp"

namespace tetwarp {

/// Whether a NIfTI image is meant as a warp field of FSL: by its intent, or because it is said.
bool is_fsl_field(const NiftiHeader& header, const TransformReadOptions& options);

/// Opens one. FSL's coordinates of a voxel are its indices times the voxel sizes, with the first
/// index counted from the other end in images whose axes are right-handed in the world (those
/// without a form are taken as left-handed). A field holds, for each of its voxels, a position in
/// such coordinates of the image to warp: as it is (absolute), or minus those of the voxel
/// (relative).
///
/// Where it is not said what the numbers are, all of them are read once.
/// @param world     itk_factor() of the image to warp
/// @throws IoError  as open_transform(); when the numbers fit neither kind clearly
TransformParts open_fsl_field(const std::string& path,
                              const TransformReadOptions& options,
                              const Point3& world);

}  // namespace tetwarp
