/// @file vti_write.hpp
/// Writing VTK's XML images (.vti): samples follow the header as they are, so that regions of them
/// can be written in any order.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "io/files/volume_sink.hpp"

namespace tetwarp {

/// Throws what make_vti_sink() throws about its arguments, and writes nothing.
void check_vti(const std::string& path,
               const Grid& grid,
               const std::vector<ArrayHeader>& arrays,
               bool is_temporal);

/// A file of one step, with all arrays.
/// @throws IoError  the file would be temporal, has no array or no valid grid, or cannot be written
std::unique_ptr<VolumeSink> make_vti_sink(const std::string& path,
                                          const Grid& grid,
                                          const std::vector<ArrayHeader>& arrays,
                                          const VolumeWriteOptions& options,
                                          bool is_temporal);

}  // namespace tetwarp
