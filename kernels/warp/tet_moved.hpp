/// @file tet_moved.hpp
/// Stage "setup" of a step that updates the one before: which tetrahedra have moved, and the setup
/// of those alone.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// One index = one node; any order.
struct NodeMovedBody {
  View<const Node> before;
  View<const Node> now;
  View<std::uint8_t> moved;

  TETWARP_HD void operator()(std::int64_t n) const {
    const Node &a = before[n], &b = now[n];
    moved[n] = a.x[0] != b.x[0] || a.x[1] != b.x[1] || a.x[2] != b.x[2];
  }
};

/// One index = one tetrahedron; any order. Takes moved ones out of the class counts.
struct TetMovedBody {
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

/// Finds the tetrahedra of which a quantized node differs from the step before.
///
/// Exact: what has not moved by a quantum has the same setup, pairs and samples, bit for bit.
/// @param exec          where to run
/// @param tets          node indices, shape [4 * tet_count]
/// @param before        nodes of the step before [quantum], shape [node_count]
/// @param now           nodes of this step, shape [node_count]
/// @param setups        from the step before, shape [tet_count]
/// @param node_moved    scratch, shape [node_count]
/// @param moved         out, 1 where a tetrahedron has moved, shape [tet_count]
/// @param moved_counts  out, the same to be summed, shape [tet_count + 1]
/// @param class_counts  in and out: moved irregular tetrahedra are taken out of it
/// @param hexes         those that the last tetrahedra are parts of, and move with
///
/// Determinism: same bits on every back end. Cost: 48 bytes read per node, 20 per tetrahedron.
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
  exec.for_each("warp/setup", now.size, NodeMovedBody{before, now, node_moved});
  exec.for_each("warp/setup", setups.size,
                TetMovedBody{tets, node_moved, setups, moved, moved_counts, class_counts, hexes});
}

/// One item = one moved tetrahedron; any order.
struct MovedTetSetupBody {
  TetSetupBody setup;

  TETWARP_HD void operator()(std::int64_t t, std::int64_t, std::int64_t) const { setup(t); }
};

/// tet_setup() of the moved tetrahedra. Entries of others are left as they are.
///
/// @param exec           where to run
/// @param moved_offsets  sums of moved_counts from tet_moved(), shape [tet_count + 1]
/// @param moved_count    how many have moved
/// @param setup          as tet_setup() makes it
///
/// Determinism and cost per moved tetrahedron: as tet_setup().
template <class Exec>
void moved_tet_setup(Exec& exec,
                     View<const std::int64_t> moved_offsets,
                     std::int64_t moved_count,
                     const TetSetupBody& setup) {
  exec.for_each_item("warp/setup", moved_offsets, moved_count, MovedTetSetupBody{setup});
}

}  // namespace tetwarp
