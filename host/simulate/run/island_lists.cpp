// The blocks, springs and sizes of coupling islands that IslandSleep looks at.
#include <algorithm>
#include <limits>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/run/island_sleep.hpp"

namespace tetwarp {
namespace {

double diagonal_of(const std::vector<Point3>& points) {
  if (points.empty()) return 0;
  const Bounds bounds = bounds_of(points);
  return norm(minus(bounds.high, bounds.low));
}

}  // namespace

IslandSleep::IslandSleep(const Scene& scene, const SceneGeometry& geometry, const Model& model)
    : model_(model), is_on_(scene.solver.sleeping) {
  if (!is_on_) return;
  const std::size_t bodies = scene.bodies.size(), all = bodies + scene.obstacles.size();
  const auto islands = index_of(model.island_count);
  now_ = {std::vector<std::uint8_t>(islands), std::vector<double>(islands),
          std::vector<std::uint64_t>(islands)};
  islands_.resize(islands);
  for (Island& island : islands_) island.size = std::numeric_limits<double>::infinity();
  body_driven_.resize(all);
  is_driven_.resize(all);
  body_size_.resize(all);
  block_body_.assign(index_of(model.block_count()), -1);
  for (std::size_t b = 0; b < bodies; ++b) {
    const auto first = model.body_node[b], end = model.body_node[b + 1];
    std::fill(block_body_.begin() + first, block_body_.begin() + end, static_cast<int>(b));
    const BodyGeometry& of = geometry.bodies[b];
    body_size_[b] = diagonal_of(of.nodes.empty() ? of.surface.points : of.nodes);
  }
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    const auto block = index_of(model.node_count + 2 * r);
    block_body_[block] = block_body_[block + 1] = model.rigid.body[index_of(r)];
  }
  for (std::size_t k = 0; k < block_body_.size(); ++k) {
    const std::int32_t body = block_body_[k], island = body < 0 ? -1 : island_of(body);
    const auto block = static_cast<std::int32_t>(k);
    const bool is_prescribed = model.prescribed[k] != 0;
    if (is_prescribed && body >= 0) body_driven_[index_of(body)].push_back(block);
    if (island < 0) continue;
    Island& own = islands_[index_of(island)];
    (is_prescribed ? own.driven : own.blocks).push_back(block);
  }
  for (std::size_t b = 0; b < bodies; ++b) {
    const std::int32_t island = model.body_island[b];
    if (island < 0) continue;
    Island& own = islands_[index_of(island)];
    own.bodies.push_back(static_cast<std::int32_t>(b));
    own.size = std::min(own.size, body_size_[b]);
  }
  for (std::size_t s = 0; s < model.springs.a.size(); ++s) {
    const ModelPoint &a = model.springs.a[s], &b = model.springs.b[s];
    for (const auto& [end, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
      const std::int32_t island = end->body < 0 ? -1 : island_of(end->body);
      if (island < 0) continue;
      Island& own = islands_[index_of(island)];
      if (model.springs.handle[s] >= 0) own.springs.push_back(static_cast<std::int32_t>(s));
      add_driven(*other, own);
    }
  }
  for (Island& island : islands_) {
    std::sort(island.driven.begin(), island.driven.end());
    island.driven.erase(std::unique(island.driven.begin(), island.driven.end()),
                        island.driven.end());
  }
}

void IslandSleep::add_driven(const ModelPoint& point, Island& island) const {
  const auto add = [&](std::int32_t block) {
    if (model_.prescribed[index_of(block)] != 0) island.driven.push_back(block);
  };
  if (point.rigid >= 0) {
    add(model_.node_count + 2 * point.rigid);
    add(model_.node_count + 2 * point.rigid + 1);
    return;
  }
  for (std::size_t k = 0; k < 4 && point.node[k] >= 0; ++k) add(point.node[k]);
}

}  // namespace tetwarp
