/// @file memory.hpp
/// How much memory an input may take.
#pragma once
#include <string>

namespace tetwarp {

/// Bytes that can be allocated without swapping, as the kernel estimates it.
double available_memory();

/// Bytes that this process holds in memory now.
double resident_memory();

/// "1.5 GiB".
std::string bytes_text(double bytes);

}  // namespace tetwarp
