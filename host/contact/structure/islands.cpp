/// @file islands.cpp
/// Components of the graph of contacts and bodies, and the order of contacts in them.
#include "host/contact/structure/islands.hpp"

#include <algorithm>
#include <numeric>

#include "host/contact/problem/vectors.hpp"
#include "host/contact/structure/color.hpp"
#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/contact_components.hpp"

namespace tetwarp {

Lists make_transposed(const Lists& lists, std::int64_t item_count) {
  Lists result;
  result.start.assign(static_cast<std::size_t>(item_count) + 1, 0);
  for (const std::int32_t item : lists.item) ++result.start[static_cast<std::size_t>(item) + 1];
  std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
  result.item.resize(lists.item.size());
  std::vector<std::int64_t> next(result.start.begin(), result.start.end() - 1);
  for (std::int64_t list = 0; list < lists.size(); ++list) {
    for (const std::int32_t item : lists.of(list)) {
      const std::int64_t place = next[static_cast<std::size_t>(item)]++;
      result.item[static_cast<std::size_t>(place)] = static_cast<std::int32_t>(list);
    }
  }
  return result;
}

std::vector<std::int32_t> HostStages::lowest_connected(const Lists& lists,
                                                       std::int64_t item_count) {
  std::vector<std::int32_t> lowest(static_cast<std::size_t>(item_count));
  CpuExec exec(1, StageClocks::off);
  contact_components(exec, view_of(lists.start), view_of(lists.item), view_of(lowest));
  return lowest;
}

std::vector<std::int32_t> components_of(const Lists& lists,
                                        std::int64_t item_count,
                                        StructureStages& stages) {
  std::vector<std::int32_t> component = stages.lowest_connected(lists, item_count);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < component.size(); ++i) {
    const auto lowest = static_cast<std::size_t>(component[i]);
    component[i] = lowest == i ? count++ : component[lowest];
  }
  return component;
}

ContactOrder make_contact_order(const Lists& groups, std::span<const std::int32_t> island) {
  const std::int64_t group_count =
      groups.item.empty() ? 0 : *std::max_element(groups.item.begin(), groups.item.end()) + 1;
  const std::vector<std::int32_t> colors = color_contacts(groups, group_count).of_contact;

  ContactOrder order;
  order.contact_of_slot.resize(island.size());
  std::iota(order.contact_of_slot.begin(), order.contact_of_slot.end(), 0);
  const auto key = [&](std::int32_t c) {
    const auto i = static_cast<std::size_t>(c);
    return (std::int64_t{island[i]} << 32) + colors[i];
  };
  std::sort(
      order.contact_of_slot.begin(), order.contact_of_slot.end(),
      [&](std::int32_t a, std::int32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t slot = 0; slot < island.size(); ++slot) {
    const std::int64_t here = key(order.contact_of_slot[slot]);
    const std::int64_t before = slot == 0 ? -1 : key(order.contact_of_slot[slot - 1]);
    if (here == before) continue;
    if (slot == 0 || here >> 32 != before >> 32) {
      if (slot > 0) order.color_start.push_back(static_cast<std::int64_t>(slot));
      order.island_start.push_back(static_cast<std::int64_t>(slot));
      order.island_colors.push_back(static_cast<std::int64_t>(order.color_start.size()));
    }
    order.color_start.push_back(static_cast<std::int64_t>(slot));
  }
  if (!island.empty()) order.color_start.push_back(static_cast<std::int64_t>(island.size()));
  order.island_start.push_back(static_cast<std::int64_t>(island.size()));
  order.island_colors.push_back(static_cast<std::int64_t>(order.color_start.size()));
  return order;
}

}  // namespace tetwarp
