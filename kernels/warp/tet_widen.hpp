/// @file tet_widen.hpp
/// Stage "setup" of a warp that keeps totals: tetrahedra reach all voxels that they intersect.
#pragma once
#include <cstdint>

#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Sets a tetrahedron's box to all voxels of a frame whose own boxes it intersects; set_box()
/// includes only those whose centers may be inside.
TETWARP_HD void widen_box(const TetNodes& tet, const OutputFrame& frame, TetSetup& setup) {
  constexpr std::int64_t half = quanta_per_voxel / 2;
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t low = tet.x[0][axis], high = low;
    for (int a = 1; a < 4; ++a) {
      low = min_of(low, tet.x[a][axis]);
      high = max_of(high, tet.x[a][axis]);
    }
    const std::int64_t first = (low + half) >> quantum_bits, last = (high + half) >> quantum_bits;
    const std::int64_t begin = frame.begin[axis], end = frame.end[axis];
    setup.begin[axis] = static_cast<int>(min_of(max_of(first, begin), end));
    setup.end[axis] = static_cast<int>(max_of(min_of(last + 1, end), begin));
  }
}

/// One index = one tetrahedron; any order. Extends its box to all voxels that it intersects, and
/// replaces a whole-voxel shift that is not exact by the exact map.
struct TetWidenOp {
  View<const std::int32_t> tets;
  View<const Node> nodes;
  View<const Node> rest;
  View<const std::uint8_t> moved;  ///< others do not change; size 0: all have moved
  OutputFrame frame;
  View<TetSetup> setups;
  View<std::int64_t> pair_counts;

  TETWARP_HD void operator()(std::int64_t t) const {
    TetSetup& setup = setups[t];
    const bool has_shape =
        setup.tet_class == TetClass::regular || setup.tet_class == TetClass::inverted;
    if (!has_shape || (moved.size > 0 && moved[t] == 0)) return;
    const TetNodes output = tet_nodes(nodes, tets.data + 4 * t);
    widen_box(output, frame, setup);
    // A shift that is exact only to within a quantum would not keep the total exactly.
    const TetNodes source = tet_nodes(rest, tets.data + 4 * t);
    if (setup.kind == MapKind::copy && !is_exact_shift(output, source)) {
      Barycentric of_nodes[4];
      set_planes<Int128>(output, setup, of_nodes);
      set_map(source, of_nodes, setup);
    }
    pair_counts[t] = box_cells(setup);
  }

  TETWARP_HD static bool is_exact_shift(const TetNodes& output, const TetNodes& source) {
    bool exact = true;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t shift = source.x[0][axis] - output.x[0][axis];
      exact = exact && shift % quanta_per_voxel == 0;
      for (int a = 1; a < 4; ++a) {
        exact = exact && source.x[a][axis] - output.x[a][axis] == shift;
      }
    }
    return exact;
  }
};

/// Stage "setup", after tet_setup(): extends the setup of tetrahedra for voxel_overlap().
/// @param exec   where to run
/// @param setup  as given to tet_setup()
/// @param moved  tetrahedra to extend, from tet_moved; empty: all
///
/// Determinism: as tet_setup(). Cost: 96 bytes read and 40 written per tetrahedron. Source: ours.
template <class Exec>
void tet_widen(Exec& exec, const TetSetupOp& setup, View<const std::uint8_t> moved) {
  exec.for_each("warp/setup", setup.setups.size,
                TetWidenOp{setup.tets, setup.deformed, setup.rest, moved, setup.frame, setup.setups,
                           setup.pair_counts});
}

}  // namespace tetwarp
