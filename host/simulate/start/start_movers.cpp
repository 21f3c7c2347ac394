/// @file start_movers.cpp
/// Numbers coupling islands, or nodes and rigid bodies, that are free.
#include "host/simulate/start/start_movers.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
constexpr std::int32_t held = -1;
}

StartMovers::StartMovers(const Model& model) : model_(model) {
  set_islands();
}

double StartMovers::mass(std::int32_t mover) const {
  return at(mass_, mover);
}
bool StartMovers::is_held(std::int64_t block) const {
  return model_.prescribed[index_of(block)] != 0;
}
std::int64_t StartMovers::block_of_rigid(std::int32_t rigid) const {
  return model_.node_count + 2 * std::int64_t{rigid};
}

template <class VisitNode, class VisitRigid>
void StartMovers::visit_parts(const VisitNode& visit_node, const VisitRigid& visit_rigid) const {
  for (std::int32_t b = 0; b < std::ssize(model_.body_island); ++b) {
    const std::int32_t island = at(model_.body_island, b);
    if (island < 0) continue;
    for (std::int32_t n = at(model_.body_node, b); n < at(model_.body_node, b + 1); ++n) {
      visit_node(n, island);
    }
    if (const std::int32_t r = at(model_.body_rigid, b); r >= 0) visit_rigid(r, island);
  }
}

void StartMovers::hold_all() {
  of_node_.assign(index_of(model_.node_count), held);
  of_rigid_.assign(index_of(model_.rigid_count), held);
  mass_.clear();
}
std::int32_t StartMovers::new_mover(double mass) {
  mass_.push_back(mass);
  return count() - 1;
}

void StartMovers::set_islands() {
  hold_all();
  std::vector<double> mass(index_of(model_.island_count), 0);
  std::vector<std::uint8_t> is_free(mass.size(), 1);
  const auto add = [&](std::int32_t island, std::int64_t block, double own) {
    mass[index_of(island)] += own;
    if (is_held(block)) is_free[index_of(island)] = 0;
  };
  visit_parts([&](std::int32_t n, std::int32_t island) { add(island, n, at(model_.node_mass, n)); },
              [&](std::int32_t r, std::int32_t island) {
                add(island, block_of_rigid(r), at(model_.rigid.mass, r));
              });
  std::vector<std::int32_t> mover(mass.size(), held);
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (is_free[i] != 0) mover[i] = new_mover(mass[i]);
  }
  visit_parts(
      [&](std::int32_t n, std::int32_t island) { of_node_[index_of(n)] = at(mover, island); },
      [&](std::int32_t r, std::int32_t island) { of_rigid_[index_of(r)] = at(mover, island); });
}

void StartMovers::divide() {
  hold_all();
  are_divided_ = true;
  visit_parts(
      [&](std::int32_t n, std::int32_t) {
        if (!is_held(n)) of_node_[index_of(n)] = new_mover(at(model_.node_mass, n));
      },
      [&](std::int32_t r, std::int32_t) {
        if (is_held(block_of_rigid(r))) return;
        of_rigid_[index_of(r)] = new_mover(at(model_.rigid.mass, r));
      });
}

void StartMovers::add_shares(const ModelPoint& point,
                             double weight,
                             std::vector<Share>& shares) const {
  if (point.rigid >= 0) return add_share(at(of_rigid_, point.rigid), weight, shares);
  for (std::size_t a = 0; a < 4 && point.node[a] >= 0; ++a) {
    add_share(at(of_node_, point.node[a]), weight * point.weight[a], shares);
  }
}
void StartMovers::add_share(std::int32_t mover, double weight, std::vector<Share>& shares) {
  if (mover == held) return;
  const auto own = std::ranges::find(shares, mover, &Share::mover);
  if (own == shares.end()) {
    shares.push_back({mover, weight});
  } else {
    own->weight += weight;
  }
}

void StartMovers::move(std::span<const double> way, double fraction, ModelState& state) const {
  const auto add = [&](std::size_t place, std::int32_t mover) {
    for (std::size_t d = 0; d < 3 && mover != held; ++d) {
      state.position[place][d] += fraction * way[3 * index_of(mover) + d];
    }
  };
  for (std::size_t n = 0; n < of_node_.size(); ++n) add(n, of_node_[n]);
  for (std::size_t r = 0; r < of_rigid_.size(); ++r) {
    add(index_of(model_.node_count) + r, of_rigid_[r]);
  }
}

}  // namespace tetwarp
