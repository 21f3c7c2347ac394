/// @file position_errors.hpp
/// Position errors of a probed warp over all its voxels, each against the bound that follows from
/// the arithmetic.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/position_probe.hpp"

namespace tetwarp::test {

inline double longest_edge(const TetReals& tet) {
  long double longest = 0;
  for (const Real3& a : tet) {
    for (const Real3& b : tet) longest = std::max(longest, length(minus(a, b)));
  }
  return static_cast<double>(longest);
}

inline double smallest_altitude(const TetReals& tet) {
  long double smallest = INFINITY;
  for (std::size_t a = 0; a < 4; ++a) {
    const Real3 normal = face_normal(tet, a);
    const long double height = dot(normal, minus(tet[a], tet[a == 0 ? 1 : 0])) / length(normal);
    smallest = std::min(smallest, std::abs(height));
  }
  return static_cast<double>(smallest);
}

/// Bound of the norm of the map: it is the sum of three edges times gradients of barycentric
/// coordinates, and a gradient is as long as one over an altitude.
inline double stretch_bound(const TetReals& deformed, const TetReals& rest) {
  return 3 * longest_edge(rest) / smallest_altitude(deformed);
}

/// Bound of the error of evaluating the map of a tetrahedron in the arithmetic of `type` [voxel].
///
/// Float64, always: entries of the map come from exact integers by less than ten roundings of parts
/// below `stretch`, and act over the tetrahedron's extent and a cell; 64 times 2^-53 of that
/// product covers them, and 2^-50 of the index its own sums.
///
/// Float32 on top, where no entry exceeds 4, with u = 2^-24 and s the largest sum of a row's
/// entries: in a cell |x| <= 1 + 7 s; rounding base and entries costs u (1/2 + 7 s), products
/// u 7 s, the three sums at most u (3 + 21 s): together less than u (4 + 35 s). The sample's own
/// rounding is u. Fused operations round less.
inline double evaluation_bound(const TetReals& deformed, const TetReals& rest, PixelType type) {
  std::array<Real3, 3> rows = {};
  long double reach = 0, farthest = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    const Real3 normal = face_normal(deformed, a);
    const long double volume = dot(normal, minus(deformed[a], deformed[a == 0 ? 1 : 0]));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t row = 0; row < 3; ++row) {
        rows[row][axis] += (rest[a][row] - rest[0][row]) * normal[axis] / volume;
      }
      for (const Real3& node : deformed) reach = std::max(reach, node[axis] - deformed[a][axis]);
      farthest = std::max(farthest, std::abs(rest[a][axis]));
    }
  }
  const double stretch = stretch_bound(deformed, rest);
  double bound =
      0x1p-47 * stretch * static_cast<double>(reach + 8) + 0x1p-50 * static_cast<double>(farthest);
  if (type == PixelType::float64) return bound;
  long double steepest = 0, sum = 0;
  for (const Real3& row : rows) {
    long double row_sum = 0;
    for (const long double entry : row) {
      steepest = std::max(steepest, std::abs(entry));
      row_sum += std::abs(entry);
    }
    sum = std::max(sum, row_sum);
  }
  const bool is_float32 = steepest < 4.001L;  // within rounding of 4 it may be either
  if (is_float32) bound += 0x1p-24 * (4 + 35 * static_cast<double>(sum));
  return bound + 0x1p-24;
}

/// Bound of the error of a rounded node in index space [voxel]: half a quantum per axis, and four
/// roundings of float64.
inline double node_bound(const IndexFromWorld& map, const std::vector<Point3>& positions) {
  double farthest = 0;
  for (const Point3& p : positions) {
    for (const double* w : map.linear) {
      double sum = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sum += std::abs(w[axis] * (p[axis] - map.origin[axis]));
      }
      farthest = std::max(farthest, sum);
    }
  }
  return std::sqrt(3.0) * (0x1p-21 + 4 * 0x1p-53 * farthest);
}

/// Largest errors [voxel] and largest quotients of an error and its bound.
struct PositionErrors {
  double evaluation = 0;  ///< sampled position against the exact map of the rounded nodes
  double evaluation_share = 0;
  double rounding = 0;  ///< that map against the map of the nodes as given
  double rounding_share = 0;
  std::int64_t strays = 0;  ///< voxels outside their owner
  std::int64_t voxels = 0;  ///< that were tested
};

/// Errors over every `stride`-th owned voxel.
///
/// With D the deformed and R the rest nodes, M the map's matrix, b' the coordinates of a voxel in
/// the rounded nodes D + d, R + r: its place moves by -M sum b'_i d_i + sum b'_i r_i, exactly, and
/// all b' are within 0 and 1. So rounding costs at most node_bound (1 + |M|): the quantum over the
/// smallest altitude, times the longest rest edge.
/// @pre the mesh at rest lies within the source
inline PositionErrors position_errors(const Probed& probed,
                                      const scenes::Scene& scene,
                                      std::size_t stride = 1) {
  const Mesh& mesh = scene.mesh;
  const IndexFromWorld output = index_from_world(scene.output_grid);
  const IndexFromWorld source = index_from_world(scene.source_grid);
  const double of_nodes = node_bound(output, scene.deformed);
  const double of_rest_nodes = node_bound(source, mesh.rest_positions);
  PositionErrors errors;
  std::size_t owned = 0;
  for_each_owned(probed, [&](std::size_t v, const std::array<std::int64_t, 3>& ijk, std::size_t t) {
    if (owned++ % stride != 0) return;
    const TetQuanta deformed = rounded_tet(output, mesh, scene.deformed, t);
    const TetQuanta rest = rounded_tet(source, mesh, mesh.rest_positions, t);
    const TetReals given_deformed = given_tet(output, mesh, scene.deformed, t);
    const TetReals given_rest = given_tet(source, mesh, mesh.rest_positions, t);
    const Real3 rounded = rounded_position(deformed, rest, ijk);
    const Real3 given = given_position(given_deformed, given_rest, ijk);
    double evaluation = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // Beyond the outermost centers the source is constant.
      const auto last = static_cast<long double>(scene.source_grid.dims[axis] - 1);
      const double expected = wave(std::clamp(rounded[axis], 0.0L, last));
      evaluation = std::max(evaluation, std::abs(probed.samples[axis][v] - expected));
    }
    const auto rounding = static_cast<double>(length(minus(rounded, given)));
    const double evaluation_limit =
        evaluation_bound(voxels_of(deformed), voxels_of(rest), probed.type);
    const double rounding_limit =
        of_nodes * stretch_bound(given_deformed, given_rest) + of_rest_nodes;
    errors.evaluation = std::max(errors.evaluation, evaluation);
    errors.evaluation_share = std::max(errors.evaluation_share, evaluation / evaluation_limit);
    errors.rounding = std::max(errors.rounding, rounding);
    errors.rounding_share = std::max(errors.rounding_share, rounding / rounding_limit);
    errors.strays += !is_inside(deformed, voxel_center(ijk[0], ijk[1], ijk[2]));
    ++errors.voxels;
  });
  return errors;
}

}  // namespace tetwarp::test
