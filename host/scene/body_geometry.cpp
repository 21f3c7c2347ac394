/// @file body_geometry.cpp
/// Makes the lattice, mesh, sheet or surface that a body names.
#include "host/scene/body_geometry.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "host/base/repeated_cells.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/image_lattice.hpp"
#include "host/scene/isosurface.hpp"
#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/shape_lattice.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/scene/shapes/sheet.hpp"
#include "host/scene/shapes/surface.hpp"
#include "host/scene/shapes/surface_solid.hpp"

namespace tetwarp {
namespace {
/// Extents over the mean length of the edges of tetrahedra.
std::array<double, 3> edges_across(const TetMesh& mesh) {
  double sum = 0;
  for (const auto& tet : mesh.tets) {
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a + 1; b < 4; ++b) {
        sum += norm(minus(at(mesh.nodes, tet[a]), at(mesh.nodes, tet[b])));
      }
    }
  }
  const double edge = sum / (6.0 * static_cast<double>(mesh.tets.size()));
  const Bounds bounds = bounds_of(mesh.nodes);
  return times(1 / edge, minus(bounds.high, bounds.low));
}

void take_tets(BodyGeometry& geometry, TetMesh mesh, const Point3& cells_across) {
  geometry.nodes = std::move(mesh.nodes);
  geometry.tets = std::move(mesh.tets);
  geometry.cells_across = cells_across;
}

/// @param name  of several cells
template <std::size_t nodes_per_cell>
void check_repeats(const std::string& place,
                   const std::vector<Point3>& points,
                   const std::vector<std::array<std::int32_t, nodes_per_cell>>& cells,
                   SameCells same,
                   const std::string& name) {
  const std::vector<std::size_t> firsts = first_copies(points, cells, same);
  for (std::size_t c = 0; c < firsts.size(); ++c) {
    if (firsts[c] == c) continue;
    fail_at(place, name + " " + std::to_string(firsts[c]) + " and " + std::to_string(c) +
                       " are the same and would count twice, remove one of them");
  }
}

void take_mesh(const std::string& place, BodyParts& parts, const Mesh& mesh) {
  check_repeats(place, mesh.rest_positions, mesh.tets, SameCells::places, "tetrahedra");
  TetMesh tets{mesh.rest_positions, mesh.tets};
  orient_tets(place, tets);
  parts.node_number = keep_tets(tets, std::vector<std::uint8_t>(tets.tets.size(), 1));
  const Point3 across = edges_across(tets);
  take_tets(parts.geometry, std::move(tets), across);
}

/// The lattice of a shape, an image or a closed surface, the tetrahedra of a mesh.
void take_volume(const std::string& place, BodyParts& parts, const Body& body) {
  if (const auto* shape = std::get_if<Shape>(&body.geometry)) {
    ShapeLattice lattice = make_shape_lattice(key_of(place, "lattice"), *shape, *body.lattice);
    if (lattice.mesh.tets.empty()) {
      fail_at(key_of(place, "lattice"), "no tetrahedron is inside the shape; use smaller cells");
    }
    parts.geometry.tet_fraction = std::move(lattice.fraction);
    take_tets(parts.geometry, std::move(lattice.mesh), lattice.cells_across);
  } else if (const auto* image = std::get_if<ImageGeometry>(&body.geometry)) {
    ImageLattice lattice = make_image_lattice(place, *image, *body.lattice);
    take_tets(parts.geometry, std::move(lattice.mesh), lattice.cells_across);
    parts.geometry.shares_voxels = lattice.has_small_cells;
  } else if (const auto* surface = std::get_if<Surface>(&body.geometry)) {
    check_areas(key_of(place, "mesh"), *surface);
    check_closed(key_of(place, "mesh"), *surface);
    ShapeLattice lattice = make_solid_lattice(key_of(place, "lattice"), *surface, *body.lattice);
    parts.geometry.tet_fraction = std::move(lattice.fraction);
    take_tets(parts.geometry, std::move(lattice.mesh), lattice.cells_across);
  } else {
    take_mesh(key_of(place, "mesh"), parts, std::get<Mesh>(body.geometry));
  }
}

/// The surface that the scene gives, else that of the shape, image or triangles of the body.
Surface own_surface(const std::string& place, const Body& body, Faces faces = Faces::divided) {
  if (const auto* given = std::get_if<Surface>(&body.surface)) {
    check_areas(key_of(place, "surface.mesh"), *given);
    return *given;
  }
  const auto* count = std::get_if<std::int64_t>(&body.surface);
  if (const auto* shape = std::get_if<Shape>(&body.geometry)) {
    return count ? make_shape_surface(*shape, *count)
                 : make_shape_surface(*shape, default_triangles, faces);
  }
  if (const auto* image = std::get_if<ImageGeometry>(&body.geometry)) {
    const std::string volume = key_of(place, "volume");
    return count ? make_isosurface(volume, *image, *count) : make_isosurface(volume, *image);
  }
  if (count) {
    fail_at(key_of(place, "surface.triangles"),
            "is only for bodies of a shape or volume; give a mesh or nothing");
  }
  const Surface& surface = std::get<Surface>(body.geometry);
  check_areas(key_of(place, "mesh"), surface);
  return surface;
}

void make_fem(const std::string& place, BodyParts& parts, const Body& body) {
  take_volume(place, parts, body);
  BodyGeometry& geometry = parts.geometry;
  const bool is_default = std::holds_alternative<std::monostate>(body.surface);
  if (!is_default || std::holds_alternative<ImageGeometry>(body.geometry) ||
      std::holds_alternative<Surface>(body.geometry)) {
    geometry.surface = own_surface(place, body);
    return;
  }
  auto triangles = boundary_triangles(geometry.tets);
  geometry.surface_node = nodes_of(triangles);
  geometry.surface = surface_of(geometry.nodes, std::move(triangles));
}

/// Nodes and triangles of cloth, which are its surface as well.
void take_triangles(BodyParts& parts, const Surface& given) {
  std::vector<std::int32_t> number(given.points.size(), -1);
  for (const auto& triangle : given.triangles) {
    for (const std::int32_t point : triangle) number[static_cast<std::size_t>(point)] = 0;
  }
  std::int32_t next = 0;
  for (std::int32_t& entry : number) {
    if (entry == 0) entry = next++;
  }
  parts.node_number = std::move(number);
  parts.geometry.surface = surface_of(given.points, given.triangles);
  parts.geometry.nodes = parts.geometry.surface.points;
}

void take_cloth(const std::string& place, BodyParts& parts, const Body& body, Faces faces) {
  if (const auto* sheet = std::get_if<Sheet>(&body.geometry)) {
    take_triangles(parts, make_sheet(key_of(place, "sheet"), *sheet));
    parts.geometry.sheet_cells = sheet->cells;
  } else {
    take_triangles(parts, own_surface(place, body, faces));
  }
}
}  // namespace

BodyParts make_body_parts(const std::string& place, const Body& body, Faces faces) {
  BodyParts parts;
  parts.geometry.has_whole_faces = faces == Faces::whole && body.kind != BodyKind::fem &&
                                   !body.lattice && std::holds_alternative<Shape>(body.geometry) &&
                                   std::holds_alternative<std::monostate>(body.surface);
  switch (body.kind) {
    case BodyKind::fem:
      make_fem(place, parts, body);
      break;
    case BodyKind::rigid:
      parts.geometry.surface = own_surface(place, body, faces);
      check_closed(
          key_of(place, std::holds_alternative<Surface>(body.surface) ? "surface.mesh" : "mesh"),
          parts.geometry.surface);
      break;
    case BodyKind::cloth:
      take_cloth(place, parts, body, faces);
      check_repeats(key_of(place, "mesh"), parts.geometry.surface.points,
                    parts.geometry.surface.triangles, SameCells::nodes, "triangles");
      parts.geometry.cloth_triangles = parts.geometry.surface.triangles;
      break;
    case BodyKind::scripted:
      if (body.lattice || std::holds_alternative<Mesh>(body.geometry)) {
        make_fem(place, parts, body);
      } else if (!std::holds_alternative<std::monostate>(body.geometry)) {
        take_cloth(place, parts, body, faces);
      }
      break;
  }
  return parts;
}

}  // namespace tetwarp
