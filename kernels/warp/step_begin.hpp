/// @file step_begin.hpp
/// Stages "setup" of the warp on a device, few launches: nodes, counters and lists at the start of
/// a step; then setup of the tetrahedra, all or those that have moved, and the sums of their pairs.
#pragma once
#include <cstdint>

#include "kernels/warp/cell_list.hpp"
#include "kernels/warp/node_quantize.hpp"
#include "kernels/warp/tet_moved.hpp"
#include "kernels/warp/voxel_overlap.hpp"

namespace tetwarp {

/// One index = one node, one counter and one cell; any order. Rounds the nodes' positions, finds
/// those that differ from the step before, and clears what the step counts in.
struct StepBeginBody {
  NodeQuantizeBody quantize;
  View<const Node> before;          ///< size 0: unknown
  View<std::uint8_t> node_moved;    ///< out where `before` is known
  View<std::int64_t> counters;      ///< set to zero
  View<std::uint32_t> cell_counts;  ///< set to zero

  TETWARP_HD std::int64_t size() const {
    return max_of(quantize.nodes.size, max_of(counters.size, cell_counts.size));
  }
  TETWARP_HD void operator()(std::int64_t i) const {
    if (i < quantize.nodes.size) {
      quantize(i);
      if (before.size > 0) MeshNodeMovedBody{before, quantize.nodes, node_moved}(i);
    }
    if (i < counters.size) counters[i] = 0;
    if (i < cell_counts.size) cell_counts[i] = 0;
  }
};

/// One index = one tetrahedron: its setup; the count that is summed is that of its candidate pairs.
/// @tparam widens  whether intensity is conservative
template <bool widens>
struct TetCountBody {
  static constexpr int resident_blocks = 1;  ///< allows all registers: no spills
  TetSetupBody setup;
  View<const std::uint8_t> node_moved;  ///< size 0: unknown
  View<std::uint8_t> moved;             ///< out where node_moved is known
  bool is_update;                       ///< only moved tetrahedra are set up and have candidates
  SpreadCounter moved_count;            ///< moved tetrahedra are added
  View<std::int64_t> candidate_count;   ///< out, shape [1]

  TETWARP_HD std::int64_t operator()(std::int64_t t) const {
    const bool has_moved = node_moved.size == 0 || find_moved(t);
    if (is_update && !has_moved) return 0;
    setup(t);
    if constexpr (widens) {
      TetWidenBody{setup.tets,  setup.deformed, setup.rest,       {},
                   setup.frame, setup.setups,   setup.pair_counts}(t);
    }
    return setup.pair_counts[t];
  }
  TETWARP_HD void finish(std::int64_t total, int k) const {
    if (k == 0) candidate_count[0] = total;
  }

  TETWARP_HD bool find_moved(std::int64_t t) const {
    const bool is_part = setup.hexes.has(t);
    const std::int32_t* nodes = is_part ? setup.hexes.nodes_of(t) : setup.tets.data + 4 * t;
    bool has_moved = false;
    for (int a = 0; a < (is_part ? 8 : 4); ++a) has_moved = has_moved || node_moved[nodes[a]] != 0;
    moved[t] = has_moved;
    if (!has_moved) return false;
    add_to(moved_count, t, 1);
    const TetClass before = setup.setups[t].tet_class;
    if (is_update && before != TetClass::regular) {
      atomic_add(&setup.class_counts[static_cast<int>(before)], -1);
    }
    return true;
  }
};

}  // namespace tetwarp
