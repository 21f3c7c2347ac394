/// @file extension.hpp
/// Ends of the names of files.
#pragma once
#include <string>
#include <string_view>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// True when a name ends with `end`, in small or in capital letters. @param end  in small letters
TETWARP_IO_EXPORT bool has_extension(const std::string& path, std::string_view end);

}  // namespace tetwarp
