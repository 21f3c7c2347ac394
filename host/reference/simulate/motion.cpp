/// @file motion.cpp
/// Interpolates paths and hinges, and evaluates waves.
#include "host/reference/simulate/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tetwarp::reference {
namespace {

double hinge_angle(const Hinge& hinge, double time) {
  if (hinge.angle.empty()) return 0;
  for (std::size_t i = 0; i < hinge.angle.size(); ++i) {
    const auto [end, angle] = hinge.angle[i];
    if (time >= end) continue;
    if (i == 0) return angle;
    const auto [begin, before] = hinge.angle[i - 1];
    return before + (angle - before) * (time - begin) / (end - begin);
  }
  return hinge.angle.back()[1];
}

PathPlace place_of(const PathPoint& point) {
  return {vector_of(*point.displacement), vector_of(point.axis_angle)};
}

}  // namespace

bool is_reached(double moment, double time) {
  return time - moment >= -1e-12 * std::max(std::abs(moment), 1.0);
}

std::optional<PathPlace> path_at(const Path& path, double time) {
  if (path.empty()) return PathPlace{};
  std::size_t next = 0;
  while (next < path.size() && is_reached(path[next].time, time)) ++next;
  const PathPoint& before = path[next == 0 ? 0 : next - 1];
  if (!before.displacement) return std::nullopt;
  const PathPlace a = place_of(before);
  if (next == 0 || next == path.size() || !path[next].displacement) return a;
  const PathPlace b = place_of(path[next]);
  const double u = (time - before.time) / (path[next].time - before.time);
  return PathPlace{a.displacement + u * (b.displacement - a.displacement),
                   a.axis_angle + u * (b.axis_angle - a.axis_angle)};
}

Placement moved(const Placement& start, const PathPlace& place) {
  return {start.position + place.displacement, turn_of(place.axis_angle) * start.rotation};
}

Placement frame_at(const Motion& motion, const Placement& start, double time) {
  if (const auto* path = std::get_if<Path>(&motion)) {
    return moved(start, path_at(*path, time).value_or(PathPlace{}));
  }
  if (const auto* hinge = std::get_if<Hinge>(&motion)) {
    const Vector3d point = vector_of(hinge->point);
    const Matrix3d turn = turn_of(hinge_angle(*hinge, time) * vector_of(hinge->axis).normalized());
    return {point + turn * (start.position - point), turn * start.rotation};
  }
  return start;
}

Vector3d wave_at(const Motion& motion, double length, double s, double time) {
  Vector3d displacement = Vector3d::Zero();
  if (const auto* wave = std::get_if<Wave>(&motion)) {
    const double turns = wave->frequency * time;
    const double phase = s / wave->wavelength - (turns - std::floor(turns)) + wave->phase;
    const auto& a = wave->envelope;
    displacement(wave->lateral) =
        length * (a[0] + a[1] * s + a[2] * s * s) * std::sin(2 * std::numbers::pi * phase);
  }
  return displacement;
}

}  // namespace tetwarp::reference
