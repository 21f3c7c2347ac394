/// @file memory.hpp
/// Memory of this machine and of this process.
#pragma once
#include <string>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// Bytes that can be allocated without swapping, as the kernel estimates it.
TETWARP_IO_EXPORT double available_memory();

/// Bytes that this process holds in memory now.
TETWARP_IO_EXPORT double resident_memory();

/// A size for messages: "1.5 GiB".
TETWARP_IO_EXPORT std::string bytes_text(double bytes);

}  // namespace tetwarp
