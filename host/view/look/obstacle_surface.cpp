/// @file obstacle_surface.cpp
/// Surfaces of obstacles, moved along their paths.
#include "host/view/look/obstacle_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace tetwarp::view {
namespace {
using std::numbers::pi;

/// Turns a point about the origin by a rotation vector.
Point3 turned(const Point3& point, const Point3& turn) {
  const double angle = std::hypot(turn[0], turn[1], turn[2]);
  if (!(angle > 0)) return point;
  const Point3 k{turn[0] / angle, turn[1] / angle, turn[2] / angle};
  const double along = k[0] * point[0] + k[1] * point[1] + k[2] * point[2];
  const Point3 cross{k[1] * point[2] - k[2] * point[1], k[2] * point[0] - k[0] * point[2],
                     k[0] * point[1] - k[1] * point[0]};
  Point3 result{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result[axis] = point[axis] * std::cos(angle) + cross[axis] * std::sin(angle) +
                   k[axis] * along * (1 - std::cos(angle));
  }
  return result;
}

/// Moves a point with an obstacle, which turns about `origin`.
Point3 moved(const Point3& point, const Point3& origin, const PathPoint& at) {
  const Point3 arm{point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]};
  Point3 result = turned(arm, at.axis_angle);
  const Point3 shift = at.displacement.value_or(Point3{0, 0, 0});
  for (std::size_t axis = 0; axis < 3; ++axis) result[axis] += origin[axis] + shift[axis];
  return result;
}

/// A capsule from one point to another, whose ends are half spheres; a sphere where these are
/// equal.
Surface capsule_surface(const Point3& from, const Point3& to, double radius) {
  constexpr std::int32_t columns = 48, rows = 24;  // rows of both half spheres
  Point3 axis{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
  const double length = std::hypot(axis[0], axis[1], axis[2]);
  if (length > 0) {
    for (double& part : axis) part /= length;
  } else {
    axis = {0, 0, 1};
  }
  // A rotation vector that takes z to the axis.
  const double sine = std::hypot(axis[0], axis[1]);
  const double angle = std::atan2(sine, axis[2]);
  const Point3 turn =
      sine > 0 ? Point3{-axis[1] / sine * angle, axis[0] / sine * angle, 0} : Point3{angle, 0, 0};
  Surface surface;
  for (std::int32_t row = 0; row <= rows + 1; ++row) {
    const bool is_upper = row > rows / 2;  // the equator stands twice: at `from` and at `to`
    const double latitude = pi * (row - (is_upper ? 1 : 0)) / rows - pi / 2;
    for (std::int32_t column = 0; column < columns; ++column) {
      const double longitude = 2 * pi * column / columns;
      Point3 point =
          turned({radius * std::cos(latitude) * std::cos(longitude),
                  radius * std::cos(latitude) * std::sin(longitude), radius * std::sin(latitude)},
                 turn);
      const Point3& end = is_upper ? to : from;
      for (std::size_t a = 0; a < 3; ++a) point[a] += end[a];
      surface.points.push_back(point);
    }
  }
  for (std::int32_t row = 0; row <= rows; ++row) {
    for (std::int32_t column = 0; column < columns; ++column) {
      const std::int32_t a = row * columns + column, b = row * columns + (column + 1) % columns;
      surface.triangles.push_back({a, b, b + columns});
      surface.triangles.push_back({a, b + columns, a + columns});
    }
  }
  return surface;
}
}  // namespace

PathPoint path_at(const Path& path, double time) {
  if (path.empty()) return {};
  const auto next = std::ranges::find_if(path, [&](const PathPoint& p) { return p.time > time; });
  if (next == path.begin()) return path.front();
  if (next == path.end()) return path.back();
  const PathPoint& before = *(next - 1);
  const double share = (time - before.time) / (next->time - before.time);
  const Point3 a = before.displacement.value_or(Point3{0, 0, 0});
  const Point3 b = next->displacement.value_or(a);
  PathPoint at{time, Point3{0, 0, 0}, {0, 0, 0}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    (*at.displacement)[axis] = std::lerp(a[axis], b[axis], share);
    at.axis_angle[axis] = std::lerp(before.axis_angle[axis], next->axis_angle[axis], share);
  }
  return at;
}

std::optional<Surface> surface_of(const Obstacle& obstacle, double time) {
  Surface surface;
  Point3 origin{0, 0, 0};
  if (const auto* sphere = std::get_if<SphereObstacle>(&obstacle.geometry)) {
    surface = capsule_surface(sphere->center, sphere->center, sphere->radius);
    origin = sphere->center;
  } else if (const auto* capsule = std::get_if<CapsuleObstacle>(&obstacle.geometry)) {
    surface = capsule_surface(capsule->from, capsule->to, capsule->radius);
  } else if (const auto* mesh = std::get_if<Surface>(&obstacle.geometry)) {
    surface = *mesh;
  } else {
    return std::nullopt;
  }
  const PathPoint at = path_at(obstacle.path, time);
  for (Point3& point : surface.points) point = moved(point, origin, at);
  return surface;
}

std::optional<DrawnPlane> plane_of(const Obstacle& obstacle, double time) {
  const auto* plane = std::get_if<PlaneObstacle>(&obstacle.geometry);
  if (plane == nullptr) return std::nullopt;
  const PathPoint at = path_at(obstacle.path, time);
  return DrawnPlane{moved(plane->point, {0, 0, 0}, at), turned(plane->normal, at.axis_angle)};
}

}  // namespace tetwarp::view
