/// @file nifti_extension.hpp
/// The extension of a NIfTI header that holds the fingerprint of a warp.
#pragma once
#include <string>
#include <vector>

#include "io/nifti/nifti_header.hpp"

namespace tetwarp {

/// A comment extension (code 6) `tetwarp_fingerprint HASH`, padded to 16 bytes; empty without one.
std::vector<char> fingerprint_extension(const std::string& fingerprint);

/// The fingerprint in a single file whose samples begin at byte `data_offset`; empty: none.
std::string read_fingerprint_extension(const std::string& path,
                                       bool is_swapped,
                                       std::size_t header_bytes,
                                       std::int64_t data_offset);

}  // namespace tetwarp
