/// @file vtkhdf_volume.hpp
/// Reading VTKHDF ImageData.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include <tetwarp/io.hpp>

#include "io/files/volume_source.hpp"

namespace tetwarp {

VolumeHeader read_vtkhdf_header(const std::string& path);
std::unique_ptr<VolumeSource> open_vtkhdf_source(const std::string& path,
                                                 const std::string& array,
                                                 std::int64_t step);

}  // namespace tetwarp
