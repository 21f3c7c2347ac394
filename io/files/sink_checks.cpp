/// @file sink_checks.cpp
/// One array on a valid grid, and the message about a full disk.
#include "io/files/sink_checks.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace tetwarp {

const ArrayHeader& only_array(const std::string& path,
                              const std::string& format,
                              const Grid& grid,
                              const std::vector<ArrayHeader>& arrays) {
  if (arrays.size() != 1) {
    throw IoError(path, "",
                  format + " holds one array, not " + std::to_string(arrays.size()) +
                      "; write a VTKHDF file");
  }
  try {
    check_grid(grid, "grid");
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "", error.what());
  }
  return arrays.front();
}

void check_time(const std::string& path, double time) {
  if (std::isfinite(time)) return;
  throw IoError(path, "",
                "the time of a step is " + std::to_string(time) + ", expected a finite number");
}

void throw_disk_error(const std::string& path) {
  throw IoError(path, "",
                std::string("cannot be written: ") + std::strerror(errno) +
                    "; check the free space of the disk");
}

}  // namespace tetwarp
