/// @file check_geometry.cpp
/// Checks of shapes, images, meshes, sheets, lattices and surfaces.
#include "host/scene/checks/check_geometry.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <variant>

#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
constexpr std::int64_t most_items = std::numeric_limits<std::int32_t>::max();

/// Within which areas, volumes and moments of inertia are numbers.
void check_length(const std::string& place, double length, double least = 1e-50) {
  if (least > 0) check_positive(place, length, "m");
  check_not_negative(place, length, "m");
  check_range(place, length, least, 1e50);
}

void check_lengths(const std::string& place, const Point3& lengths) {
  for (const double length : lengths) check_length(place, length);
}

void check_tube(const std::string& place, double radius, double tube) {
  check_length(key_of(place, "radius"), radius);
  check_length(key_of(place, "tube"), tube);
  if (!(tube < radius)) {
    fail_at(key_of(place, "tube"),
            "is " + number_text(tube) + ", expected less than the radius " + number_text(radius));
  }
}

void check_shape(const std::string& place, const BoxShape& box) {
  check_lengths(key_of(place, "half"), box.half);
}
void check_shape(const std::string& place, const EllipsoidShape& ellipsoid) {
  check_lengths(key_of(place, "radii"), ellipsoid.radii);
}
void check_shape(const std::string& place, const CapsuleShape& capsule) {
  check_length(key_of(place, "radius"), capsule.radius);
  check_length(key_of(place, "length"), capsule.length, 0);
}
void check_shape(const std::string& place, const CylinderShape& cylinder) {
  check_length(key_of(place, "radius"), cylinder.radius);
  check_length(key_of(place, "length"), cylinder.length);
}
void check_shape(const std::string& place, const TorusShape& torus) {
  check_tube(place, torus.radius, torus.tube);
}
void check_shape(const std::string& place, const ArcShape& arc) {
  check_tube(place, arc.radius, arc.tube);
  const std::string angles = key_of(place, "angles");
  for (const double angle : arc.angles) check_finite(angles, angle);
  const double turn = arc.angles[1] - arc.angles[0];
  if (!(turn > 0)) fail_at(angles, "the second one is not above the first one, swap them");
  if (2 * std::numbers::pi - turn < 2 * std::asin(arc.tube / arc.radius)) {
    fail_at(angles, "the ends of the arc meet; use less of a turn or the type torus");
  }
}
void check_shape(const std::string& place, const BentStripShape& strip) {
  check_length(key_of(place, "width"), strip.width);
  check_length(key_of(place, "height"), strip.height);
  check_length(key_of(place, "depth"), strip.depth);
  check_range(key_of(place, "sag"), strip.sag, -1e50, 1e50);
}
void check_shape(const std::string& place, const PlateShape& plate) {
  check_lengths(key_of(place, "size"), plate.size);
}

void check_one(const std::string&, const std::monostate&) {}

void check_one(const std::string& place, const Shape& shape) {
  std::visit([&](const auto& one) { check_shape(key_of(place, "shape"), one); }, shape);
}

void check_one(const std::string& body_place, const ImageGeometry& image) {
  const std::string place = key_of(body_place, "volume");
  check_grid(image.volume.grid, place + ": grid");
  if (image.volume.components != 1) {
    fail_at(place, "has " + std::to_string(image.volume.components) +
                       " components, expected one; choose an array of single numbers");
  }
  if (image.volume.data.size() != image.volume.byte_count()) {
    fail_at(place, "has " + std::to_string(image.volume.data.size()) + " bytes of samples, " +
                       std::to_string(image.volume.byte_count()) + " belong to its grid");
  }
  check_finite(key_of(place, "threshold"), image.threshold);
}

void check_one(const std::string& body_place, const Mesh& mesh) {
  const std::string place = key_of(body_place, "mesh");
  if (!mesh.hexes.empty()) fail_at(place, "has hexahedra, expected tetrahedra only; split them");
  try {
    check_mesh(mesh);
  } catch (const std::invalid_argument& error) {
    fail_at(place, error.what());
  }
}

void check_one(const std::string& place, const Surface& surface) {
  check_surface(key_of(place, "mesh"), surface);
}

void check_one(const std::string& body_place, const Sheet& sheet) {
  const std::string place = key_of(body_place, "sheet");
  for (const double size : sheet.size) check_length(key_of(place, "size"), size);
  double points = 1;
  for (const std::int64_t count : sheet.cells) {
    if (count < 1) fail_at(key_of(place, "cells"), "expected numbers from 1");
    points *= static_cast<double>(count) + 1;
  }
  if (points > static_cast<double>(most_items)) {
    fail_at(key_of(place, "cells"), "2^31 or more points; use fewer cells");
  }
  check_finite(key_of(place, "origin"), sheet.origin);
  const std::string axes = key_of(place, "axes");
  double dot = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) dot += sheet.axes[0][axis] * sheet.axes[1][axis];
  for (const Point3& axis : sheet.axes) {
    check_direction(axes, axis);
    if (std::abs(std::hypot(axis[0], axis[1], axis[2]) - 1) > 1e-6) {
      fail_at(axes, "are not of length 1, divide them by their lengths");
    }
  }
  if (std::abs(dot) > 1e-6) fail_at(axes, "are not at right angles, correct one of them");
}
}  // namespace

void check_lattice(const std::string& place, const Lattice& lattice) {
  if (lattice.cells.has_value() + lattice.edge.has_value() + lattice.tets.has_value() != 1) {
    fail_at(place, "expected exactly one of cells, edge and tets");
  }
  if (lattice.edge) check_positive(key_of(place, "edge"), *lattice.edge, "m");
  if (lattice.tets) {
    check_range(key_of(place, "tets"), static_cast<double>(*lattice.tets), 1,
                static_cast<double>(most_items));
  }
  if (!lattice.cells) return;
  double tets = 5;
  for (const std::int64_t count : *lattice.cells) {
    if (count < 1) fail_at(key_of(place, "cells"), "expected numbers from 1");
    tets *= static_cast<double>(count);
  }
  if (tets > static_cast<double>(most_items)) {
    fail_at(key_of(place, "cells"), "2^31 or more tetrahedra; use fewer cells");
  }
}

void check_surface(const std::string& place, const Surface& surface) {
  if (surface.triangles.empty()) fail_at(place, "holds no triangle");
  if (surface.points.size() > static_cast<std::size_t>(most_items) ||
      surface.triangles.size() > static_cast<std::size_t>(most_items)) {
    fail_at(place, "2^31 or more points or triangles; use a coarser surface");
  }
  for (const Point3& point : surface.points) check_finite(place, point);
  const auto count = static_cast<std::int32_t>(surface.points.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    for (const std::int32_t corner : {a, b, c}) {
      if (corner < 0 || corner >= count) {
        fail_at(place, "triangle " + std::to_string(t) + " refers to point " +
                           std::to_string(corner) + ", expected 0 to " + std::to_string(count - 1));
      }
    }
    if (a == b || b == c || c == a) {
      fail_at(place, "triangle " + std::to_string(t) + " has a point twice, remove it");
    }
  }
}

void check_geometry(const std::string& place, const Body& body) {
  std::visit([&](const auto& geometry) { check_one(place, geometry); }, body.geometry);
  if (body.lattice) {
    if (!std::holds_alternative<Shape>(body.geometry) &&
        !std::holds_alternative<ImageGeometry>(body.geometry) &&
        !std::holds_alternative<Surface>(body.geometry)) {
      fail_at(key_of(place, "lattice"),
              "is only for bodies of a shape, a volume or a closed surface, remove it");
    }
    check_lattice(key_of(place, "lattice"), *body.lattice);
  }
  const std::string surface = key_of(place, "surface");
  if (const auto* count = std::get_if<std::int64_t>(&body.surface)) {
    check_range(key_of(surface, "triangles"), static_cast<double>(*count), 4,
                static_cast<double>(most_items));
  } else if (const auto* mesh = std::get_if<Surface>(&body.surface)) {
    check_surface(key_of(surface, "mesh"), *mesh);
  }
}

}  // namespace tetwarp
