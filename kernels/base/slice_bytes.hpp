/// @file slice_bytes.hpp
/// A box of bytes of an array, for copies.
#pragma once
#include <cstddef>

namespace tetwarp {

/// The same rows of successive slices.
struct SliceBytes {
  std::size_t row;    ///< bytes per row; the other sizes count rows
  std::size_t rows;   ///< to copy from each slice
  std::size_t pitch;  ///< from one slice to the next
  std::size_t slices;
};

}  // namespace tetwarp
