/// @file contact_islands.cpp
#include "host/contact_islands.hpp"

#include <algorithm>
#include <numeric>

#include "host/contact_exec_cpu.hpp"
#include "kernels/contact_color.hpp"

namespace tetwarp {

namespace {

/// Root of a tree of parents, paths halved on the way.
std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t item) {
  auto i = static_cast<std::size_t>(item);
  while (parent[i] != static_cast<std::int32_t>(i)) {
    parent[i] = parent[static_cast<std::size_t>(parent[i])];
    i = static_cast<std::size_t>(parent[i]);
  }
  return static_cast<std::int32_t>(i);
}

template <class T>
View<const T> view_of(const std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

}  // namespace

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

std::vector<std::int32_t> components_of(const Lists& lists, std::int64_t item_count) {
  std::vector<std::int32_t> parent(static_cast<std::size_t>(item_count));
  std::iota(parent.begin(), parent.end(), 0);
  for (std::int64_t list = 0; list < lists.size(); ++list) {
    const std::span<const std::int32_t> items = lists.of(list);
    for (std::size_t k = 1; k < items.size(); ++k) {
      const std::int32_t a = root_of(parent, items[0]);
      const std::int32_t b = root_of(parent, items[k]);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  std::int32_t count = 0;
  std::vector<std::int32_t> component(parent.size());
  for (std::size_t i = 0; i < parent.size(); ++i) {
    const std::int32_t root = root_of(parent, static_cast<std::int32_t>(i));
    component[i] =
        root == static_cast<std::int32_t>(i) ? count++ : component[static_cast<std::size_t>(root)];
  }
  return component;
}

ContactOrder make_contact_order(const Lists& groups, std::span<const std::int32_t> island) {
  const std::int64_t group_count =
      groups.item.empty() ? 0 : *std::max_element(groups.item.begin(), groups.item.end()) + 1;
  const Lists members = make_transposed(groups, group_count);
  std::vector<std::int32_t> colors(island.size(), uncolored);
  CpuContactExec exec(1);
  contact_color(exec,
                ContactGroups{view_of(groups.start), view_of(groups.item), view_of(members.start),
                              view_of(members.item)},
                View<std::int32_t>{colors.data(), static_cast<std::int64_t>(colors.size())});

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
