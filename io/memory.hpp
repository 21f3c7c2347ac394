/// @file memory.hpp
/// Memory of this machine and of this process.
#pragma once
#include <string>

namespace tetwarp {

/// Bytes that can be allocated without swapping, as the kernel estimates it.
double available_memory();

/// Bytes that this process holds in memory now.
double resident_memory();

/// A size for messages: "1.5 GiB".
std::string bytes_text(double bytes);

}  // namespace tetwarp
