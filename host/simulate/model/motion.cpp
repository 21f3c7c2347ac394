/// @file motion.cpp
/// Interpolates paths and hinges, and evaluates waves.
#include "host/simulate/model/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/simulate/model/rotations.hpp"

namespace tetwarp {
namespace {

Point3 between(const Point3& a, const Point3& b, double u) {
  return plus(a, times(u, minus(b, a)));
}

double angle_at(const Hinge& hinge, double time) {
  const auto& table = hinge.angle;
  if (table.empty()) return 0;
  if (time <= table.front()[0]) return table.front()[1];
  if (time >= table.back()[0]) return table.back()[1];
  std::size_t next = 1;
  while (table[next][0] <= time) ++next;
  const auto [begin, from] = table[next - 1];
  const auto [end, to] = table[next];
  return from + (to - from) * ((time - begin) / (end - begin));
}

}  // namespace

bool has_come(double time, double moment) {
  return time >= moment - 1e-12 * std::max(1.0, std::fabs(moment));
}

std::optional<PathPlace> place_at(const Path& path, double time) {
  if (path.empty()) return PathPlace{};
  std::size_t next = 0;
  while (next < path.size() && has_come(time, path[next].time)) ++next;
  const PathPoint& before = path[next == 0 ? 0 : next - 1];
  if (!before.displacement) return std::nullopt;
  const PathPlace here{*before.displacement, before.axis_angle};
  if (next == 0 || next == path.size() || !path[next].displacement) return here;
  const PathPoint& after = path[next];
  const double u = (time - before.time) / (after.time - before.time);
  return PathPlace{between(here.displacement, *after.displacement, u),
                   between(here.axis_angle, after.axis_angle, u)};
}

Pose moved(const Pose& start, const PathPlace& place) {
  return {plus(start.position, place.displacement),
          product(quaternion_of(place.axis_angle), start.rotation)};
}

Pose frame_at(const Motion& motion, const Pose& start, double time) {
  if (const auto* path = std::get_if<Path>(&motion)) {
    return moved(start, place_at(*path, time).value_or(PathPlace{}));
  }
  if (const auto* hinge = std::get_if<Hinge>(&motion)) {
    const Point3 axis = times(angle_at(*hinge, time) / norm(hinge->axis), hinge->axis);
    const Quaternion turn = quaternion_of(axis);
    return {plus(hinge->point, rotate(turn, minus(start.position, hinge->point))),
            product(turn, start.rotation)};
  }
  return start;
}

WaveMotion::WaveMotion(const Motion& motion, const std::vector<Point3>& rest) : rest_(rest) {
  if (const auto* wave = std::get_if<Wave>(&motion)) wave_ = *wave;
  if (!wave_ || rest.empty()) return;
  const auto axis = static_cast<std::size_t>(wave_->axis);
  const Bounds bounds = bounds_of(rest);
  low_ = bounds.low[axis];
  extent_ = bounds.high[axis] - bounds.low[axis];
}

std::vector<Point3> WaveMotion::points_at(double time) const {
  std::vector<Point3> points = rest_;
  if (!wave_) return points;
  const Wave& wave = *wave_;
  const double turns = std::nearbyint(wave.frequency * time * 0x1p40) * 0x1p-40;
  const double fraction = turns - std::floor(turns);
  for (Point3& point : points) {
    const double along = point[static_cast<std::size_t>(wave.axis)] - low_;
    const double s = extent_ > 0 ? along / extent_ : 0;
    const auto [a0, a1, a2] = wave.envelope;
    const double phase = s / wave.wavelength - fraction + wave.phase;
    point[static_cast<std::size_t>(wave.lateral)] +=
        extent_ * (a0 + s * (a1 + s * a2)) * std::sin(2 * std::numbers::pi * phase);
  }
  return points;
}

}  // namespace tetwarp
