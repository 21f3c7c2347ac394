/// @file nearest.hpp
/// The nearest triangle or tetrahedron to a point, by a uniform grid of their boxes.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

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
/// of the lowest index is found. Needs memory for about four entries per item.
template <std::size_t corners>
class NearestItems {
 public:
  using Cell = std::array<std::int32_t, corners>;

  /// @param points  finite; copied, as are the items
  NearestItems(const std::vector<Point3>& points, const std::vector<Cell>& items);
  NearestPoint<corners> find(const Point3& point) const;

 private:
  std::array<Point3, corners> corners_of(std::int32_t item) const;
  std::array<std::int64_t, 3> cell_of(const Point3& point) const;
  /// Visits the items of all cells at Chebyshev distance `shell` from `centre`.
  template <class Visit>
  void visit_shell(const std::array<std::int64_t, 3>& centre,
                   std::int64_t shell,
                   Visit visit) const;

  std::vector<Point3> points_;
  std::vector<Cell> items_;
  std::vector<Bounds> boxes_;  ///< of the items
  Bounds bounds_;
  double edge_ = 1;  ///< of the cubes of the grid
  std::array<std::int64_t, 3> dims_{1, 1, 1};
  std::vector<std::int64_t> first_;    ///< [cells + 1]
  std::vector<std::int32_t> entries_;  ///< items by cell, ascending
};

extern template class NearestItems<3>;
extern template class NearestItems<4>;

}  // namespace tetwarp
