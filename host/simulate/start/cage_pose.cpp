/// @file cage_pose.cpp
/// Weights of nodes in their cage, and the least volume of their tetrahedra.
#include "host/simulate/start/cage_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/point3.hpp"
#include "host/simulate/surfaces/round_shape.hpp"

namespace tetwarp {
namespace {

constexpr double most_cells = 3;        // of a cage along its longest axis
constexpr std::int64_t fine_parts = 4;  // of a box of the cage, for the weights

std::array<std::int64_t, 3> cage_cells(const Bounds& bounds) {
  const Point3 extent = minus(bounds.high, bounds.low);
  const double longest = *std::max_element(extent.begin(), extent.end());
  std::array<std::int64_t, 3> cells{};
  for (std::size_t d = 0; d < 3; ++d) {
    cells[d] = std::max<std::int64_t>(1, std::llround(most_cells * extent[d] / longest));
  }
  return cells;
}

}  // namespace

CagePose::CagePose(const StartParts& parts, const Model& model, const ShrunkBody& shrunk)
    : body_(shrunk.body),
      first_(at(model.body_node, shrunk.body)),
      end_(at(model.body_node, shrunk.body + 1)) {
  const auto index = static_cast<std::size_t>(body_);
  const BodyGeometry& of = parts.geometry.bodies[index];
  const Bounds bounds = bounds_of(of.nodes);
  size_ = norm(minus(bounds.high, bounds.low));
  cage_ = make_cage_weights(place_of_body(parts.scene, body_), bounds, cage_cells(bounds),
                            fine_parts, of.nodes);
  for (const Point3& vertex : cage_.vertices) {
    target_.push_back(world_of(parts.scene.bodies[index].pose, vertex));
    vertices_.push_back(
        plus(shrunk.center, times(shrunk.scale, minus(target_.back(), shrunk.center))));
  }
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    if (has_node(model.tets.nodes[t][0])) tets_.push_back(static_cast<std::int32_t>(t));
  }
}

void CagePose::add_weights(std::int32_t node, double factor, std::vector<double>& weights) const {
  const std::size_t first = static_cast<std::size_t>(node - first_) * vertex_count();
  for (std::size_t v = 0; v < vertex_count(); ++v) weights[v] += factor * cage_.weight[first + v];
}

void CagePose::place_nodes(const std::vector<Point3>& move,
                           double fraction,
                           ModelState& state) const {
  std::vector<Point3> moved = vertices_;
  for (std::size_t v = 0; v < moved.size(); ++v) {
    moved[v] = plus(moved[v], times(fraction, move[v]));
  }
  const std::vector<Point3> nodes = caged_points(cage_, moved);
  std::copy(nodes.begin(), nodes.end(), state.position.begin() + first_);
}

double CagePose::least_volume(const Model& model, const ModelState& state) const {
  double least = std::numeric_limits<double>::infinity();
  for (const std::int32_t t : tets_) {
    const auto [a, b, c, d] = at(model.tets.nodes, t);
    const double volume = tet_volume(at(state.position, a), at(state.position, b),
                                     at(state.position, c), at(state.position, d));
    least = std::min(least, volume / at(model.tets.volume, t));
  }
  return least;
}

}  // namespace tetwarp
