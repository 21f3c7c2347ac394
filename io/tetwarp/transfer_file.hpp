/// @file transfer_file.hpp
/// Transfer functions of pictures of volumes in files.
#pragma once
#include <string>

#include <tetwarp/cast.hpp>
#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// Reads {"length": L, "points": [{"value": V, "color": [R, G, B], "opacity": O}, ...]}.
/// @param length  TransferFunction::unit_length where the file has no `length`
/// @throws IoError  naming file and key: no JSON, a key that is unknown or missing, numbers out of
///                  range, values that do not ascend
TETWARP_IO_EXPORT TransferFunction read_transfer_function(const std::string& path, double length);

}  // namespace tetwarp
