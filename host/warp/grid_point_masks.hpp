/// @file grid_point_masks.hpp
/// Stage "mask" for any executor, with SkipOptions::grid_point_masks: the memory of the masks, and
/// where those of each tetrahedron begin.
#pragma once
#include <cstdint>
#include <type_traits>

#include "kernels/base/grouped_sums.hpp"
#include "kernels/warp/corner_mask.hpp"

namespace tetwarp {

/// Masks of the grid points around the tetrahedra that a step culls.
template <class Exec>
class GridPointMasks {
 public:
  using Offsets = std::conditional_t<Exec::reads_are_free, View<const std::int64_t>, GroupedSums>;

  /// The executor must outlive the object.
  explicit GridPointMasks(Exec& exec) : exec_(exec) {}

  /// Makes room for the masks of tetrahedra with `pairs` candidate pairs together.
  void reserve(std::int64_t tets, std::int64_t pairs) {
    counts_.reserve(tets + 1);
    groups_.reserve(group_count(tets) + 1);
    mask_count_ = most_corners(pairs);
    masks_.reserve(mask_count_);
  }

  /// @param pair_offsets  first candidate pair of each tetrahedron, shape [tet_count + 1]
  /// @returns the verdicts by these masks, for cell_cull() or cell_list(); valid until the next
  /// call
  MaskVerdict<Offsets> run(View<const TetSetup> setups, const Offsets& pair_offsets) {
    const std::int64_t tets = setups.size;
    const View<std::int64_t> counts = counts_.view(tets + 1);
    const CornerCountOp<Offsets> op{setups, pair_offsets, counts};
    Offsets offsets;
    if constexpr (Exec::reads_are_free) {
      exec_.for_each("warp/mask", tets, op);
      exec_.exclusive_scan("warp/mask", counts);
      offsets = counts;
    } else {
      offsets = {counts, groups_.view(group_count(tets) + 1), tets + 1};
      exec_.grouped_scan("warp/mask", tets, op, offsets);
    }
    corner_mask(exec_, setups, offsets, masks_.view(mask_count_));
    return {offsets, masks_.const_view(mask_count_)};
  }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Exec& exec_;
  Buffer<std::int64_t> counts_;  ///< per tetrahedron, then sums of these
  Buffer<std::int64_t> groups_;  ///< as in GroupedSums
  Buffer<std::uint16_t> masks_;
  std::int64_t mask_count_ = 0;
};

}  // namespace tetwarp
