/// @file scene_look.cpp
/// Colors of bodies, what a picture shows, and the camera.
#include "host/view/look/scene_look.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/view/look/obstacle_surface.hpp"

namespace tetwarp::view {
namespace {
/// Colors of bodies, distinguishable with the common forms of color blindness: those of Okabe and
/// Ito without black, ordered so that successive colors differ most.
constexpr std::array<Rgb, 7> body_colors{{{0.90, 0.45, 0.20},
                                          {0.16, 0.50, 0.76},
                                          {0.25, 0.66, 0.45},
                                          {0.93, 0.76, 0.25},
                                          {0.76, 0.46, 0.65},
                                          {0.42, 0.72, 0.90},
                                          {0.75, 0.30, 0.24}}};
struct Box {
  Point3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

  void include(const Point3& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], point[axis]);
      high[axis] = std::max(high[axis], point[axis]);
    }
  }
  double size() const { return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]); }
};

/// Whether a body is likely to fall far: cloth, and bodies without fixed or driven parts.
bool may_fall(const Body& body) {
  if (body.kind == BodyKind::scripted) return false;
  return body.kind == BodyKind::cloth || (body.fixed.empty() && body.driven.empty());
}

/// The corners of a box.
std::array<Point3, 8> corners_of(const Box& box) {
  std::array<Point3, 8> corners{};
  for (std::size_t c = 0; c < 8; ++c) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corners[c][axis] = (c >> axis & 1) != 0 ? box.high[axis] : box.low[axis];
    }
  }
  return corners;
}

/// Adds the corners of a box after a free fall of a time, at most as far as the box is large.
void add_fall(const Box& box, const Point3& gravity, double seconds, std::vector<Point3>& points) {
  const double size = std::hypot(gravity[0], gravity[1], gravity[2]);
  if (!(size > 0)) return;
  const double way = std::min(0.5 * size * seconds * seconds, box.size()) / size;
  for (Point3 corner : corners_of(box)) {
    for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] += way * gravity[axis];
    points.push_back(corner);
  }
}

/// Adds the projections of a box's corners onto planes nearer than the size of the box.
void add_feet(const Box& box, const std::vector<DrawnPlane>& planes, std::vector<Point3>& points) {
  for (const DrawnPlane& plane : planes) {
    const Point3& n = plane.normal;
    const double squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    for (Point3 corner : corners_of(box)) {
      double height = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        height += n[axis] * (corner[axis] - plane.point[axis]) / squared;
      }
      for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] -= height * n[axis];
      if (std::abs(height) * std::sqrt(squared) < box.size()) points.push_back(corner);
    }
  }
}
}  // namespace

Rgb color_of(std::size_t body) {
  Rgb color = body_colors[body % body_colors.size()];
  const std::size_t round = body / body_colors.size() % 3;
  if (round == 0) return color;
  for (double& part : color) part = round == 1 ? 0.5 + 0.5 * part : 0.65 * part;
  return color;
}

SceneDrawing drawing_of(const Simulator& simulator, const LookSurfaces& looks) {
  SceneDrawing drawing;
  const Scene& scene = simulator.scene();
  for (const Obstacle& obstacle : scene.obstacles) {
    if (auto plane = plane_of(obstacle, simulator.time())) drawing.planes.push_back(*plane);
    if (auto surface = surface_of(obstacle, simulator.time())) {
      drawing.obstacles.push_back(std::move(*surface));
    }
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    drawing.points.push_back(looks.positions(b));
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    drawing.surfaces.push_back({drawing.points[b], looks.drawn(b).triangles, color_of(b)});
  }
  for (const Surface& surface : drawing.obstacles) {
    drawing.surfaces.push_back({surface.points, surface.triangles, obstacle_color});
  }
  return drawing;
}

namespace {
/// Shows the whole scene, and where it will be if it falls.
Camera camera_of_all(const Simulator& simulator, const LookSurfaces& looks, double aspect) {
  const SceneDrawing drawn = drawing_of(simulator, looks);
  std::vector<Point3> points;
  Box box;
  for (const DrawnSurface& surface : drawn.surfaces) {
    points.insert(points.end(), surface.points.begin(), surface.points.end());
  }
  for (const Point3& point : points) box.include(point);
  if (!points.empty()) {
    const Scene& scene = simulator.scene();
    const bool falls = std::ranges::any_of(scene.bodies, may_fall) && drawn.planes.empty();
    if (falls) add_fall(box, scene.gravity, scene.duration, points);
    add_feet(box, drawn.planes, points);
  }
  return camera_of(points, aspect);
}

Camera camera_named(const Scene& scene, const std::string& name) {
  const auto found = std::ranges::find(scene.cameras, name, &SceneCamera::name);
  if (found != scene.cameras.end()) return found->camera;
  std::string names;
  for (const SceneCamera& own : scene.cameras) names += (names.empty() ? "" : ", ") + own.name;
  throw std::invalid_argument("--camera: the scene has no camera '" + name + "'; give " +
                              (names.empty() ? "" : "one of " + names + ", or ") +
                              "six numbers: X,Y,Z,TX,TY,TZ");
}
}  // namespace

Camera chosen_camera(const Simulator& simulator,
                     const LookSurfaces& looks,
                     const std::optional<std::array<double, 6>>& numbers,
                     const std::string& name,
                     double aspect) {
  if (numbers) return camera_at(*numbers);
  if (!name.empty()) return camera_named(simulator.scene(), name);
  if (simulator.scene().camera) return *simulator.scene().camera;
  return camera_of_all(simulator, looks, aspect);
}

Camera camera_at(const std::array<double, 6>& numbers) {
  const auto& c = numbers;
  Camera camera;
  camera.eye = {c[0], c[1], c[2]};
  camera.target = {c[3], c[4], c[5]};
  const bool is_from_above = std::hypot(c[0] - c[3], c[1] - c[4]) < 1e-6 * std::abs(c[2] - c[5]);
  if (is_from_above) camera.up = {0, 1, 0};
  return camera;
}

}  // namespace tetwarp::view
