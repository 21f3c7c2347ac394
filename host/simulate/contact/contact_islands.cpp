#include "host/simulate/contact/contact_islands.hpp"

#include <algorithm>
#include <numeric>

namespace tetwarp {
namespace {
/// Weights below this one are rounding errors of zero: the point is one of prescribed blocks only.
constexpr double least_share = 1e-12;

std::size_t at(std::int64_t index) {
  return static_cast<std::size_t>(index);
}
}  // namespace

ContactIslands::ContactIslands(const Model& model)
    : island_of_(at(model.block_count()), -1),
      is_coupled_(at(model.island_count)),
      has_contacts_(at(model.island_count)),
      is_soft_(at(model.island_count)),
      root_(at(model.island_count)) {
  std::vector<std::int32_t> bodies(at(model.island_count));
  for (std::size_t body = 0; body < model.body_island.size(); ++body) {
    const std::int32_t island = model.body_island[body];
    const auto set = [&](std::int64_t block) {
      if (model.prescribed[at(block)] == 0) island_of_[at(block)] = island;
    };
    for (std::int32_t n = model.body_node[body]; n < model.body_node[body + 1]; ++n) set(n);
    const std::int32_t rigid = model.body_rigid[body];
    if (rigid >= 0) {
      set(model.node_count + 2 * std::int64_t{rigid});
      set(model.node_count + 2 * std::int64_t{rigid} + 1);
    }
    if (island >= 0 && (rigid < 0 || ++bodies[at(island)] > 1)) is_coupled_[at(island)] = 1;
  }
}

std::int32_t ContactIslands::root_of(std::int32_t island) {
  while (root_[at(island)] != island) {
    root_[at(island)] = root_[at(root_[at(island)])];
    island = root_[at(island)];
  }
  return island;
}

bool ContactIslands::moves_unknowns(const ContactRows& rows, std::size_t contact) const {
  for (std::int32_t e = rows.start[contact]; e < rows.start[contact + 1]; ++e) {
    if (of_block(rows.block[at(e)]) < 0) continue;
    const double* const normal = rows.value[at(e)].data();
    const double square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    if (square >= least_share * least_share) return true;
  }
  return false;
}

void ContactIslands::join(const ContactRows& rows) {
  std::fill(has_contacts_.begin(), has_contacts_.end(), 0);
  std::iota(root_.begin(), root_.end(), 0);
  of_contact_.assign(rows.start.size() - 1, -1);
  for (std::size_t c = 0; c < of_contact_.size(); ++c) {
    if (!moves_unknowns(rows, c)) continue;
    for (const std::int32_t block : rows.blocks_of(c)) {
      const std::int32_t island = of_block(block);
      if (island < 0) continue;
      has_contacts_[at(island)] = 1;
      if (of_contact_[c] < 0) of_contact_[c] = island;
      const std::int32_t a = root_of(of_contact_[c]), b = root_of(island);
      root_[at(std::max(a, b))] = std::min(a, b);
    }
  }
  contact_island_count_ = 0;
  std::fill(is_soft_.begin(), is_soft_.end(), 0);
  for (std::int32_t i = 0; i < count(); ++i) {
    root_[at(i)] = root_of(i);  // the smallest island of each contact island
    if (is_coupled_[at(i)] != 0) is_soft_[at(root_[at(i)])] = 1;
    if (root_[at(i)] == i && has_contacts(i)) ++contact_island_count_;
  }
}

}  // namespace tetwarp
