/// @file mesh_readers.cpp
/// Choice of the library by the name of the file, and of the cells and the array that are kept.
#include "io/reader/mesh_readers.hpp"

#include <algorithm>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"

namespace tetwarp {

ImportedMesh read_foreign_mesh(const std::string& path, const MeshImportOptions& options) {
  if (has_extension(path, ".msh")) return read_gmsh_mesh(path, options);
  return options.needs_solids ? read_vtk_mesh(path, options) : read_vtk_surface(path, options);
}

void leave_out_cell(const std::string& path,
                    const CellKind& kind,
                    std::int64_t number,
                    ImportedMesh& into) {
  if (kind.dimension == 3) {
    throw IoError(path, "",
                  "cell " + std::to_string(number) + " is a " + kind.name +
                      ", expected tetrahedra of four or ten nodes, hexahedra of eight, wedges of "
                      "six and pyramids of five; split the cells");
  }
  ++into.skipped[kind.name];
}

std::size_t node_count(CellShape shape) {
  switch (shape) {
    case CellShape::triangle:
      return 3;
    case CellShape::tetrahedron:
      return 4;
    case CellShape::curved_tetrahedron:
      return 10;
    case CellShape::hexahedron:
    case CellShape::voxel:
      return 8;
    case CellShape::wedge:
      return 6;
    case CellShape::pyramid:
      return 5;
    default:
      return 0;
  }
}

namespace {
/// The nodes of a hexahedron, in VTK's order, that make it another cell.
constexpr std::size_t hexahedron_nodes[8] = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::size_t voxel_nodes[8] = {0, 1, 3, 2, 4, 5, 7, 6};
constexpr std::size_t wedge_nodes[8] = {0, 1, 2, 2, 3, 4, 5, 5};
constexpr std::size_t pyramid_nodes[8] = {0, 1, 2, 3, 4, 4, 4, 4};
}  // namespace

void add_kept_cell(CellShape shape,
                   const std::int32_t* nodes,
                   std::int64_t number,
                   ImportedMesh& into,
                   CellNumbers& numbers) {
  const auto add_hex = [&](const std::size_t(&order)[8]) {
    std::array<std::int32_t, 8>& hex = into.mesh.hexes.emplace_back();
    for (std::size_t n = 0; n < 8; ++n) hex[n] = nodes[order[n]];
    numbers.hexes.push_back(number);
  };
  const auto add_tet = [&](const MidNodes& mid_nodes) {
    const bool has_ten = mid_nodes != no_mid_nodes;
    if (has_ten) into.mid_nodes.resize(into.mesh.tets.size(), no_mid_nodes);
    if (has_ten || !into.mid_nodes.empty()) into.mid_nodes.push_back(mid_nodes);
    into.mesh.tets.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
    numbers.tets.push_back(number);
  };
  switch (shape) {
    case CellShape::other:
      return;
    case CellShape::triangle:
      into.triangles.push_back({nodes[0], nodes[1], nodes[2]});
      return;
    case CellShape::tetrahedron:
      return add_tet(no_mid_nodes);
    case CellShape::curved_tetrahedron:
      return add_tet({nodes[4], nodes[5], nodes[6], nodes[7], nodes[8], nodes[9]});
    case CellShape::hexahedron:
      return add_hex(hexahedron_nodes);
    case CellShape::voxel:
      return add_hex(voxel_nodes);
    case CellShape::wedge:
      return add_hex(wedge_nodes);
    case CellShape::pyramid:
      return add_hex(pyramid_nodes);
  }
}

std::optional<std::string> choose_displacement(const std::string& path,
                                               const std::vector<std::string>& names,
                                               const MeshImportOptions& options) {
  const std::string name = options.displacement.value_or("displacement");
  if (std::ranges::find(names, name) != names.end()) return name;
  if (!options.displacement) return std::nullopt;
  std::string listed;
  for (const std::string& name : names) listed += (listed.empty() ? "" : ", ") + name;
  throw IoError(path, name,
                "no such point array; the file has " + (listed.empty() ? "none" : listed));
}

}  // namespace tetwarp
