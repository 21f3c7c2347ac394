/// @file nifti_extension.hpp
/// The extensions of a NIfTI header, of which one holds the fingerprint of a warp.
#pragma once
#include <string>
#include <vector>

#include "io/nifti/nifti_header.hpp"

namespace tetwarp {

/// A comment extension (code 6) `tetwarp_fingerprint HASH`, padded to 16 bytes; empty without one.
std::vector<char> fingerprint_extension(const std::string& fingerprint);

struct NiftiExtensions {
  std::string fingerprint;          ///< empty: none
  std::vector<std::string> others;  ///< "extension of code 4, 96 bytes"
};

/// Reads the extensions that follow a header, up to the first one that is damaged.
/// @param end  byte at which they end at the latest: of a single file the first sample
NiftiExtensions read_extensions(const std::string& path,
                                bool is_swapped,
                                std::size_t header_bytes,
                                std::int64_t end);

}  // namespace tetwarp
