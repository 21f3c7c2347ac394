/// @file contact_islands.cpp
/// Joins coupling islands over contacts.
#include "host/simulate/solve/problem/contact_islands.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/disjoint_sets.hpp"
#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {
/// Smaller weights are rounding errors of zero: such a point moves with prescribed blocks only.
constexpr double least_share = 1e-12;

}  // namespace

ContactIslands::ContactIslands(const SceneSurfaces& scene, const Model& model)
    : first_frame_(model.node_count),
      island_of_(index_of(model.block_count()), -1),
      is_coupled_(index_of(model.island_count)),
      has_contacts_(index_of(model.island_count)),
      is_soft_(index_of(model.island_count)),
      root_(index_of(model.island_count)) {
  std::vector<std::int32_t> bodies(index_of(model.island_count));
  for (std::size_t body = 0; body < model.body_island.size(); ++body) {
    const std::int32_t island = model.body_island[body];
    const auto set = [&](std::int64_t block) {
      if (model.prescribed[index_of(block)] == 0) island_of_[index_of(block)] = island;
    };
    for (std::int32_t n = model.body_node[body]; n < model.body_node[body + 1]; ++n) set(n);
    const std::int32_t rigid = model.body_rigid[body];
    if (rigid >= 0) {
      set(model.node_count + 2 * std::int64_t{rigid});
      set(model.node_count + 2 * std::int64_t{rigid} + 1);
    }
    if (island >= 0 && (rigid < 0 || ++bodies[index_of(island)] > 1))
      is_coupled_[index_of(island)] = 1;
  }
  for (const ModelPoint& point : scene.vertex_point) {
    Unknowns& own = of_vertex_.emplace_back();
    const auto add = [&](std::int32_t block, double weight) {
      if (of_block(block) >= 0) own = {of_block(block), std::max(own.share, std::abs(weight))};
    };
    if (point.rigid >= 0) add(first_frame_ + 2 * point.rigid, 1);
    for (std::size_t n = 0; n < 4 && point.rigid < 0; ++n) {
      if (point.node[n] >= 0) add(point.node[n], point.weight[n]);
    }
  }
}

ContactIslands::Unknowns ContactIslands::of_side(const ContactSide& side) const {
  if (side.frame >= 0) {
    const std::int32_t island = of_block(first_frame_ + 2 * side.frame);
    return {island, island >= 0 ? 1.0 : 0.0};
  }
  Unknowns sum;
  for (int k = 0; k < 3; ++k) {
    if (side.vertex[k] < 0) continue;
    const Unknowns& own = of_vertex_[index_of(side.vertex[k])];
    if (own.island < 0) continue;
    sum = {own.island, std::max(sum.share, std::abs(side.weight[k]) * own.share)};
  }
  return sum;
}

void ContactIslands::join(std::span<const ContactSides> contacts) {
  std::fill(has_contacts_.begin(), has_contacts_.end(), 0);
  DisjointSets joined(root_.size());
  of_contact_.assign(contacts.size(), -1);
  for (std::size_t c = 0; c < of_contact_.size(); ++c) {
    const Unknowns a = of_side(contacts[c].a), b = of_side(contacts[c].b);
    if (std::max(a.share, b.share) < least_share) continue;
    for (const std::int32_t island : {a.island, b.island}) {
      if (island < 0) continue;
      has_contacts_[index_of(island)] = 1;
      if (of_contact_[c] < 0) of_contact_[c] = island;
      joined.unite(index_of(of_contact_[c]), index_of(island));
    }
  }
  contact_island_count_ = 0;
  std::fill(is_soft_.begin(), is_soft_.end(), 0);
  for (std::int32_t i = 0; i < count(); ++i) {
    root_[index_of(i)] = static_cast<std::int32_t>(joined.root_of(index_of(i)));
    if (is_coupled_[index_of(i)] != 0) is_soft_[index_of(root_[index_of(i)])] = 1;
    if (root_[index_of(i)] == i && has_contacts(i)) ++contact_island_count_;
  }
}

}  // namespace tetwarp
