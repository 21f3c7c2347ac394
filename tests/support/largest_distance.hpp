/// @file largest_distance.hpp
/// How far two lists of points are apart.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp::test {

/// Largest distance of corresponding points; infinite for lists of different sizes.
inline double largest_distance(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double largest = a.size() == b.size() ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    largest =
        std::max(largest, std::hypot(a[i][0] - b[i][0], a[i][1] - b[i][1], a[i][2] - b[i][2]));
  }
  return largest;
}

}  // namespace tetwarp::test
