/// @file input_check.hpp
/// Whether a file that is written is one that is read.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// The absolute path with links and dots resolved, also of a file that does not exist.
TETWARP_IO_EXPORT std::string canonical_path(const std::string& path);

/// Throws IoError if an output is one of the inputs, or would be.
TETWARP_IO_EXPORT void check_no_input(const std::string& output,
                                      const std::vector<std::string>& inputs);

}  // namespace tetwarp
