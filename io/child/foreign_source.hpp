/// @file foreign_source.hpp
/// Images that tetwarp-read reads, as volumes.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include <tetwarp/io.hpp>

#include "io/files/volume_source.hpp"

namespace tetwarp {

VolumeHeader read_foreign_volume_header(const std::string& path, const VolumeReadOptions& options);

/// The whole array is read at once; where parts of it are needed, to a temporary file first.
std::unique_ptr<VolumeSource> open_foreign_source(const std::string& path,
                                                  const std::string& array,
                                                  std::int64_t step,
                                                  const VolumeReadOptions& options);

}  // namespace tetwarp
