/// @file curve_footprint.hpp
/// Bounds of the source voxels that a tetrahedron of ten nodes reads.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/warp/tet_footprint.hpp"
#include "kernels/warp/curve_map.hpp"

namespace tetwarp {

/// The ways of middle nodes from the middles of their edges, of one coordinate.
struct Bows {
  double at[6];
};

/// The least and the largest value over all places of a curved map (curve_margin) of a linear
/// function plus sum over edges of 4 L_a L_b bow, L barycentric coordinates. The places are a
/// tetrahedron, over which a quadratic function lies between its ten Bernstein coefficients.
/// @param corners  values of the linear function at the corners
inline void bounds_of_curve(const double* corners, const Bows& bows, double& low, double& high) {
  const auto weight = [](int vertex, int node) {
    return vertex == node ? 1 + 3 * curve_margin : -curve_margin;
  };
  low = HUGE_VAL;
  high = -HUGE_VAL;
  for (int p = 0; p < 4; ++p) {
    for (int q = p; q < 4; ++q) {
      double coefficient = 0;
      for (int node = 0; node < 4; ++node) {
        coefficient += 0.5 * (weight(p, node) + weight(q, node)) * corners[node];
      }
      for (int e = 0; e < 6; ++e) {
        const int a = end_of_edge(e, 0), b = end_of_edge(e, 1);
        coefficient += 2 * (weight(p, a) * weight(q, b) + weight(p, b) * weight(q, a)) * bows.at[e];
      }
      low = std::min(low, coefficient);
      high = std::max(high, coefficient);
    }
  }
}

/// The bows of one axis.
/// @param nodes  of which the ten of the tetrahedron are within the limits
inline Bows bows_of(View<const Node> nodes,
                    const std::int32_t* tet,
                    const std::int32_t* mid_nodes,
                    int axis) {
  Bows bows;
  for (int e = 0; e < 6; ++e) {
    const std::int64_t off = 2 * nodes[mid_nodes[e]].x[axis] -
                             nodes[tet[end_of_edge(e, 0)]].x[axis] -
                             nodes[tet[end_of_edge(e, 1)]].x[axis];
    bows.at[e] = static_cast<double>(off) / (2 * quanta_per_voxel);
  }
  return bows;
}

/// Extends the footprint of the straight tetrahedron to all source voxels that the quadratic map
/// leads to. With M the straight map and q, q' the quadratic parts of the deformed and the rest
/// positions, the source position of voxel x is M x + (q' - M q)(u) at its place u: off the
/// straight map by no more than the bounds of the second term.
/// @param now, rest  nodes in the index spaces of the output's frame and of the source
/// @param tet        its corners
inline void extend_by_curve(const TetSetup& setup,
                            View<const Node> now,
                            View<const Node> rest,
                            const std::int32_t* tet,
                            const std::int32_t* mid_nodes,
                            Footprint& footprint) {
  for (int e = 0; e < 6; ++e) {
    if (now[mid_nodes[e]].x[0] == bad_node) return;  // mapped by the corners
  }
  if (is_straight(now, tet, mid_nodes) && is_straight(rest, tet, mid_nodes)) return;
  Bows output[3];
  for (int axis = 0; axis < 3; ++axis) output[axis] = bows_of(now, tet, mid_nodes, axis);
  for (int row = 0; row < 3; ++row) {
    const Bows source = bows_of(rest, tet, mid_nodes, row);
    double corners[4], low, high;
    for (int a = 0; a < 4; ++a) {
      corners[a] = static_cast<double>(rest[tet[a]].x[row]) / quanta_per_voxel;
    }
    bounds_of_curve(corners, source, low, high);
    const auto whole = [](double x) {
      return clamped_int(static_cast<std::int64_t>(std::clamp(std::floor(x), -0x1p40, 0x1p40)));
    };
    footprint.source_begin[row] = std::min(footprint.source_begin[row], whole(low) - 1);
    footprint.source_end[row] = std::max(footprint.source_end[row], whole(high) + 2);
    Bows off;
    for (int e = 0; e < 6; ++e) {
      off.at[e] = source.at[e];
      for (int axis = 0; axis < 3; ++axis) off.at[e] -= setup.map[axis][row] * output[axis].at[e];
    }
    constexpr double nothing[4] = {};
    bounds_of_curve(nothing, off, low, high);
    footprint.spread[row] =
        clamped_int(std::int64_t{footprint.spread[row]} + whole(std::ceil(std::max(-low, high))));
  }
}

}  // namespace tetwarp
