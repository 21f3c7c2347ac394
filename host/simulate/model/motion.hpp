/// @file motion.hpp
/// Where paths, hinges and waves are at a time.
#pragma once
#include <optional>
#include <vector>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// A displacement [m] and a turn about the origin of what moves [rad].
struct PathPlace {
  Point3 displacement{0, 0, 0};
  Point3 axis_angle{0, 0, 0};
};

/// Whether `time` is `moment` or later, up to the rounding of the products that times come from.
bool has_come(double time, double moment);

/// The place on a path: linear between its points, constant before the first and after the last.
/// Nothing from a point without displacement up to the next point. An empty path does not move.
std::optional<PathPlace> place_at(const Path& path, double time);

/// A frame that stood at `start`, after a move of its origin and a turn about it.
Pose moved(const Pose& start, const PathPlace& place);

/// The frame of a scripted body at a time. A wave does not move it.
Pose frame_at(const Motion& motion, const Pose& start, double time);

/// Positions in the frame of the geometry of points that a wave moves; without a wave, the points.
/// The phase is rounded to 2^-40 of a turn, so that every period returns the same bits.
class WaveMotion {
 public:
  /// @param rest  points in the frame of the geometry
  WaveMotion(const Motion& motion, const std::vector<Point3>& rest);
  std::vector<Point3> points_at(double time) const;

 private:
  std::vector<Point3> rest_;
  std::optional<Wave> wave_;
  double low_ = 0, extent_ = 0;  ///< along the axis
};

}  // namespace tetwarp
