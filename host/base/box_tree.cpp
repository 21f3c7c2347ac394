/// @file box_tree.cpp
/// Divides the boxes into halves along their longest extent.
#include "host/base/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tetwarp {
namespace {
constexpr std::int32_t leaf_size = 8;
}

BoxTree::BoxTree(std::vector<Bounds> boxes) : boxes_(std::move(boxes)) {
  order_.resize(boxes_.size());
  std::iota(order_.begin(), order_.end(), 0);
  if (!order_.empty()) build(0, static_cast<std::int32_t>(order_.size()));
}

void BoxTree::build(std::int32_t begin, std::int32_t end) {
  const std::size_t index = nodes_.size();
  Node node{{}, begin, end, -1};
  for (std::int32_t i = begin; i < end; ++i) {
    node.box.include(at(boxes_, at(order_, i)).low);
    node.box.include(at(boxes_, at(order_, i)).high);
  }
  nodes_.push_back(node);
  if (end - begin <= leaf_size) return;
  const Point3 extent = minus(node.box.high, node.box.low);
  const auto axis =
      static_cast<std::size_t>(std::max_element(extent.begin(), extent.end()) - extent.begin());
  const std::int32_t middle = begin + (end - begin) / 2;
  const auto center = [&](std::int32_t item) {
    return at(boxes_, item).low[axis] + at(boxes_, item).high[axis];
  };
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::int32_t a, std::int32_t b) {
                     return center(a) != center(b) ? center(a) < center(b) : a < b;
                   });
  build(begin, middle);
  nodes_[index].second = static_cast<std::int32_t>(nodes_.size());
  build(middle, end);
}

}  // namespace tetwarp
