#include "host/simulate/contact/contact_islands.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>
#include <numeric>

namespace tetwarp {
namespace {
/// Weights below this one are rounding errors of zero: the point is one of prescribed blocks only.
constexpr double least_share = 1e-12;

}  // namespace

ContactIslands::ContactIslands(const Model& model)
    : island_of_(index_of(model.block_count()), -1),
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
}

std::int32_t ContactIslands::root_of(std::int32_t island) {
  while (root_[index_of(island)] != island) {
    root_[index_of(island)] = root_[index_of(root_[index_of(island)])];
    island = root_[index_of(island)];
  }
  return island;
}

bool ContactIslands::moves_unknowns(const ContactRows& rows, std::size_t contact) const {
  for (std::int32_t e = rows.start[contact]; e < rows.start[contact + 1]; ++e) {
    if (of_block(rows.block[index_of(e)]) < 0) continue;
    const double* const normal = rows.value[index_of(e)].data();
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
      has_contacts_[index_of(island)] = 1;
      if (of_contact_[c] < 0) of_contact_[c] = island;
      const std::int32_t a = root_of(of_contact_[c]), b = root_of(island);
      root_[index_of(std::max(a, b))] = std::min(a, b);
    }
  }
  contact_island_count_ = 0;
  std::fill(is_soft_.begin(), is_soft_.end(), 0);
  for (std::int32_t i = 0; i < count(); ++i) {
    root_[index_of(i)] = root_of(i);  // the smallest island of each contact island
    if (is_coupled_[index_of(i)] != 0) is_soft_[index_of(root_[index_of(i)])] = 1;
    if (root_[index_of(i)] == i && has_contacts(i)) ++contact_island_count_;
  }
}

}  // namespace tetwarp
