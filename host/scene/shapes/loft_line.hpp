/// @file loft_line.hpp
/// The center line of a loft and the cross-sections along it.
#pragma once
#include <array>
#include <tetwarp/loft.hpp>
#include <vector>

#include "host/base/point3.hpp"

namespace tetwarp {

/// A cross-section; `along`, across[0] and across[1] are unit vectors, right-handed in this order.
struct LoftSection {
  Point3 center{0, 0, 0}, along{0, 0, 0};
  std::array<Point3, 2> across{};
  std::array<double, 2> radii{0, 0};  ///< [m]
  double speed = 0;                   ///< length of center line per unit of the place
  Point3 bend{0, 0, 0};               ///< curvature vector of the center line [1/m]

  /// center + radii[0] x across[0] + radii[1] y across[1].
  Point3 point(double x, double y) const;
};

/// Cubic between stations: the tangent at a station is that of the parabola through it and the two
/// beside it, over the lengths of chords. Slopes of radii are harmonic means of those of the chords
/// (Fritsch and Butland 1984), 0 at the ends and where the sign changes.
class LoftLine {
 public:
  /// @throws std::invalid_argument  see loft_volume()
  explicit LoftLine(const LoftTube& tube);

  /// Places of the stations: sums of the lengths of chords, from 0 [m].
  const std::vector<double>& places() const { return place_; }
  /// From -ends[0] to the last place + ends[1]; before 0 and after the last place in the ends.
  LoftSection section(double place) const;
  /// The same, but within the ends as wide as where they begin.
  LoftSection wide_section(double place) const;
  double volume() const;

 private:
  LoftSection section_between(double place) const;
  void check_bends() const;

  LoftTube tube_;
  std::vector<double> place_;
  std::vector<Point3> tangent_, direction_;   // per station
  std::vector<std::array<double, 2>> slope_;  // of radii, per station
};

}  // namespace tetwarp
