/// @file slice_pieces.hpp
/// A box of bytes divided into pieces that are copied one after the other.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "kernels/base/slice_bytes.hpp"

namespace tetwarp {

/// The rows to copy of successive slices, or a part of those of one slice.
struct SlicePiece {
  std::size_t offset;  ///< of the first byte in the array
  std::size_t run;     ///< bytes without a gap
  std::size_t slices;  ///< runs, a slice apart from each other

  std::size_t size() const { return run * slices; }
};

/// Whether the bytes of all slices follow each other without a gap.
inline bool is_contiguous(const SliceBytes& part) {
  return part.slices == 1 || part.rows == part.pitch;
}

/// Pieces of at most `most` bytes in the order of the array. The last ones get smaller, down to an
/// eighth, so that `takers` threads, which take pieces in order, end at about the same time.
/// @param most  > 0
inline std::vector<SlicePiece> pieces_of(const SliceBytes& part,
                                         std::size_t most,
                                         std::size_t takers) {
  constexpr std::size_t page = 4096;
  const bool is_one_run = is_contiguous(part);
  const std::size_t slices = is_one_run ? 1 : part.slices;
  const std::size_t run = part.row * part.rows * (is_one_run ? part.slices : 1);
  const std::size_t slice = part.row * part.pitch;
  const std::size_t least = std::max<std::size_t>(1, most / 8);
  std::vector<SlicePiece> pieces;
  std::size_t left = run * slices, number = 0, in_run = 0;
  while (left > 0) {
    const std::size_t size = std::clamp(left / takers / page * page, least, most);
    if (in_run == 0 && run <= size) {
      const std::size_t count = std::min(size / run, slices - number);
      pieces.push_back({number * slice, run, count});
      number += count;
    } else {
      pieces.push_back({number * slice + in_run, std::min(size, run - in_run), 1});
      in_run += pieces.back().run;
      if (in_run == run) {
        in_run = 0;
        ++number;
      }
    }
    left -= pieces.back().size();
  }
  return pieces;
}

}  // namespace tetwarp
