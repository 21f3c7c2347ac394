/// @file repeated_cells.cpp
/// Sorts cells by a hash of their nodes' places, and compares those of one hash.
#include "host/base/repeated_cells.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/number_hash.hpp"

namespace tetwarp {
namespace {

/// Equal for cells that are the same.
template <std::size_t count>
using CellKey = std::array<Point3, count>;

template <std::size_t count>
CellKey<count> node_key(std::array<std::int32_t, count> cell) {
  constexpr double never = std::numeric_limits<double>::infinity();  // no coordinate
  std::sort(cell.begin(), cell.end());
  CellKey<count> key;
  for (std::size_t n = 0; n < count; ++n) key[n] = {static_cast<double>(cell[n]), never, never};
  return key;
}

template <std::size_t count>
CellKey<count> key_of(const std::vector<Point3>& points,
                      const std::array<std::int32_t, count>& cell,
                      SameCells same) {
  if (same == SameCells::nodes) return node_key(cell);
  CellKey<count> places;
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t d = 0; d < 3; ++d) places[n][d] = at(points, cell[n])[d] + 0.0;  // no -0
  }
  CellKey<count> sorted = places;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return node_key(cell);
  if (same == SameCells::places) return sorted;
  std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
  return places;
}

}  // namespace

template <std::size_t nodes_per_cell>
std::vector<std::size_t> first_copies(
    const std::vector<Point3>& points,
    const std::vector<std::array<std::int32_t, nodes_per_cell>>& cells,
    SameCells same) {
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  order.reserve(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    NumberHash hash;
    for (const Point3& x : key_of(points, cells[c], same)) {
      for (const double coordinate : x) hash.add(coordinate);
    }
    order.emplace_back(hash.value(), c);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> firsts(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) firsts[c] = c;
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    for (; end < order.size() && order[end].first == order[begin].first; ++end) {
      const std::size_t cell = order[end].second;
      for (std::size_t o = begin; o < end && firsts[cell] == cell; ++o) {
        const std::size_t other = order[o].second;
        if (firsts[other] != other) continue;
        if (key_of(points, cells[cell], same) == key_of(points, cells[other], same)) {
          firsts[cell] = other;
        }
      }
    }
    begin = end;
  }
  return firsts;
}

template TETWARP_EXPORT std::vector<std::size_t> first_copies<3>(
    const std::vector<Point3>& points,
    const std::vector<std::array<std::int32_t, 3>>& cells,
    SameCells same);
template TETWARP_EXPORT std::vector<std::size_t> first_copies<4>(
    const std::vector<Point3>& points,
    const std::vector<std::array<std::int32_t, 4>>& cells,
    SameCells same);
template TETWARP_EXPORT std::vector<std::size_t> first_copies<8>(
    const std::vector<Point3>& points,
    const std::vector<std::array<std::int32_t, 8>>& cells,
    SameCells same);

std::vector<std::size_t> first_tet_copies(const std::vector<Point3>& points,
                                          const std::vector<std::array<std::int32_t, 4>>& tets,
                                          const std::vector<MidNodes>& mid_nodes) {
  std::vector<std::size_t> firsts = first_copies(points, tets, SameCells::places);
  if (mid_nodes.empty()) return firsts;
  const auto middles = [&](std::size_t tet) {
    std::vector<Point3> places;
    for (const std::int32_t node : mid_nodes[tet]) {
      if (node >= 0) places.push_back(points[static_cast<std::size_t>(node)]);
    }
    std::sort(places.begin(), places.end());
    return places;
  };
  for (std::size_t tet = 0; tet < firsts.size(); ++tet) {
    if (firsts[tet] != tet && middles(tet) != middles(firsts[tet])) firsts[tet] = tet;
  }
  return firsts;
}

std::size_t copy_count(const std::vector<std::size_t>& firsts) {
  std::size_t copies = 0;
  for (std::size_t c = 0; c < firsts.size(); ++c) copies += firsts[c] == c ? 0 : 1;
  return copies;
}

std::string merged_text(std::size_t copies, std::size_t cells, const char* name) {
  if (copies == 0) return {};
  return std::to_string(copies) + " of " + std::to_string(cells) + " " + name +
         " are there twice and were merged";
}

}  // namespace tetwarp
