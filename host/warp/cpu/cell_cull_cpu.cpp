/// @file cell_cull_cpu.cpp
/// Implementation by Highway, compiled once per vector instruction set.
#include "host/warp/cpu/cell_cull_cpu.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/warp/cpu/cell_cull_cpu.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Voxels along an axis that a cell shares with a tetrahedron's box, from the anchor on.
struct CellSpan {
  CellSpan(const TetSetup& tet, const OutputFrame& frame, int axis, int cell) {
    const int low = cell * cell_edge, high = low + cell_edge;
    const int begin = std::max(low, tet.begin[axis]), end = std::min(high, tet.end[axis]);
    first = static_cast<double>(begin - tet.anchor[axis]);
    last = static_cast<double>(end - 1 - tet.anchor[axis]);
    is_whole = begin == std::max(low, frame.begin[axis]) && end == std::min(high, frame.end[axis]);
  }

  double first;
  double last;
  bool is_whole;  ///< the box contains all voxels of the cell that are in the output
};

/// Verdicts on the cells of one tetrahedron.
class TetCells {
 public:
  TetCells(const TetSetup& tet, const OutputFrame& frame) : tet_(tet), frame_(frame) {
    double longest = 1;
    for (int axis = 0; axis < 3; ++axis) longest += tet.end[axis] - tet.begin[axis] + 1;
    for (int face = 0; face < 4; ++face) longest = std::max(longest, std::abs(tet.plane[3][face]));
    // 1000 times the bound of the rounding error of a plane value.
    margin_ = 4 * longest * 0x1p-40;
  }

  /// Computes the contributions of y and z to the plane values in row (cj, ck) of cells.
  void start_row(int cj, int ck) {
    const CellSpan y(tet_, frame_, 1, cj), z(tet_, frame_, 2, ck);
    is_whole_ = y.is_whole && z.is_whole;
    for (std::size_t face = 0; face < 4; face += hn::Lanes(d)) {
      auto low = hn::LoadU(d, tet_.plane[3] + face), high = low;
      add(1, y, face, low, high);
      add(2, z, face, low, high);
      hn::Store(low, d, low_ + face);
      hn::Store(high, d, high_ + face);
    }
  }

  bool is_rejected() const { return is_rejected_; }
  bool is_accepted() const { return is_accepted_; }

  void classify(int ci) {
    const CellSpan x(tet_, frame_, 0, ci);
    const auto margin = hn::Set(d, margin_);
    is_rejected_ = false;
    is_accepted_ = is_whole_ && x.is_whole;
    for (std::size_t face = 0; face < 4; face += hn::Lanes(d)) {
      auto low = hn::Load(d, low_ + face), high = hn::Load(d, high_ + face);
      add(0, x, face, low, high);
      const auto beyond = hn::Sub(low, hn::LoadU(d, tet_.height + face));
      const auto out = hn::Or(hn::Lt(high, hn::Neg(margin)), hn::Gt(beyond, margin));
      is_rejected_ = is_rejected_ || !hn::AllFalse(d, out);
      is_accepted_ = is_accepted_ && hn::AllTrue(d, hn::Gt(low, margin));
    }
  }

 private:
  using Tag = hn::CappedTag<double, 4>;  ///< one lane per face
  static constexpr Tag d{};

  /// Adds to `low` and `high` the least and largest contribution of a span to the plane values.
  template <class V>
  void add(int axis, const CellSpan& span, std::size_t face, V& low, V& high) const {
    const auto normal = hn::LoadU(d, tet_.plane[axis] + face);
    const auto at_first = hn::Mul(normal, hn::Set(d, span.first));
    const auto at_last = hn::Mul(normal, hn::Set(d, span.last));
    low = hn::Add(low, hn::Min(at_first, at_last));
    high = hn::Add(high, hn::Max(at_first, at_last));
  }

  const TetSetup& tet_;
  const OutputFrame& frame_;
  double margin_;
  bool is_whole_ = false;
  bool is_rejected_ = false;
  bool is_accepted_ = false;
  alignas(64) double low_[4];
  alignas(64) double high_[4];
};

/// Computes the verdicts on candidate pairs [first, past) of tetrahedron t.
void classify_cells(const TetSetup& tet,
                    std::int64_t t,
                    std::int64_t first,
                    std::int64_t past,
                    CullSwitches switches,
                    const OutputFrame& frame,
                    CellPair* pairs) {
  TetCells cells(tet, frame);
  const int ci_begin = first_cell(tet, 0), ci_end = last_cell(tet, 0) + 1;
  const int ny = last_cell(tet, 1) - first_cell(tet, 1) + 1;
  const std::int64_t row = first / (ci_end - ci_begin);
  int ci = ci_begin + static_cast<int>(first - row * (ci_end - ci_begin));
  int cj = first_cell(tet, 1) + static_cast<int>(row % ny);
  int ck = first_cell(tet, 2) + static_cast<int>(row / ny);
  for (std::int64_t left = past - first; left > 0; ci = ci_begin) {
    cells.start_row(cj, ck);
    const std::int64_t line = frame.cell_index(0, cj, ck);
    for (; ci < ci_end && left > 0; ++ci, --left) {
      cells.classify(ci);
      const bool accepted = switches.accept && cells.is_accepted();
      const bool rejected = switches.reject && cells.is_rejected();
      *pairs++ = rejected ? rejected_pair : make_pair(line + ci, t, accepted);
    }
    if (++cj > last_cell(tet, 1)) {
      cj = first_cell(tet, 1);
      ++ck;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetwarp {

HWY_EXPORT(classify_cells);

void cell_cull(CpuExec& exec,
               View<const TetSetup> setups,
               const PlaneVerdict&,
               View<const std::int64_t> pair_offsets,
               CullSwitches switches,
               const OutputFrame& frame,
               View<CellPair> pairs) {
  exec.for_each_span("warp/cull", pair_offsets, pairs.size,
                     [&](std::int64_t t, std::int64_t first, std::int64_t past, std::int64_t item) {
                       HWY_DYNAMIC_DISPATCH(classify_cells)
                       (setups[t], t, first, past, switches, frame, pairs.data + item);
                     });
}

void cell_ranges(CpuExec& exec, const CellRangeOp& op) {
  const std::int64_t all_cells[2] = {0, op.ranges.size};
  exec.for_each_span("warp/cull", {all_cells, 2}, op.ranges.size,
                     [&](std::int64_t, std::int64_t first, std::int64_t past, std::int64_t) {
                       std::int64_t pair = lower_bound_of_cell(op.pairs, op.count(), first);
                       for (std::int64_t cell = first; cell < past; ++cell)
                         pair = op.set_range(cell, pair);
                     });
}

}  // namespace tetwarp
#endif  // HWY_ONCE
