/// @file image_volume.hpp
/// NRRD files, MetaImages and FreeSurfer's images as volumes.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include <tetwarp/io.hpp>

#include "io/files/volume_source.hpp"

namespace tetwarp {

/// Whether a file is one of these.
bool is_image(const std::string& path);

/// @param axes  of vectors and tensors in the file, which are turned to RAS
/// @throws IoError  as component_map() when others are to be turned
VolumeHeader read_image_volume_header(const std::string& path, Axes axes);
std::unique_ptr<VolumeSource> open_image_source(const std::string& path,
                                                const std::string& array,
                                                std::int64_t step,
                                                const VolumeReadOptions& options);

}  // namespace tetwarp
