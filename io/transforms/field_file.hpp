/// @file field_file.hpp
/// Displacement fields in NIfTI images, NRRD files, MetaImages and VTKHDF volumes.
#pragma once
#include <string>

#include <tetwarp/transform_file.hpp>

namespace tetwarp {

/// @throws IoError  as open_transform()
TransformParts open_nifti_field(const std::string& path, const TransformReadOptions& options);
TransformParts open_image_field(const std::string& path, const TransformReadOptions& options);
TransformParts open_volume_field(const std::string& path);

}  // namespace tetwarp
