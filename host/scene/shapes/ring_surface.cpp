/// @file ring_surface.cpp
/// Rings of cylinders, capsules, tori and arcs, and the triangles between them.
#include "host/scene/shapes/ring_surface.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "host/scene/shapes/rings.hpp"
#include "host/scene/shapes/surface_pattern.hpp"

namespace tetwarp {
namespace {
using std::numbers::pi;

/// The rings of `around` points whose count of triangles is nearest to the wanted one where faces
/// are divided.
Surface nearest_rings(std::int64_t triangles,
                      Faces faces,
                      const std::function<Rings(int around, Faces faces)>& rings_of) {
  const int around = nearest_pattern(
      3, triangles, [&](int n) { return triangle_count(rings_of(n, Faces::divided)); });
  return ring_surface(rings_of(around, faces));
}

/// A circle around the z axis.
std::function<Point3(double)> circle(double radius, double z) {
  return [=](double angle) {
    return Point3{radius * std::cos(angle), radius * std::sin(angle), z};
  };
}

Rings cylinder_rings(const CylinderShape& shape, int around, Faces faces) {
  const double spacing = 2 * pi * shape.radius / around;
  const int along = count_along(shape.length, spacing, faces);
  const int out = count_along(shape.radius, spacing, faces);
  Rings rings{around, {}, false, {0, 0, -shape.length / 2}, {0, 0, shape.length / 2}};
  for (int r = 1; r < out; ++r) {
    rings.ring.push_back(circle(shape.radius * r / out, -shape.length / 2));
  }
  for (int r = 0; r <= along; ++r) {
    rings.ring.push_back(circle(shape.radius, shape.length * (double{1} * r / along - 0.5)));
  }
  for (int r = out - 1; r > 0; --r) {
    rings.ring.push_back(circle(shape.radius * r / out, shape.length / 2));
  }
  return rings;
}

Rings capsule_rings(const CapsuleShape& shape, int around, Faces faces) {
  const double spacing = 2 * pi * shape.radius / around, end = shape.length / 2;
  // Without a straight part the caps share a ring.
  const int along = shape.length > 0 ? count_along(shape.length, spacing, faces) : 0;
  const int out = std::max(2, count_along(pi / 2 * shape.radius, spacing));
  Rings rings{around, {}, false, {0, 0, -end - shape.radius}, {0, 0, end + shape.radius}};
  const auto cap_ring = [&](int r, double side) {
    const double angle = pi / 2 * r / out;
    rings.ring.push_back(
        circle(shape.radius * std::sin(angle), side * (end + shape.radius * std::cos(angle))));
  };
  for (int r = 1; r < out; ++r) cap_ring(r, -1);
  for (int r = 0; r <= along; ++r) {
    const double place = along > 0 ? double{1} * r / along - 0.5 : 0;
    rings.ring.push_back(circle(shape.radius, shape.length * place));
  }
  for (int r = out - 1; r > 0; --r) cap_ring(r, 1);
  return rings;
}

/// A circle of a radius around the circle of a torus at angle `turn`, moved along it by `ahead`.
std::function<Point3(double)> tube_circle(double torus_radius,
                                          double turn,
                                          double radius,
                                          double ahead) {
  return [=](double angle) {
    const double out = torus_radius + radius * std::cos(angle);
    return Point3{out * std::cos(turn) - ahead * std::sin(turn),
                  out * std::sin(turn) + ahead * std::cos(turn), -radius * std::sin(angle)};
  };
}

Rings torus_rings(const TorusShape& shape, int around) {
  const int along = std::max(3, count_along(2 * pi * shape.radius, 2 * pi * shape.tube / around));
  Rings rings{around, {}, true, {}, {}};
  for (int r = 0; r < along; ++r) {
    rings.ring.push_back(tube_circle(shape.radius, 2 * pi * r / along, shape.tube, 0));
  }
  return rings;
}

Rings arc_rings(const ArcShape& shape, int around) {
  const double spacing = 2 * pi * shape.tube / around;
  const double angle = shape.angles[1] - shape.angles[0];
  const int along = std::max(static_cast<int>(std::ceil(angle / (pi / 6))),
                             count_along(shape.radius * angle, spacing));
  const int out = std::max(2, count_along(pi / 2 * shape.tube, spacing));
  const auto pole = [&](double turn, double ahead) {
    return tube_circle(shape.radius, turn, 0, ahead)(0);
  };
  Rings rings{
      around, {}, false, pole(shape.angles[0], -shape.tube), pole(shape.angles[1], shape.tube)};
  const auto cap_ring = [&](int r, double turn, double side) {
    const double polar = pi / 2 * r / out;
    rings.ring.push_back(tube_circle(shape.radius, turn, shape.tube * std::sin(polar),
                                     side * shape.tube * std::cos(polar)));
  };
  for (int r = 1; r < out; ++r) cap_ring(r, shape.angles[0], -1);
  for (int r = 0; r <= along; ++r) {
    rings.ring.push_back(
        tube_circle(shape.radius, shape.angles[0] + angle * r / along, shape.tube, 0));
  }
  for (int r = out - 1; r > 0; --r) cap_ring(r, shape.angles[1], 1);
  return rings;
}
}  // namespace

Surface make_ring_surface(const CylinderShape& shape, std::int64_t triangles, Faces faces) {
  return nearest_rings(triangles, faces,
                       [&](int around, Faces of) { return cylinder_rings(shape, around, of); });
}

Surface make_ring_surface(const CapsuleShape& shape, std::int64_t triangles, Faces faces) {
  return nearest_rings(triangles, faces,
                       [&](int around, Faces of) { return capsule_rings(shape, around, of); });
}

Surface make_ring_surface(const TorusShape& shape, std::int64_t triangles) {
  return nearest_rings(triangles, Faces::divided,
                       [&](int around, Faces) { return torus_rings(shape, around); });
}

Surface make_ring_surface(const ArcShape& shape, std::int64_t triangles) {
  return nearest_rings(triangles, Faces::divided,
                       [&](int around, Faces) { return arc_rings(shape, around); });
}

}  // namespace tetwarp
