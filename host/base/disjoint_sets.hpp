/// @file disjoint_sets.hpp
/// DisjointSets: union-find over numbered items.
#pragma once
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace tetwarp {

/// Sets of items, each named by its lowest. Tarjan 1975, with path halving; joined by number
/// instead of rank.
class DisjointSets {
 public:
  /// Sets of one item each.
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  /// The lowest item of the set. @pre item < count
  std::size_t root_of(std::size_t item) {
    while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
    return item;
  }
  void unite(std::size_t a, std::size_t b) {
    const auto [low, high] = std::minmax({root_of(a), root_of(b)});
    parent_[high] = low;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace tetwarp
