/// @file island_lists.cpp
/// Lists of bodies, blocks and springs by coupling island.
#include "host/simulate/state/island_lists.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

double diagonal_of(const std::vector<Point3>& points) {
  if (points.empty()) return 0;
  const Bounds bounds = bounds_of(points);
  return norm(minus(bounds.high, bounds.low));
}

}  // namespace

IslandLists::IslandLists(const Scene& scene, const SceneGeometry& geometry, const Model& model)
    : model_(model) {
  list_bodies(scene, geometry);
  list_frames();
  list_blocks();
  list_springs();
  for (Island& island : islands_) {
    std::sort(island.driven.begin(), island.driven.end());
    island.driven.erase(std::unique(island.driven.begin(), island.driven.end()),
                        island.driven.end());
  }
}

void IslandLists::list_bodies(const Scene& scene, const SceneGeometry& geometry) {
  islands_.resize(index_of(model_.island_count));
  for (Island& island : islands_) island.size = std::numeric_limits<double>::infinity();
  body_size_.resize(scene.bodies.size() + scene.obstacles.size());
  body_driven_.resize(body_size_.size());
  block_body_.assign(index_of(model_.block_count()), -1);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const auto body = static_cast<std::int32_t>(b);
    std::fill(block_body_.begin() + model_.body_node[b],
              block_body_.begin() + model_.body_node[b + 1], body);
    const BodyGeometry& of = geometry.bodies[b];
    body_size_[b] = diagonal_of(of.nodes.empty() ? of.surface.points : of.nodes);
    if (model_.body_island[b] < 0) continue;
    Island& island = islands_[index_of(model_.body_island[b])];
    island.bodies.push_back(body);
    island.size = std::min(island.size, body_size_[b]);
  }
}

void IslandLists::list_frames() {
  for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
    const std::size_t block = index_of(model_.node_count + 2 * r);
    block_body_[block] = block_body_[block + 1] = at(model_.rigid.body, r);
  }
}

void IslandLists::list_blocks() {
  for (std::size_t k = 0; k < block_body_.size(); ++k) {
    const std::int32_t body = block_body_[k], island = body < 0 ? -1 : island_of(body);
    const auto block = static_cast<std::int32_t>(k);
    const bool is_prescribed = model_.prescribed[k] != 0;
    if (is_prescribed && body >= 0) body_driven_[index_of(body)].push_back(block);
    if (island < 0) continue;
    Island& own = islands_[index_of(island)];
    (is_prescribed ? own.driven : own.blocks).push_back(block);
  }
}

void IslandLists::list_springs() {
  const ModelSprings& springs = model_.springs;
  for (std::size_t s = 0; s < springs.a.size(); ++s) {
    const ModelPoint &a = springs.a[s], &b = springs.b[s];
    for (const auto& [end, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
      const std::int32_t island = end->body < 0 ? -1 : island_of(end->body);
      if (island < 0) continue;
      Island& own = islands_[index_of(island)];
      if (springs.handle[s] >= 0) own.springs.push_back(static_cast<std::int32_t>(s));
      add_driven(*other, own);
    }
  }
}

void IslandLists::add_driven(const ModelPoint& point, Island& island) const {
  const auto add = [&](std::int32_t block) {
    if (at(model_.prescribed, block) != 0) island.driven.push_back(block);
  };
  if (point.rigid >= 0) {
    add(model_.node_count + 2 * point.rigid);
    add(model_.node_count + 2 * point.rigid + 1);
    return;
  }
  for (std::size_t k = 0; k < 4 && point.node[k] >= 0; ++k) add(point.node[k]);
}

std::int32_t IslandLists::turning_frame(std::int32_t block) const {
  const std::int32_t past = block - model_.node_count;
  return past >= 0 && past % 2 == 1 ? past / 2 : -1;
}

const Point3& IslandLists::place_of(std::int32_t block, const ModelState& state) const {
  const std::int32_t past = block - model_.node_count;
  return at(state.position, past < 0 ? block : model_.node_count + past / 2);
}

double IslandLists::size_of(std::int32_t block) const {
  const std::int32_t body = at(block_body_, block);
  return body < 0 ? 0 : at(body_size_, body);
}

}  // namespace tetwarp
