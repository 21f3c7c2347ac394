/// @file nifti_volume.hpp
/// Reading volumes of NIfTI files.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include <tetwarp/io.hpp>

#include "io/files/volume_source.hpp"

namespace tetwarp {

VolumeHeader read_nifti_volume_header(const std::string& path, const VolumeReadOptions& options);
std::unique_ptr<VolumeSource> open_nifti_source(const std::string& path,
                                                const std::string& array,
                                                std::int64_t step,
                                                const VolumeReadOptions& options);

}  // namespace tetwarp
