/// @file position_bins.cpp
/// Bins of positions, about one for each at most.
#include "host/cli/warp/position_bins.hpp"

#include <algorithm>
#include <cmath>

namespace tetwarp::cli {

PositionBins::PositionBins(const std::vector<Point3>& points, double size)
    : points_(points), bounds_(bounds_of(points)) {
  const double most = std::ceil(std::cbrt(static_cast<double>(points.size())));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = bounds_.high[axis] - bounds_.low[axis];
    count_[axis] = static_cast<std::int64_t>(std::clamp(length / size, 1.0, most));
    edge_[axis] = std::max(length / static_cast<double>(count_[axis]), size * 1e-3);
  }
  bins_.resize(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]));
  for (std::size_t p = 0; p < points.size(); ++p) bins_[place(bin_of(points[p]))].push_back(p);
}

bool PositionBins::holds(const Bounds& box, const Point3& x) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(x[axis] >= box.low[axis] && x[axis] <= box.high[axis])) return false;
  }
  return true;
}

PositionBins::Bin PositionBins::bin_of(const Point3& x) const {
  Bin bin{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto last = static_cast<double>(count_[axis] - 1);
    bin[axis] = static_cast<std::int64_t>(
        std::clamp((x[axis] - bounds_.low[axis]) / edge_[axis], 0.0, last));
  }
  return bin;
}

}  // namespace tetwarp::cli
