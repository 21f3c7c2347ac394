/// @file step_begin.hpp
/// Stages "setup" of the warp on a device, few launches: nodes, counters and lists at the start of
/// a step; then setup of the tetrahedra, all or those that have moved, and the sums of their pairs.
#pragma once
#include <cstdint>

#include "kernels/warp/cell_list.hpp"
#include "kernels/warp/node_quantize.hpp"
#include "kernels/warp/tet_moved.hpp"
#include "kernels/warp/tet_widen.hpp"

namespace tetwarp {

/// One index = one node, one counter and one cell; any order. Rounds the nodes' positions, finds
/// those that differ from the step before, and clears what the step counts in.
struct StepBeginOp {
  NodeQuantizeOp quantize;
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
      if (before.size > 0) MeshNodeMovedOp{before, quantize.nodes, node_moved}(i);
    }
    if (i < counters.size) counters[i] = 0;
    if (i < cell_counts.size) cell_counts[i] = 0;
  }
};

/// One index = one tetrahedron: its setup; the count that is summed is that of its candidate pairs.
/// @tparam widens  whether intensity is conservative
template <bool widens>
struct TetCountOp {
  static constexpr int resident_blocks = 1;  ///< allows all registers: no spills
  TetSetupOp setup;
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
      TetWidenOp{setup.tets,  setup.deformed, setup.rest,       {},
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

/// The same for meshes without hexahedra whose intensity is not conservative. Four lanes share a
/// tetrahedron: each computes the plane of a face, three of them an axis of its box and a row of
/// its map.
struct TetLanesOp {
  static constexpr int lanes = 4;
  static constexpr int resident_blocks = 3;  ///< leaves 80 registers per thread: no spills
  TetCountOp<false> one;

  template <class Lanes>
  TETWARP_HD std::int64_t operator()(std::int64_t t, const Lanes& four) const {
    if (one.node_moved.size > 0) {
      const bool has_moved = four.lane == 0 && one.find_moved(t);
      if (one.is_update && four.all(four.lane != 0 || !has_moved)) return 0;
    }
    TetSetup& setup = one.setup.setups[t];
    std::int64_t pairs = 0;
    const TetClass tet_class = set_up(t, four, setup, pairs);
    if (four.lane != 0) return 0;
    if (tet_class != TetClass::regular && tet_class != TetClass::inverted) setup = {};
    setup.tet_class = tet_class;
    if (tet_class != TetClass::regular) {
      atomic_add(&one.setup.class_counts[static_cast<int>(tet_class)], 1);
    }
    return pairs;
  }
  TETWARP_HD void finish(std::int64_t total, int k) const { one.finish(total, k); }

 private:
  /// As TetSetupOp::set_up(), but sets nothing for other classes than regular and inverted.
  /// @param pairs  out, cells of the box
  template <class Lanes>
  TETWARP_HD TetClass
  set_up(std::int64_t t, const Lanes& four, TetSetup& setup, std::int64_t& pairs) const {
    const std::int32_t* const nodes = one.setup.tets.data + 4 * t;
    const Node mine = one.setup.deformed[nodes[four.lane]];
    TetNodes tet;  // the node opposite this lane's face, then those of the face
    for (int a = 0; a < 4; ++a) {
      const int of = a == 0 ? four.lane : face_node(four.lane, a - 1);
      for (int axis = 0; axis < 3; ++axis) tet.x[a][axis] = four.of(of, mine.x[axis]);
    }
    for (int a = 0; a < 4; ++a) {
      if (tet.x[a][0] == bad_node) return TetClass::bad_position;
    }
    BoxSide sides[3];
    std::int64_t extent = 0, anchor[3], cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const BoxSide side = sides[axis] = box_along(tet, one.setup.frame, axis);
      anchor[axis] = side.anchor;
      extent = max_of(extent, side.extent);
      const int count = ((side.end - 1) >> cell_shift) - (side.begin >> cell_shift) + 1;
      cells *= side.begin < side.end ? count : 0;
    }
    if (extent > longest_extent) return TetClass::too_large;
    Barycentric of_nodes[4];
    const int turned = extent <= short_extent
                           ? set_face<std::int64_t>(tet, anchor, four, setup, of_nodes[0])
                           : set_face<Int128>(tet, anchor, four, setup, of_nodes[0]);
    if (turned == 0) return TetClass::flat;
    for (int f = 3; f > 0; --f) of_nodes[f] = four.of(f, of_nodes[0]);  // the first does not count
    set_rows(nodes, anchor, four, of_nodes, setup);
    const BoxSide side = four.lane == 0 ? sides[0] : four.lane == 1 ? sides[1] : sides[2];
    if (four.lane < 3) {
      setup.anchor[four.lane] = side.anchor;
      setup.begin[four.lane] = side.begin;
      setup.end[four.lane] = side.end;
    }
    pairs = cells;
    return turned * one.setup.rest_orientation[t] < 0 ? TetClass::inverted : TetClass::regular;
  }

  /// Sets this lane's plane.
  /// @returns orientation(); 0, and nothing is set, if the tetrahedron is flat
  template <class Integer, class Lanes>
  TETWARP_HD static int set_face(const TetNodes& tet,
                                 const std::int64_t* anchor,
                                 const Lanes& four,
                                 TetSetup& setup,
                                 Barycentric& of_node) {
    const auto exact = plane_through<Integer>(tet.x[1], tet.x[2], tet.x[3]);
    const Int128 value = plane_value(exact, tet.x[0]);
    if (value == 0) return 0;
    const TetVolume volume(four.lane % 2 == 0 ? value : -value);
    of_node = set_plane(exact, four.lane, volume, anchor, setup);
    return volume.sign;
  }

  /// Sets the map and its kind.
  template <class Lanes>
  TETWARP_HD void set_rows(const std::int32_t* nodes,
                           const std::int64_t* anchor,
                           const Lanes& four,
                           const Barycentric* of_nodes,
                           TetSetup& setup) const {
    const int row = min_of(four.lane, 2);
    std::int64_t output[4], source[4], shift = 0;
    for (int a = 0; a < 4; ++a) {
      output[a] = one.setup.deformed[nodes[a]].x[row];
      source[a] = one.setup.rest[nodes[a]].x[row];
    }
    const bool is_copy = four.all(is_whole_along(output, source, shift));
    double steepest = 0;
    if (four.lane == 3) {
      for (auto& column : setup.map) column[3] = 0;
    } else if (is_copy) {
      set_shift_row(anchor[row] + shift, row, setup);
    } else {
      steepest = set_map_row(source, of_nodes, row, setup);
    }
    const bool is_affine = four.all(!(steepest > steep_threshold));
    if (four.lane == 0) {
      setup.kind = is_copy ? MapKind::copy : is_affine ? MapKind::affine : MapKind::steep;
    }
  }
};

}  // namespace tetwarp
