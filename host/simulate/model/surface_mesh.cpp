/// @file surface_mesh.cpp
/// The public calls on surfaces.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tetwarp/surface.hpp>
#include <utility>

#include "host/scene/checks/check_geometry.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/isosurface.hpp"
#include "host/scene/shapes/surface.hpp"
#include "host/scene/shapes/surface_lattice.hpp"
#include "host/simulate/model/nearest.hpp"

namespace tetwarp {

Surface make_isosurface(const Volume& volume, double value, std::optional<std::int64_t> triangles) {
  const std::string place = "make_isosurface: volume '" + volume.name + "'";
  check_grid(volume.grid, place);
  static_cast<void>(VolumeView(volume));  // throws unless the samples fit the grid
  if (volume.components != 1) {
    fail_at(place, "has " + std::to_string(volume.components) + " components, expected 1");
  }
  check_finite("make_isosurface: value", value);
  if (triangles && *triangles < 4) fail_at("make_isosurface: triangles", "expected 4 at least");
  const ImageGeometry image{volume, value};
  return triangles ? make_isosurface(place, image, *triangles) : make_isosurface(place, image);
}

namespace {
/// The tetrahedra of a mesh, of positive volume. @param call  for messages
TetMesh oriented_tets(const std::string& call, const Mesh& mesh) {
  check_mesh(mesh);
  if (!mesh.hexes.empty()) fail_at(call + ": mesh", "has hexahedra, expected tetrahedra");
  TetMesh tets{mesh.rest_positions, mesh.tets};
  orient_tets(call + ": mesh", tets);
  return tets;
}
}  // namespace

Surface boundary_surface(const Mesh& mesh) {
  const TetMesh tets = oriented_tets("boundary_surface", mesh);
  return surface_of(tets.nodes, boundary_triangles(tets.tets));
}

BoundPoints bind_boundary(const Mesh& mesh) {
  const TetMesh tets = oriented_tets("bind_boundary", mesh);
  std::vector<std::size_t> corner(mesh.rest_positions.size());  // 4 tetrahedron + corner, the first
  for (std::size_t t = mesh.tets.size(); t-- > 0;) {
    for (std::size_t a = 0; a < 4; ++a) {
      corner[static_cast<std::size_t>(mesh.tets[t][a])] = 4 * t + a;
    }
  }
  BoundPoints bound;
  for (const std::int32_t node : nodes_of(boundary_triangles(tets.tets))) {
    const std::size_t first = at(corner, node);
    bound.nodes.push_back(mesh.tets[first / 4]);
    bound.weights.emplace_back()[first % 4] = 1;
  }
  return bound;
}

BoundPoints bind_points(const Mesh& mesh, const std::vector<Point3>& points) {
  check_mesh(mesh);
  if (mesh.tets.empty()) fail_at("bind_points: mesh", "has no tetrahedra");
  for (const Point3& x : points) check_finite("bind_points: points", x);
  const NearestItems<4> nearest(mesh.rest_positions, mesh.tets);
  BoundPoints bound;
  bound.nodes.reserve(points.size());
  bound.weights.reserve(points.size());
  for (const Point3& x : points) {
    const NearestPoint<4> place = nearest.find(x);
    bound.nodes.push_back(at(mesh.tets, place.item));
    bound.weights.push_back(place.weight);
    bound.largest_distance = std::max(bound.largest_distance, place.distance);
  }
  return bound;
}

Mesh make_lattice_mesh(const Surface& surface, std::int64_t cells) {
  const std::string place = "make_lattice_mesh: surface";
  check_surface(place, surface);
  check_areas(place, surface);
  check_closed(place, surface);
  if (cells < 1) fail_at("make_lattice_mesh: cells", "expected 1 at least");
  TetMesh mesh = make_surface_lattice(place, surface, cells);
  return {std::move(mesh.nodes), std::move(mesh.tets)};
}

}  // namespace tetwarp
