/// @file triangle_tree.cpp
/// Divides the triangles into halves along the longest extent of their boxes.
#include "host/simulate/surfaces/triangle_tree.hpp"

#include <algorithm>
#include <numeric>

namespace tetwarp {
namespace {
constexpr std::int32_t leaf_size = 8;
}

TriangleTree::TriangleTree(const std::vector<Point3>& points,
                           const std::vector<std::array<std::int32_t, 3>>& triangles) {
  boxes_.reserve(triangles.size());
  for (const auto& triangle : triangles) {
    Bounds& box = boxes_.emplace_back();
    for (const std::int32_t corner : triangle) box.include(at(points, corner));
  }
  order_.resize(triangles.size());
  std::iota(order_.begin(), order_.end(), 0);
  if (!order_.empty()) build(0, static_cast<std::int32_t>(order_.size()));
}

void TriangleTree::build(std::int32_t begin, std::int32_t end) {
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
  const auto centre = [&](std::int32_t t) {
    return at(boxes_, t).low[axis] + at(boxes_, t).high[axis];
  };
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::int32_t a, std::int32_t b) {
                     return centre(a) != centre(b) ? centre(a) < centre(b) : a < b;
                   });
  build(begin, middle);
  nodes_[index].second = static_cast<std::int32_t>(nodes_.size());
  build(middle, end);
}

}  // namespace tetwarp
