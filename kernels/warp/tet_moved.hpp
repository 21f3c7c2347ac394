/// @file tet_moved.hpp
/// Stage "setup" of a step that updates the previous one: finds the tetrahedra that have moved, and
/// computes the setup of these only.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// One index = one node; any order.
struct MeshNodeMovedOp {
  View<const Node> before;
  View<const Node> now;
  View<std::uint8_t> moved;

  TETWARP_HD void operator()(std::int64_t n) const {
    const Node &a = before[n], &b = now[n];
    moved[n] = a.x[0] != b.x[0] || a.x[1] != b.x[1] || a.x[2] != b.x[2];
  }
};

/// One index = one tetrahedron; any order. Subtracts moved tetrahedra from the class counts;
/// moved_tet_setup() adds their new classes.
struct TetMovedOp {
  View<const std::int32_t> tets;
  View<const std::uint8_t> node_moved;
  View<const TetSetup> setups;
  View<std::uint8_t> moved;
  View<std::int64_t> moved_counts;
  View<std::int64_t> class_counts;
  HexView hexes = {};

  TETWARP_HD void operator()(std::int64_t t) const {
    const bool is_part = hexes.has(t);
    const std::int32_t* nodes = is_part ? hexes.nodes_of(t) : tets.data + 4 * t;
    bool has_moved = false;
    for (int a = 0; a < (is_part ? 8 : 4); ++a) has_moved = has_moved || node_moved[nodes[a]] != 0;
    moved[t] = has_moved;
    moved_counts[t] = has_moved;
    if (has_moved && setups[t].tet_class != TetClass::regular) {
      atomic_add(&class_counts[static_cast<int>(setups[t].tet_class)], -1);
    }
  }
};

/// Finds the tetrahedra with a quantized node that differs from the previous step.
///
/// Exact: a tetrahedron whose quantized nodes are equal has the same setup, pairs and samples, bit
/// for bit.
/// @param exec          where to run
/// @param tets          node indices, shape [4 * tet_count]
/// @param before        nodes of the previous step [quantum], shape [node_count]
/// @param now           nodes of this step, shape [node_count]
/// @param setups        of the previous step, shape [tet_count]
/// @param node_moved    scratch, shape [node_count]
/// @param moved         out, 1 where a tetrahedron has moved, shape [tet_count]
/// @param moved_counts  out, the same as int64 for a scan, shape [tet_count + 1]
/// @param class_counts  in and out: moved irregular tetrahedra are subtracted from it
/// @param hexes         hexahedra; all tetrahedra of a hexahedron move if any of its nodes does
///
/// Determinism: same bits on every back end. Cost: 48 bytes read per node, 20 per tetrahedron.
/// Source: ours.
template <class Exec>
void tet_moved(Exec& exec,
               View<const std::int32_t> tets,
               View<const Node> before,
               View<const Node> now,
               View<const TetSetup> setups,
               View<std::uint8_t> node_moved,
               View<std::uint8_t> moved,
               View<std::int64_t> moved_counts,
               View<std::int64_t> class_counts,
               const HexView& hexes = {}) {
  exec.for_each("warp/setup", now.size, MeshNodeMovedOp{before, now, node_moved});
  exec.for_each("warp/setup", setups.size,
                TetMovedOp{tets, node_moved, setups, moved, moved_counts, class_counts, hexes});
}

/// One item = one moved tetrahedron; any order.
struct MovedTetSetupOp {
  TetSetupOp setup;

  TETWARP_HD void operator()(std::int64_t t, std::int64_t, std::int64_t) const { setup(t); }
};

/// tet_setup() of the moved tetrahedra. Entries of others do not change.
///
/// @param exec           where to run
/// @param moved_offsets  exclusive scan of moved_counts from tet_moved(), shape [tet_count + 1]
/// @param moved_count    number of moved tetrahedra
/// @param setup          as for tet_setup()
///
/// Determinism and cost per moved tetrahedron: as tet_setup().
template <class Exec>
void moved_tet_setup(Exec& exec,
                     View<const std::int64_t> moved_offsets,
                     std::int64_t moved_count,
                     const TetSetupOp& setup) {
  exec.for_each_item("warp/setup", moved_offsets, moved_count, MovedTetSetupOp{setup});
}

}  // namespace tetwarp
