/// @file node_quantize.hpp
/// First part of stage "setup" of the warp: rounds node positions to integers. All later stages, on
/// every back end, compute ownership and maps from the rounded mesh.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/base/index_space.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// A node in index space [quantum]. x[0] is `bad_node` if the position is not finite or beyond
/// max_index.
struct Node {
  std::int64_t x[3];
};

constexpr std::int64_t bad_node = INT64_MIN;

/// The node of a world position, relative to the voxel `frame`. Rounds half to even; products and
/// sums are never fused, so the result is the same on every machine.
TETWARP_HD Node quantized(const IndexFromWorld& map,
                          const double* world,
                          const std::int64_t* frame) {
  double from_origin[3];
  for (int axis = 0; axis < 3; ++axis) from_origin[axis] = world[axis] - map.origin[axis];
  Node node;
  for (int row = 0; row < 3; ++row) {
    const double* w = map.linear[row];
    const double index = add_rn(add_rn(mul_rn(w[0], from_origin[0]), mul_rn(w[1], from_origin[1])),
                                mul_rn(w[2], from_origin[2]));
    if (!(fabs(index) <= max_index)) {  // NaN fails too
      node.x[0] = bad_node;
      return node;
    }
    node.x[row] = static_cast<std::int64_t>(rint(index * static_cast<double>(quanta_per_voxel))) -
                  frame[row] * quanta_per_voxel;
  }
  return node;
}

/// One index = one node; any order.
struct NodeQuantizeOp {
  IndexFromWorld map;
  std::int64_t frame[3];
  View<const double> positions;
  View<Node> nodes;

  TETWARP_HD void operator()(std::int64_t n) const {
    nodes[n] = quantized(map, positions.data + 3 * n, frame);
  }
};

/// Rounds world positions to multiples of 2^-20 voxel of a grid's index space.
///
/// @param exec       where to run
/// @param map        world to index space of the grid
/// @param frame      subtracted from the result [voxel, whole]
/// @param positions  x y z per node [world], shape [3 * node_count]
/// @param nodes      out, shape [node_count]; `bad_node` for a bad position, which tet_setup()
///                   counts by class
///
/// Determinism: same bits on every back end. Cost: 48 bytes and 15 operations per node.
/// Source: ours.
template <class Exec>
void node_quantize(Exec& exec,
                   const IndexFromWorld& map,
                   const std::int64_t* frame,
                   View<const double> positions,
                   View<Node> nodes) {
  NodeQuantizeOp op{map, {frame[0], frame[1], frame[2]}, positions, nodes};
  exec.for_each("warp/setup", nodes.size, op);
}

}  // namespace tetwarp
