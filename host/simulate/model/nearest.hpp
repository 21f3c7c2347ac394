/// @file nearest.hpp
/// The nearest triangle or tetrahedron to a point.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/base/box_tree.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {

/// The material point nearest to a query: of a triangle or tetrahedron, with the weights of its
/// nodes, which are >= 0 and sum to 1.
template <std::size_t corners>
struct NearestPoint {
  std::int32_t item = -1;  ///< of the list; -1: the list is empty
  std::array<double, corners> weight{};
  double distance = 0;  ///< 0 inside a tetrahedron
};

/// Nearest points of the corners' convex hull; degenerate items count as their edges and points.
NearestPoint<2> nearest_on(const std::array<Point3, 2>& edge, const Point3& point);
NearestPoint<3> nearest_on(const std::array<Point3, 3>& triangle, const Point3& point);
NearestPoint<4> nearest_on(const std::array<Point3, 4>& tet, const Point3& point);

/// Searches a fixed list of triangles (3 corners) or tetrahedra (4). Of equally near items the one
/// of the lowest index is found.
template <std::size_t corners>
class NearestItems {
 public:
  using Cell = std::array<std::int32_t, corners>;

  /// @param points  finite; copied, as are the items
  NearestItems(const std::vector<Point3>& points, const std::vector<Cell>& items);
  NearestPoint<corners> find(const Point3& point) const;

 private:
  std::vector<Point3> points_;
  std::vector<Cell> items_;
  BoxTree tree_;  ///< of the items
};

extern template class NearestItems<3>;
extern template class NearestItems<4>;

}  // namespace tetwarp
