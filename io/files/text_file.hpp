/// @file text_file.hpp
/// Files of text that are read whole.
#pragma once
#include <string>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// Throws IoError unless a path can be opened for reading and is no folder.
TETWARP_IO_EXPORT void check_readable(const std::string& path);

/// What a file, or a pipe, holds. Throws IoError if it cannot be read.
TETWARP_IO_EXPORT std::string read_text(const std::string& path);

}  // namespace tetwarp
