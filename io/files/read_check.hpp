/// @file read_check.hpp
/// A function that long reads call from time to time, such as the unpacking of gigabytes.
#pragma once
#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// Sets what is called between parts of images, of at most 1 MiB or one slice; it may throw to end
/// the read. Not called within a read of HDF5. Null: nothing. To be set before threads read.
TETWARP_IO_EXPORT void set_read_check(void (*check)());

/// Calls it.
void check_read();

}  // namespace tetwarp
