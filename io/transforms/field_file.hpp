/// @file field_file.hpp
/// Displacement fields in NIfTI images, NRRD files, MetaImages and VTKHDF volumes.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include <tetwarp/transform_file.hpp>

namespace tetwarp {

/// @param world     itk_factor() of the positions that the field is for
/// @throws IoError  as open_transform()
TransformParts open_nifti_field(const std::string& path,
                                const TransformReadOptions& options,
                                const Point3& world);
TransformParts open_image_field(const std::string& path,
                                const TransformReadOptions& options,
                                const Point3& world);
TransformParts open_volume_field(const std::string& path,
                                 const TransformReadOptions& options,
                                 const Point3& world);

/// @throws IoError  about a voxel whose displacement is not finite
[[noreturn]] void fail_not_finite(const std::string& path,
                                  const std::array<std::int64_t, 3>& voxel);

}  // namespace tetwarp
