/// @file tet_setup.hpp
/// Stage "setup" of the warp: planes, box and map of each tetrahedron, once per step.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/face_sign.hpp"
#include "kernels/warp/hex_kind.hpp"

namespace tetwarp {

/// How the map of a tetrahedron must be evaluated.
enum class MapKind : std::int32_t {
  affine,     ///< in float32, relative to a cell's corner
  steep,      ///< has an entry above steep_threshold: in float64
  trilinear,  ///< the map of the hexahedron that it is part of: hex_map.hpp
  copy        ///< a shift by whole voxels: no interpolation
};

/// Class of a tetrahedron in one step.
enum class TetClass : std::int32_t { regular, inverted, flat, bad_position, too_large };
constexpr int tet_class_count = 5;

/// Data of one tetrahedron. Distances in voxels, positions relative to `anchor`.
struct TetSetup {
  std::int64_t anchor[3];  ///< integer voxel at the low corner of the box [frame]
  double plane[4][4];      ///< unit inward normal (3) and value at the anchor, each for four faces
  double height[4];        ///< distance of the node opposite each face [voxel]
  double map[4][4];        ///< source index = sum over axes of map[axis] * (voxel - anchor)[axis],
                           ///< + map[3]; three entries each, the fourth is zero
  int begin[3];            ///< voxels of the frame within the box; empty when begin >= end
  int end[3];
  MapKind kind;
  TetClass tet_class;
};

/// Largest extent of a tetrahedron whose face normals fit in 64 bits [quantum].
constexpr std::int64_t short_extent = std::int64_t{1} << 30;

constexpr double steep_threshold = 4.0;  ///< largest map entry that float32 may evaluate

/// Cells along `axis` that the tetrahedron's box touches: [first, last].
TETWARP_HD int first_cell(const TetSetup& tet, int axis) {
  return tet.begin[axis] >> cell_shift;
}
TETWARP_HD int last_cell(const TetSetup& tet, int axis) {
  return (tet.end[axis] - 1) >> cell_shift;
}
TETWARP_HD bool is_empty(const TetSetup& tet) {
  return tet.begin[0] >= tet.end[0] || tet.begin[1] >= tet.end[1] || tet.begin[2] >= tet.end[2];
}

/// Cells that the tetrahedron's box touches.
TETWARP_HD std::int64_t box_cells(const TetSetup& tet) {
  std::int64_t cells = is_empty(tet) ? 0 : 1;
  for (int axis = 0; axis < 3; ++axis) {
    cells *= last_cell(tet, axis) - first_cell(tet, axis) + 1;
  }
  return cells;
}

/// The box of a tetrahedron along one axis.
struct BoxSide {
  std::int64_t anchor;  ///< as in TetSetup
  std::int64_t extent;  ///< [quantum]
  int begin, end;       ///< as in TetSetup
};

/// Box in whole voxels along an axis, clipped to the frame, and the anchor.
/// @param tet  its nodes in any order
TETWARP_HD BoxSide box_along(const TetNodes& tet, const OutputFrame& frame, int axis) {
  std::int64_t low = tet.x[0][axis], high = low;
  for (int a = 1; a < 4; ++a) {
    low = min_of(low, tet.x[a][axis]);
    high = max_of(high, tet.x[a][axis]);
  }
  const std::int64_t first = (low + quanta_per_voxel - 1) >> quantum_bits;
  const std::int64_t past = (high >> quantum_bits) + 1;
  const std::int64_t frame_begin = frame.begin[axis], frame_end = frame.end[axis];
  return {low >> quantum_bits,  // floor
          high - low, static_cast<int>(min_of(max_of(first, frame_begin), frame_end)),
          static_cast<int>(max_of(min_of(past, frame_end), frame_begin))};
}

/// Sets anchor and box.
/// @returns the extent along the longest axis [quantum]
TETWARP_HD std::int64_t set_box(const TetNodes& tet, const OutputFrame& frame, TetSetup& setup) {
  std::int64_t extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const BoxSide side = box_along(tet, frame, axis);
    extent = max_of(extent, side.extent);
    setup.anchor[axis] = side.anchor;
    setup.begin[axis] = side.begin;
    setup.end[axis] = side.end;
  }
  return extent;
}

/// Whether four nodes move along an axis by the same whole voxels to within a quantum.
/// @param output, source  their coordinates along it
/// @param shift           out, from output to source [voxel]
TETWARP_HD bool is_whole_along(const std::int64_t* output,
                               const std::int64_t* source,
                               std::int64_t& shift) {
  shift = (source[0] - output[0] + quanta_per_voxel / 2) >> quantum_bits;
  bool whole = true;
  for (int a = 0; a < 4; ++a) {
    const std::int64_t rest = source[a] - output[a] - shift * quanta_per_voxel;
    whole = whole && rest >= -1 && rest <= 1;
  }
  return whole;
}

/// Whether every node moves by the same whole-voxel shift to within a quantum.
/// @param shift  out, from output to source [voxel]
TETWARP_HD bool is_whole_shift(const TetNodes& output,
                               const TetNodes& source,
                               std::int64_t* shift) {
  bool whole = true;
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t from[4], to[4];
    for (int a = 0; a < 4; ++a) {
      from[a] = output.x[a][axis];
      to[a] = source.x[a][axis];
    }
    whole = is_whole_along(from, to, shift[axis]) && whole;
  }
  return whole;
}

/// Converts an integer below 2^124 within an ulp. Branch-free, ten times as fast as the compiler's
/// conversion.
TETWARP_HD double as_double(Int128 value) {
  const Int128 all = value >> 127;
  const Int128 size = (value ^ all) - all;
  const auto high = static_cast<std::int64_t>(size >> 62);
  const auto low = static_cast<std::int64_t>(size) & ((std::int64_t{1} << 62) - 1);
  const double sign = static_cast<double>(1 + 2 * static_cast<std::int64_t>(all));
  return sign * (static_cast<double>(high) * 0x1p62 + static_cast<double>(low));
}

TETWARP_HD double as_double(std::int64_t value) {
  return static_cast<double>(value);
}

/// Sign of the volume, in the order of the nodes.
TETWARP_HD int orientation(const TetNodes& tet) {
  const Int128 value = plane_value(exact_plane(tet, 0), tet.x[0]);
  return (value > 0) - (value < 0);
}

/// Barycentric coordinate of a node.
struct Barycentric {
  double gradient[3];  ///< [1/voxel]
  double at_anchor;
};

/// Six times the volume of a tetrahedron that is not flat [quantum^3].
struct TetVolume {
  int sign;  ///< orientation()
  double size, per_size;

  TETWARP_HD explicit TetVolume(Int128 value)
      : sign(value > 0 ? 1 : -1), size(fabs(as_double(value))), per_size(1.0 / size) {}
};

/// The plane of a face and the barycentric coordinate of the node opposite to it, from exact
/// integers.
/// @param exact  of the face
/// @param from   the anchor
/// @param setup  out, plane and height of the face
template <class Integer>
TETWARP_HD Barycentric set_plane(const ExactPlane<Integer>& exact,
                                 int face,
                                 const TetVolume& volume,
                                 const std::int64_t* from,
                                 TetSetup& setup) {
  std::int64_t anchor[3];
  for (int axis = 0; axis < 3; ++axis) anchor[axis] = from[axis] * quanta_per_voxel;
  const double inward =
      face % 2 == 0 ? volume.sign : -volume.sign;  // the normals of exact_plane() alternate
  const double value = inward * as_double(plane_value(exact, anchor));
  Barycentric of_node;
  double normal[3], square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis] = inward * as_double(exact.normal[axis]);
    square += normal[axis] * normal[axis];
    of_node.gradient[axis] =
        normal[axis] * (static_cast<double>(quanta_per_voxel) * volume.per_size);
  }
  of_node.at_anchor = value * volume.per_size;
  const double per_length = 1.0 / sqrt(square);
  const double per_voxel = per_length * (1.0 / static_cast<double>(quanta_per_voxel));
  for (int axis = 0; axis < 3; ++axis) setup.plane[axis][face] = normal[axis] * per_length;
  setup.plane[3][face] = value * per_voxel;
  setup.height[face] = volume.size * per_voxel;
  return of_node;
}

/// Computes the planes of the four faces: no cancellation in thin tetrahedra.
/// @param setup     its anchor is set; out, planes and heights
/// @param of_nodes  out
/// @returns orientation(); 0, and nothing is set, if the tetrahedron is flat
template <class Integer>
TETWARP_HD int set_planes(const TetNodes& tet, TetSetup& setup, Barycentric* of_nodes) {
  const Int128 signed_volume = plane_value(exact_plane<Integer>(tet, 0), tet.x[0]);
  if (signed_volume == 0) return 0;
  const TetVolume volume(signed_volume);
  for (int face = 0; face < 4; ++face) {
    of_nodes[face] = set_plane(exact_plane<Integer>(tet, face), face, volume, setup.anchor, setup);
  }
  return volume.sign;
}

/// Sets one row of the map from the deformed to the rest tetrahedron, R_f the rest position of node
/// f and b_f its barycentric coordinate: x0 = R0 + sum_f (R_f - R0) b_f(x).
/// @param source  the nodes' coordinates in the source along the row
/// @returns the largest entry that multiplies a position
TETWARP_HD double set_map_row(const std::int64_t* source,
                              const Barycentric* of_nodes,
                              int row,
                              TetSetup& setup) {
  const double voxel = 1.0 / static_cast<double>(quanta_per_voxel);
  double entry[4] = {0, 0, 0, static_cast<double>(source[0]) * voxel}, steepest = 0;
  for (int f = 1; f < 4; ++f) {
    const double edge = static_cast<double>(source[f] - source[0]) * voxel;
    for (int axis = 0; axis < 3; ++axis) entry[axis] += edge * of_nodes[f].gradient[axis];
    entry[3] += edge * of_nodes[f].at_anchor;
  }
  for (int axis = 0; axis < 4; ++axis) setup.map[axis][row] = entry[axis];
  for (int axis = 0; axis < 3; ++axis) steepest = max_of(steepest, fabs(entry[axis]));
  return steepest;
}

/// Sets the map.
TETWARP_HD void set_map(const TetNodes& source, const Barycentric* of_nodes, TetSetup& setup) {
  double steepest = 0;
  for (int row = 0; row < 3; ++row) {
    const std::int64_t along[4] = {source.x[0][row], source.x[1][row], source.x[2][row],
                                   source.x[3][row]};
    steepest = max_of(steepest, set_map_row(along, of_nodes, row, setup));
  }
  setup.kind = steepest > steep_threshold ? MapKind::steep : MapKind::affine;
}

/// Sets one row of a map that shifts by whole voxels.
/// @param to  where it takes the anchor
TETWARP_HD void set_shift_row(std::int64_t to, int row, TetSetup& setup) {
  for (int axis = 0; axis < 3; ++axis) setup.map[axis][row] = row == axis ? 1.0 : 0.0;
  setup.map[3][row] = static_cast<double>(to);
}

/// One index = one tetrahedron; reads its nodes, writes its setup and sizes; any order.
struct TetSetupOp {
  View<const std::int32_t> tets;             ///< node indices, shape [4 * tet_count]
  View<const Node> deformed;                 ///< in the frame [quantum], shape [node_count]
  View<const Node> rest;                     ///< in the source's index space [quantum], as many
  View<const std::int8_t> rest_orientation;  ///< sign of the rest volume, shape [tet_count]
  OutputFrame frame;
  View<TetSetup> setups;  ///< out, shape [tet_count]
  /// Out, cells of the box, shape [tet_count + 1], the last entry for the sum.
  View<std::int64_t> pair_counts;
  View<std::int64_t> class_counts;  ///< irregular ones are added to it, shape [tet_class_count]
  HexView hexes = {};               ///< hexahedra that the last tetrahedra are parts of

  /// Sets everything but the class, which is returned. For other classes than regular and inverted
  /// `setup` is left incomplete.
  TETWARP_HD TetClass set_up(std::int64_t t, TetSetup& setup) const {
    for (int a = 0; a < 4; ++a) {
      if (deformed[tets[4 * t + a]].x[0] == bad_node) return TetClass::bad_position;
    }
    for (int a = 0; a < 8 && hexes.has(t); ++a) {
      if (deformed[hexes.nodes_of(t)[a]].x[0] == bad_node) return TetClass::bad_position;
    }
    const TetNodes output = tet_nodes(deformed, tets.data + 4 * t);
    const TetNodes source = tet_nodes(rest, tets.data + 4 * t);
    const std::int64_t extent = set_box(output, frame, setup);
    if (extent > longest_extent) return TetClass::too_large;
    Barycentric of_nodes[4];
    const int turned = extent <= short_extent ? set_planes<std::int64_t>(output, setup, of_nodes)
                                              : set_planes<Int128>(output, setup, of_nodes);
    if (turned == 0) return TetClass::flat;
    std::int64_t shift[3];
    for (auto& column : setup.map) column[3] = 0;
    const std::int32_t* const hex = hexes.has(t) ? hexes.nodes_of(t) : nullptr;
    if (is_whole_shift(output, source, shift) &&
        (hex == nullptr || has_whole_shift(hex, deformed, rest, shift))) {
      for (int row = 0; row < 3; ++row) set_shift_row(setup.anchor[row] + shift[row], row, setup);
      setup.kind = MapKind::copy;
    } else {
      set_map(source, of_nodes, setup);
      if (hex != nullptr && !maps_all(setup.map, setup.anchor, hex, deformed, rest))
        setup.kind = MapKind::trilinear;
    }
    return turned * rest_orientation[t] < 0 ? TetClass::inverted : TetClass::regular;
  }

  TETWARP_HD void operator()(std::int64_t t) const {
    TetSetup& setup = setups[t];  // in place: too large for registers
    const TetClass tet_class = set_up(t, setup);
    if (tet_class != TetClass::regular && tet_class != TetClass::inverted) setup = {};
    setup.tet_class = tet_class;
    pair_counts[t] = box_cells(setup);
    if (setup.tet_class != TetClass::regular) {
      atomic_add(&class_counts[static_cast<int>(setup.tet_class)], 1);
    }
  }
};

/// Planes, box, map and class of every tetrahedron.
///
/// Planes come from exact integer normals, so they are accurate for thin tetrahedra. A map that
/// moves all nodes by the same whole voxels, to within a quantum, is replaced by that shift.
/// @param exec  where to run
/// @param body  input and output, see TetSetupOp
/// @pre  indices in body.tets are in range; the pipeline checks them
///
/// Determinism: boxes, classes and copies are exact; planes and maps within 2^-48 relative between
/// back ends. Cost: about 150 integer multiplications, 330 bytes written per tetrahedron.
/// Source: Gascon et al. 2013, section 3; the integer setup is ours.
template <class Exec>
void tet_setup(Exec& exec, const TetSetupOp& op) {
  exec.for_each("warp/setup", op.setups.size, op);
}

}  // namespace tetwarp
