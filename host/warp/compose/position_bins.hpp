/// @file position_bins.hpp
/// Finds the positions in a box.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/base/point3.hpp"

namespace tetwarp {

/// Positions sorted into equal bins along the axes.
class PositionBins {
 public:
  /// @param points  kept by the caller
  /// @param size    of a bin, at least [world]
  PositionBins(const std::vector<Point3>& points, double size);

  const Bounds& bounds() const { return bounds_; }

  /// Calls visit(p) for each point in a box, in an order that depends on the points alone.
  template <class Visit>
  void for_each_in(const Bounds& box, const Visit& visit) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(box.high[axis] >= bounds_.low[axis] && box.low[axis] <= bounds_.high[axis])) return;
    }
    const Bin first = bin_of(box.low), last = bin_of(box.high);
    for (std::int64_t k = first[2]; k <= last[2]; ++k) {
      for (std::int64_t j = first[1]; j <= last[1]; ++j) {
        for (std::int64_t i = first[0]; i <= last[0]; ++i) {
          for (const std::size_t p : bins_[place({i, j, k})]) {
            if (holds(box, points_[p])) visit(p);
          }
        }
      }
    }
  }

 private:
  using Bin = std::array<std::int64_t, 3>;

  static bool holds(const Bounds& box, const Point3& x);
  Bin bin_of(const Point3& x) const;
  std::size_t place(const Bin& bin) const {
    return static_cast<std::size_t>(bin[0] + count_[0] * (bin[1] + count_[1] * bin[2]));
  }

  const std::vector<Point3>& points_;
  Bounds bounds_;
  Bin count_{};
  Point3 edge_{};  ///< of a bin [world]
  std::vector<std::vector<std::size_t>> bins_;
};

}  // namespace tetwarp
