/// @file output_check.hpp
/// Whether a file of a volume can hold what is to be written to it.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// Throws what BlockVolumeWriter throws about its arguments: types, components, names and numbers
/// of arrays and steps that the format of the file does not hold. Creates nothing.
TETWARP_IO_EXPORT void check_volume_output(const std::string& path,
                                           const Grid& grid,
                                           const std::vector<ArrayHeader>& arrays,
                                           const VolumeWriteOptions& options,
                                           bool is_temporal);

}  // namespace tetwarp
