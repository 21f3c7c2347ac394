/// @file line_grid.hpp
/// The order in which the cpu back end visits cells: lines along x. A piece of work is a few
/// neighboring lines, which read parts of the source that are in the cache already.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>

#include "kernels/base/view.hpp"

namespace tetwarp {

/// The lines and pieces of an output frame.
class LineGrid {
 public:
  static constexpr int longest_line = 64;  ///< [cell]
  static constexpr int piece_lines = 8;    ///< lines per piece

  /// Cells [ci_begin, ci_end) along x at (cj, ck).
  struct Line {
    int ci_begin, ci_end, cj, ck;
  };

  explicit LineGrid(const OutputFrame& frame)
      : cells_{frame.cells[0], frame.cells[1], frame.cells[2]},
        segments_((frame.cells[0] + longest_line - 1) / longest_line) {}

  int longest() const { return std::min(cells_[0], longest_line); }
  std::int64_t count() const { return std::int64_t{segments_} * cells_[1] * cells_[2]; }
  std::int64_t piece_count() const { return (count() + piece_lines - 1) / piece_lines; }

  /// Lines [first, past) of a piece.
  std::pair<std::int64_t, std::int64_t> piece(std::int64_t p) const {
    return {p * piece_lines, std::min(count(), (p + 1) * piece_lines)};
  }

  /// Line number l; lines with neighboring cj have successive numbers.
  Line line(std::int64_t l) const {
    const int cj = static_cast<int>(l % cells_[1]);
    const std::int64_t rest = l / cells_[1];
    const int segment = static_cast<int>(rest % segments_);
    const int begin = segment * longest_line;
    return {begin, std::min(begin + longest_line, cells_[0]), cj,
            static_cast<int>(rest / segments_)};
  }

 private:
  int cells_[3];
  int segments_;
};

}  // namespace tetwarp
