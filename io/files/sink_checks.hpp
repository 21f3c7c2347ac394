/// @file sink_checks.hpp
/// What the sinks of image files check, and what they report when the disk fails.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

namespace tetwarp {

/// The array of a file that holds a single one; its grid is checked as well.
/// @param format  for messages, e.g. "a NIfTI image"
/// @throws IoError  there is not one array, or the grid is not valid
const ArrayHeader& only_array(const std::string& path,
                              const std::string& format,
                              const Grid& grid,
                              const std::vector<ArrayHeader>& arrays);

/// @throws IoError  the time of a step is not finite, which no reader takes
void check_time(const std::string& path, double time);

/// @throws IoError  always: a write has failed for the reason in errno
[[noreturn]] void throw_disk_error(const std::string& path);

}  // namespace tetwarp
