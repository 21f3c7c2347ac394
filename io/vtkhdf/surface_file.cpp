/// @file surface_file.cpp
/// Surfaces as files of triangles.
#include <tetwarp/io.hpp>
#include <tetwarp/scene_io.hpp>
#include <utility>

#include "host/base/repeated_cells.hpp"
#include "io/vtkhdf/vtkhdf_mesh_file.hpp"

namespace tetwarp {
namespace {
/// The triangles with those points that they have, in the order of the points.
Surface compacted(std::vector<Point3> points, std::vector<std::array<std::int32_t, 3>> triangles) {
  std::vector<std::int32_t> number(points.size(), -1);
  for (const auto& triangle : triangles) {
    for (const std::int32_t corner : triangle) number[static_cast<std::size_t>(corner)] = 0;
  }
  Surface surface;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<std::int32_t>(surface.points.size());
    surface.points.push_back(points[p]);
  }
  for (auto& triangle : triangles) {
    for (std::int32_t& corner : triangle) corner = number[static_cast<std::size_t>(corner)];
  }
  surface.triangles = std::move(triangles);
  return surface;
}
}  // namespace

Surface read_surface(const std::string& path,
                     std::vector<std::string>* left_out,
                     std::string* merged) {
  const h5::Silence silence;
  const auto note = [&](std::vector<std::string> names,
                        const std::map<std::string, std::int64_t>& skipped) {
    if (left_out == nullptr) return;
    *left_out = std::move(names);
    for (const auto& [kind, count] : skipped) {
      left_out->push_back(std::to_string(count) + " " + kind);
    }
  };
  std::vector<Point3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
  if ((has_mesh_extension(path) || has_surface_extension(path)) &&
      kind_of(path) == FileKind::unknown) {
    ImportedMesh imported = import_mesh(path, {.needs_solids = false});
    for (const MeshArray& array : imported.arrays) {
      imported.left_out.push_back((array.is_of_cells ? "cell array '" : "point array '") +
                                  array.name + "'");
    }
    note(std::move(imported.left_out), imported.skipped);
    points = std::move(imported.mesh.rest_positions);
    triangles = std::move(imported.triangles);
  } else {
    const MeshFile file(path);
    MeshCells cells = file.read_cells(0, CellChoice::triangles);
    note(file.not_read(), cells.skipped);
    points = file.read_points(0);
    triangles = std::move(cells.triangles);
  }
  const auto firsts = first_copies(points, triangles, SameCells::turned_places);
  if (merged != nullptr) *merged = merged_text(copy_count(firsts), triangles.size(), "triangles");
  keep_firsts(firsts, triangles);
  return compacted(std::move(points), std::move(triangles));
}

}  // namespace tetwarp
