/// @file triangle_tree.hpp
/// Boxes of triangles as a binary tree: finds the triangles near a box.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/base/point3.hpp"

namespace tetwarp {

class TriangleTree {
 public:
  /// Memory: two boxes per triangle. Time: n log n.
  TriangleTree(const std::vector<Point3>& points,
               const std::vector<std::array<std::int32_t, 3>>& triangles);

  /// Calls visit(triangle) for all triangles whose boxes have a point in common with `box`, in an
  /// order that depends only on the triangles.
  template <class Visit>
  void visit(const Bounds& box, const Visit& visit) const {
    if (!nodes_.empty()) visit_node(0, box, visit);
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

  std::vector<Bounds> boxes_;        ///< [triangles]
  std::vector<std::int32_t> order_;  ///< triangles by leaves
  std::vector<Node> nodes_;
};

}  // namespace tetwarp
