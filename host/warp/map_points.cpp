/// @file map_points.cpp
/// Checks the arguments of map_points() and chooses the back end.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tetwarp/map_points.hpp>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/base/point_backend.hpp"
#include "host/warp/hex_split.hpp"

namespace tetwarp {
namespace {
void check_deformed(const Mesh& mesh, const std::vector<Point3>& deformed) {
  if (deformed.size() != mesh.rest_positions.size()) {
    throw std::invalid_argument("deformed positions: expected " +
                                std::to_string(mesh.rest_positions.size()) +
                                " nodes as at rest, got " + std::to_string(deformed.size()));
  }
  for (std::size_t n = 0; n < deformed.size(); ++n) {
    if (!is_finite(deformed[n])) {
      throw std::invalid_argument("deformed positions: node " + std::to_string(n) +
                                  " is not finite");
    }
  }
}

/// Its spacing is a power of two, so that rounding keeps positions of few binary digits.
Grid grid_around(const std::vector<Point3>& nodes) {
  const Bounds bounds = bounds_of(nodes);
  double longest = 0x1p-500;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    longest = std::max(longest, bounds.high[axis] - bounds.low[axis]);
  }
  constexpr int bits = 17;  // quanta are 2^-20 of a voxel
  const double edge = std::ldexp(1.0, static_cast<int>(std::ceil(std::log2(longest))) - bits);
  return {.dims = {1, 1, 1}, .origin = bounds.low, .spacing = {edge, edge, edge}};
}

void move(Backend backend, const PointPlan& plan, MappedPoints& result) {
  switch (backend) {
    case Backend::cuda:
      return move_points_cuda(plan, result);
    case Backend::reference:
      return move_points_reference(plan, result);
    default:
      return move_points_cpu(plan, result);
  }
}

MappedPoints moved(const Mesh& mesh,
                   const std::vector<MidNodes>& mid_nodes,
                   const std::vector<Point3>& deformed,
                   std::vector<Point3> points,
                   const MapPointsOptions& options) {
  check_deformed(mesh, deformed);
  const int threads = thread_count(options.threads);
  const Backend backend = options.backend == Backend::automatic
                              ? Backend::cpu
                              : choose_backend(options.backend, options.device).first;
  const Mesh split = with_split_hexes(mesh);
  const std::vector<Point3>& from = options.inverse ? deformed : mesh.rest_positions;
  const std::vector<Point3>& to = options.inverse ? mesh.rest_positions : deformed;
  const Grid grid = options.grid.value_or(grid_around(from));
  check_grid(grid, "grid of the points");
  MappedPoints result{.points = std::move(points), .owners = {}};
  result.owners.resize(result.points.size());
  move(backend, {split, mid_nodes, from, to, grid, options.device, threads}, result);
  result.outside = std::count(result.owners.begin(), result.owners.end(), -1);
  return result;
}
}  // namespace

MappedPoints map_points(const Mesh& mesh,
                        const std::vector<Point3>& deformed,
                        std::vector<Point3> points,
                        const MapPointsOptions& options) {
  check_mesh(mesh);
  return moved(mesh, {}, deformed, std::move(points), options);
}

MappedPoints map_points(const CurvedMesh& mesh,
                        const std::vector<Point3>& deformed,
                        std::vector<Point3> points,
                        const MapPointsOptions& options) {
  check_mesh(mesh.mesh);
  check_mid_nodes(mesh.mesh, mesh.mid_nodes);
  return moved(mesh.mesh, mesh.mid_nodes, deformed, std::move(points), options);
}

}  // namespace tetwarp
