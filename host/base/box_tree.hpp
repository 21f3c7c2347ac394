/// @file box_tree.hpp
/// BoxTree: boxes as a binary tree, and the boxes of triangles or tetrahedra.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <tetwarp/export.hpp>

#include "host/base/point3.hpp"

namespace tetwarp {

/// Finds the boxes of a fixed list that meet another box, or that are near a point. Memory: two
/// boxes per item. Time: n log n.
class BoxTree {
 public:
  TETWARP_EXPORT explicit BoxTree(std::vector<Bounds> boxes);

  /// Calls visit(item) for all boxes that have a point in common with `box`, in an order that
  /// depends only on the boxes of the tree.
  template <class Visit>
  void visit(const Bounds& box, const Visit& visit) const {
    if (!nodes_.empty()) visit_node(0, box, visit);
  }

  /// Calls visit(item) for the boxes that are not farther from the point than `reach`, nearer parts
  /// of the tree first. The calls may make `reach` smaller.
  template <class Visit>
  void visit_near(const Point3& point, const double& reach, const Visit& visit) const {
    if (!nodes_.empty()) visit_node_near(0, point, reach, visit);
  }

 private:
  struct Node {
    Bounds box;
    std::int32_t begin = 0, end = 0;  ///< in order_
    std::int32_t second = -1;         ///< child; the first follows its parent. -1: a leaf
  };
  static bool overlap(const Bounds& a, const Bounds& b) {
    for (std::size_t d = 0; d < 3; ++d) {
      if (a.low[d] > b.high[d] || b.low[d] > a.high[d]) return false;
    }
    return true;
  }
  /// Of a point and a box, less a bound of the rounding.
  static double distance(const Bounds& box, const Point3& point) {
    double square = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      const double outside = std::max({box.low[d] - point[d], point[d] - box.high[d], 0.0});
      square += outside * outside;
    }
    return std::sqrt(square) * (1 - 1e-12);
  }
  void build(std::int32_t begin, std::int32_t end);

  template <class Visit>
  void visit_node(std::int32_t index, const Bounds& box, const Visit& visit) const {
    const Node& node = at(nodes_, index);
    if (!overlap(node.box, box)) return;
    if (node.second < 0) {
      for (std::int32_t i = node.begin; i < node.end; ++i) {
        if (overlap(at(boxes_, at(order_, i)), box)) visit(at(order_, i));
      }
      return;
    }
    visit_node(index + 1, box, visit);
    visit_node(node.second, box, visit);
  }

  template <class Visit>
  void visit_node_near(std::int32_t index,
                       const Point3& point,
                       const double& reach,
                       const Visit& visit) const {
    const Node& node = at(nodes_, index);
    if (node.second < 0) {
      for (std::int32_t i = node.begin; i < node.end; ++i) {
        const std::int32_t item = at(order_, i);
        if (!(distance(at(boxes_, item), point) > reach)) visit(item);
      }
      return;
    }
    std::int32_t nearer = index + 1, farther = node.second;
    double near = distance(at(nodes_, nearer).box, point);
    double far = distance(at(nodes_, farther).box, point);
    if (far < near) std::swap(near, far), std::swap(nearer, farther);
    if (!(near > reach)) visit_node_near(nearer, point, reach, visit);
    if (!(far > reach)) visit_node_near(farther, point, reach, visit);
  }

  std::vector<Bounds> boxes_;
  std::vector<std::int32_t> order_;  ///< items by leaves
  std::vector<Node> nodes_;
};

/// The boxes of items, each given by the numbers of its points.
template <class Item>
std::vector<Bounds> boxes_of(const std::vector<Point3>& points, const std::vector<Item>& items) {
  std::vector<Bounds> boxes;
  boxes.reserve(items.size());
  for (const Item& item : items) {
    Bounds& box = boxes.emplace_back();
    for (const std::int32_t corner : item) box.include(at(points, corner));
  }
  return boxes;
}

}  // namespace tetwarp
