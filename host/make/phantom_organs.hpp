/// @file phantom_organs.hpp
/// A list of organs in the order of drawing; curved tubes and branching vessels are made of rods.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "host/make/phantom_shapes.hpp"

namespace tetwarp {

struct Tree {
  Ellipsoid region;   ///< branches end at its surface
  double level;       ///< gray level
  double shortening;  ///< mean ratio of the length of a branch to that of its parent
  int generations;    ///< largest number of successive branches
};

/// Collects organs; later ones are drawn over earlier ones.
class Organs {
 public:
  void add(const Ellipsoid& ellipsoid, double level) { organs_.push_back({ellipsoid, level}); }

  void ellipsoid(double level, const Point3& center, const Point3& radii, double lean = 0);

  void rod(
      double level, const Point3& from, const Point3& to, double from_radius, double to_radius);

  /// A tube along a smooth curve through the points (Catmull-Rom), tapering evenly.
  /// @pre two points or more
  void tube(double level,
            const std::vector<Point3>& points,
            double first_radius,
            double last_radius);

  /// A vessel that branches in two repeatedly, within its region.
  /// @param branch  number of the first branch, 1 or more, which seeds its random numbers. The
  ///                children of a branch are 2 branch and 2 branch + 1.
  void tree(const Tree& tree,
            const Point3& from,
            const Point3& direction,
            double length,
            double radius,
            std::uint64_t branch);

  std::vector<Organ> take() { return std::move(organs_); }

 private:
  void grow(const Tree& tree,
            int generation,
            const Point3& from,
            const Point3& direction,
            double length,
            double radius,
            std::uint64_t branch);

  std::vector<Organ> organs_;
};

}  // namespace tetwarp
