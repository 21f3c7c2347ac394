/// @file mesh_import.cpp
/// Has a mesh of another program read, checks it, merges its cells and turns its axes.
#include <tetwarp/mesh_import.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <tetwarp/volume.hpp>

#include "host/base/point3.hpp"
#include "io/files/extension.hpp"
#include "io/files/numbered_files.hpp"
#include "io/files/text_file.hpp"
#include "io/h5/value_names.hpp"
#include "io/import/merge_cells.hpp"
#include "io/import/mesh_child.hpp"
#include "io/import/split_cells.hpp"
#include "io/nifti/nifti_components.hpp"
#include "io/volume/mesh_arrays.hpp"

namespace tetwarp {
namespace {
/// Between RAS and LPS.
void turn(std::vector<Point3>& vectors) {
  for (Point3& vector : vectors) vector = {0 - vector[0], 0 - vector[1], vector[2]};
}

/// Turns vectors and tensors of floats.
void turn(MeshArray& array) {
  if (is_integer(array.type)) return;
  const std::array<bool, 9> turned = turned_components(array.components);
  const std::size_t size = size_of(array.type);
  const auto components = static_cast<std::size_t>(array.components);
  for (std::size_t s = 0; s < array.data.size() / size; ++s) {
    if (turned[s % components]) {
      negate_samples(array.type, std::span(array.data).subspan(s * size, size));
    }
  }
}

/// Leaves out names of groups that a VTKHDF file cannot hold.
void drop_long_names(ImportedMesh& mesh) {
  for (MeshArray& array : mesh.arrays) {
    if (text_of_names(array.value_names).size() <= max_value_names) continue;
    mesh.left_out.push_back("names of " + std::to_string(array.value_names.size()) + " groups");
    array.value_names.clear();
  }
}

/// Checks what a reader has returned. Displacements that are not finite become 0 at nodes of no
/// cell. Throws IoError.
void check_imported(const std::string& path, ImportedMesh& imported, bool needs_solids) {
  const std::size_t node_count = imported.mesh.rest_positions.size();
  if (needs_solids && imported.mesh.cell_count() == 0) {
    throw IoError(path, "", "holds no tetrahedron or hexahedron: damaged, or a surface mesh");
  }
  if (!needs_solids && imported.triangles.empty()) {
    throw IoError(path, "", "holds no triangle; extract the surface of its mesh");
  }
  if (node_count > std::numeric_limits<std::int32_t>::max()) {
    throw IoError(path, "", "2^31 or more nodes; use a coarser mesh");
  }
  for (const auto& triangle : imported.triangles) {
    for (const std::int32_t node : triangle) {
      if (node < 0 || static_cast<std::size_t>(node) >= node_count) {
        throw IoError(path, "", "a triangle refers to a node that is not there: damaged");
      }
    }
  }
  try {
    if (imported.mesh.cell_count() > 0) check_mesh(imported.mesh);
    check_mid_nodes(imported.mesh, imported.mid_nodes);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "", std::string(error.what()) + ": damaged, write it again");
  }
  for (std::size_t node = 0; node < node_count; ++node) {  // those of triangles alone, too
    if (!is_finite(imported.mesh.rest_positions[node])) {
      throw IoError(path, "",
                    "node " + std::to_string(node) + " is not finite, correct or remove it");
    }
  }
  for (const MeshArray& array : imported.arrays) {
    const std::size_t rows = array.is_of_cells ? imported.mesh.cell_count() : node_count;
    const bool has_type = array.type >= PixelType::uint8 && array.type <= PixelType::float64;
    if (array.components < 1 || !has_type ||
        array.data.size() !=
            rows * static_cast<std::size_t>(array.components) * size_of(array.type)) {
      throw IoError(path, array.name,
                    "does not have a number for every row: damaged, write it again");
    }
  }
  if (imported.displacements.size() != imported.times.size()) {
    throw IoError(path, "", "has other numbers of times and of steps: damaged, write it again");
  }
  const std::vector<bool> used =
      nodes_of_cells(imported.mesh, imported.triangles, imported.mid_nodes);
  for (std::size_t step = 0; step < imported.times.size(); ++step) {
    std::vector<Point3>& rows = imported.displacements[step];
    if (rows.size() == node_count) clear_unused(used, rows);
    const auto bad = std::ranges::find_if_not(rows, is_finite);
    if (rows.size() == node_count && bad == rows.end() && std::isfinite(imported.times[step])) {
      continue;
    }
    const std::string what = rows.size() != node_count ? "is not the displacement of every node"
                             : bad == rows.end()
                                 ? "has a time that is no finite number"
                                 : "has a displacement that is no finite number, of node " +
                                       std::to_string(bad - rows.begin());
    throw IoError(path, "", "step " + std::to_string(step) + " " + what + "; write it again");
  }
}
}  // namespace

bool has_mesh_extension(const std::string& path) {
  return has_extension(path, ".msh") || has_extension(path, ".vtu") ||
         has_extension(path, ".vtk") || has_extension(path, ".vtm") ||
         has_extension(path, ".pvd") || has_extension(path, ".series") || is_exodus_name(path);
}

bool has_surface_extension(const std::string& path) {
  return has_extension(path, ".stl") || has_extension(path, ".ply") ||
         has_extension(path, ".obj") || has_extension(path, ".vtp");
}

ImportedMesh import_mesh(const std::string& path, const MeshImportOptions& options) {
  if (!has_mesh_extension(path) && (options.needs_solids || !has_surface_extension(path))) {
    throw IoError(path, "",
                  std::string("the name of a ") + (options.needs_solids ? "mesh" : "surface") +
                      " to import must end in .msh, .vtu, .vtk, .vtm, .pvd, .series, .e or .exo" +
                      (options.needs_solids ? "" : ", .stl, .ply, .obj or .vtp"));
  }
  if (is_pattern(path)) {
    numbered_files(path);
  } else {
    check_readable(path);
  }
  ImportedMesh mesh = read_mesh_in_child(path, options, limits_for(path, options.time_limit));
  check_imported(path, mesh, options.needs_solids);
  merge_cells(mesh);
  if (!options.keeps_curved) split_curved_cells(mesh);
  drop_long_names(mesh);
  if (options.axes == Axes::lps) {
    turn(mesh.mesh.rest_positions);
    for (std::vector<Point3>& displacement : mesh.displacements) turn(displacement);
    for (MeshArray& array : mesh.arrays) turn(array);
  }
  return mesh;
}

}  // namespace tetwarp
