/// @file mesh_gmsh.cpp
/// Meshes and node data in Gmsh's MSH 2 and 4.1, read by Gmsh.
#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <tetwarp/error.hpp>
#include <unordered_map>

#include "io/h5/value_names.hpp"
#include "io/import/gmsh_library.hpp"
#include "io/import/mesh_import.hpp"

namespace tetwarp {
namespace {
constexpr int gmsh_triangle = 2;     ///< of three nodes
constexpr int gmsh_tetrahedron = 4;  ///< of four nodes
constexpr int gmsh_hexahedron = 5;   ///< of eight, in VTK's order

/// From Gmsh's tags of nodes to their indices in the mesh.
using Places = std::unordered_map<std::size_t, std::size_t>;

/// Gmsh would run a file that does not begin like a mesh as a script.
void check_format(const std::string& path) {
  std::string line;
  std::getline(std::ifstream(path) >> std::ws, line);
  if (line.starts_with("$MeshFormat")) return;
  throw IoError(path, "", "does not begin with $MeshFormat, as Gmsh's MSH 2 and 4 do");
}

std::size_t place_of(const std::string& path, const Places& places, std::size_t tag) {
  const auto found = places.find(tag);
  if (found != places.end()) return found->second;
  throw IoError(path, "", "has no node " + std::to_string(tag) + ": damaged, write it again");
}

/// Throws IoError unless the library has returned what it documents.
void check(const std::string& path, bool is_sound, const std::string& problem) {
  if (!is_sound) throw IoError(path, "", problem + ": damaged, write it again");
}

Places add_nodes(const std::string& path, const GmshLibrary& gmsh, ImportedMesh& into) {
  GmshArray<std::size_t> tags(gmsh);
  GmshArray<double> positions(gmsh), parameters(gmsh);
  gmsh.call<decltype(gmshModelMeshGetNodes)>("gmshModelMeshGetNodes", &tags.data, &tags.size,
                                             &positions.data, &positions.size, &parameters.data,
                                             &parameters.size, -1, -1, 0, 0);
  check(path, positions.size == 3 * tags.size, "does not have three coordinates for every node");
  std::vector<std::size_t> order(tags.size);  // Gmsh returns nodes by entity
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t n) { return tags[n]; });
  Places places;
  std::vector<std::int64_t> numbers;
  for (const std::size_t n : order) {
    const bool is_new = places.emplace(tags[n], into.mesh.rest_positions.size()).second;
    check(path, is_new, "has two nodes " + std::to_string(tags[n]));
    numbers.push_back(static_cast<std::int64_t>(tags[n]));
    into.mesh.rest_positions.push_back(
        {positions[3 * n], positions[3 * n + 1], positions[3 * n + 2]});
  }
  add_numbers("original_node", false, numbers, into);
  return places;
}

CellKind kind_of_type(const GmshLibrary& gmsh, int type) {
  GmshArray<char> name(gmsh);
  GmshArray<double> positions(gmsh);
  int dimension = 0, order = 0, nodes = 0, primary_nodes = 0;
  gmsh.call<decltype(gmshModelMeshGetElementProperties)>(
      "gmshModelMeshGetElementProperties", type, &name.data, &dimension, &order, &nodes,
      &positions.data, &positions.size, &primary_nodes);
  const bool is_kept = type == gmsh_triangle || type == gmsh_tetrahedron || type == gmsh_hexahedron;
  return {name.data == nullptr ? "cell of type " + std::to_string(type) : name.data, dimension,
          is_kept ? nodes : 0};
}

CellNumbers add_cells(const std::string& path,
                      const GmshLibrary& gmsh,
                      const Places& places,
                      ImportedMesh& into) {
  CellNumbers numbers;
  GmshArray<int> types(gmsh);
  GmshArrays<std::size_t> tags(gmsh), nodes(gmsh);
  gmsh.call<decltype(gmshModelMeshGetElements)>("gmshModelMeshGetElements", &types.data,
                                                &types.size, &tags.data, &tags.sizes, &tags.size,
                                                &nodes.data, &nodes.sizes, &nodes.size, -1, -1);
  check(path, tags.size == types.size && nodes.size == types.size, "lacks cells");
  for (std::size_t type = 0; type < types.size; ++type) {
    const CellKind kind = kind_of_type(gmsh, types[type]);
    check(path, nodes.sizes[type] >= tags.sizes[type] * static_cast<std::size_t>(kind.kept_nodes),
          "lacks nodes of its cells");
    for (std::size_t c = 0; c < tags.sizes[type]; ++c) {
      const std::size_t* const tags_of_cell =
          nodes.data[type] + c * static_cast<std::size_t>(kind.kept_nodes);
      add_cell(
          path, kind, static_cast<std::int64_t>(tags.data[type][c]),
          [&](std::size_t n) { return place_of(path, places, tags_of_cell[n]); }, into, numbers);
    }
  }
  return numbers;
}

/// Adds to each cell of an entity the physical group of that entity, unless it has one.
void add_group(const GmshLibrary& gmsh,
               int entity,
               int group,
               std::unordered_map<std::size_t, std::int64_t>& groups) {
  GmshArray<int> types(gmsh);
  GmshArrays<std::size_t> tags(gmsh), nodes(gmsh);
  gmsh.call<decltype(gmshModelMeshGetElements)>("gmshModelMeshGetElements", &types.data,
                                                &types.size, &tags.data, &tags.sizes, &tags.size,
                                                &nodes.data, &nodes.sizes, &nodes.size, 3, entity);
  for (std::size_t type = 0; type < tags.size; ++type) {
    for (std::size_t c = 0; c < tags.sizes[type]; ++c) groups.emplace(tags.data[type][c], group);
  }
}

/// Adds names of values to the last array, unless a file cannot hold them.
void add_names(std::map<std::int64_t, std::string> names, ImportedMesh& into) {
  if (text_of_names(names).size() <= max_value_names) {
    into.arrays.back().value_names = std::move(names);
  } else {
    into.left_out.push_back("names of " + std::to_string(names.size()) + " groups");
  }
}

/// Adds the array `group`, with the groups' names, where the file has physical groups of volumes.
void add_groups(const GmshLibrary& gmsh, const CellNumbers& numbers, ImportedMesh& into) {
  GmshArray<int> physical(gmsh);  // pairs of dimension and tag
  gmsh.call<decltype(gmshModelGetPhysicalGroups)>("gmshModelGetPhysicalGroups", &physical.data,
                                                  &physical.size, 3);
  std::unordered_map<std::size_t, std::int64_t> groups;
  std::map<std::int64_t, std::string> names;
  for (std::size_t at = 0; at + 1 < physical.size; at += 2) {
    const int group = physical[at + 1];
    GmshArray<int> entities(gmsh);
    gmsh.call<decltype(gmshModelGetEntitiesForPhysicalGroup)>(
        "gmshModelGetEntitiesForPhysicalGroup", 3, group, &entities.data, &entities.size);
    for (std::size_t e = 0; e < entities.size; ++e) add_group(gmsh, entities[e], group, groups);
    GmshArray<char> name(gmsh);
    gmsh.call<decltype(gmshModelGetPhysicalName)>("gmshModelGetPhysicalName", 3, group, &name.data);
    if (name.data != nullptr && *name.data != '\0') {
      names[group] = name.data;
    }
  }
  std::vector<std::int64_t> rows;
  for (const std::int64_t number : numbers.all()) {
    const auto found = groups.find(static_cast<std::size_t>(number));
    rows.push_back(found == groups.end() ? 0 : found->second);
  }
  if (groups.empty()) return;
  add_numbers("group", true, rows, into);
  add_names(std::move(names), into);
}

/// Adds one step of node data, which every node must have.
void add_step(const std::string& path,
              const GmshLibrary& gmsh,
              int view,
              int step,
              const std::string& name,
              const Places& places,
              ImportedMesh& into) {
  GmshArray<char> kind(gmsh);
  GmshArray<std::size_t> tags(gmsh);
  GmshArrays<double> data(gmsh);
  double time = 0;
  int components = 0;
  gmsh.call<decltype(gmshViewGetModelData)>("gmshViewGetModelData", view, step, &kind.data,
                                            &tags.data, &tags.size, &data.data, &data.sizes,
                                            &data.size, &time, &components);
  if (kind.data == nullptr || std::strcmp(kind.data, "NodeData") != 0 || components != 3 ||
      tags.size != places.size() || data.size != tags.size) {
    throw IoError(path, name,
                  "step " + std::to_string(step) + ": expected three components for every node");
  }
  std::vector<Point3> displacement(places.size());
  for (std::size_t n = 0; n < tags.size; ++n) {
    check(path, data.sizes[n] >= 3, "lacks numbers of '" + name + "'");
    const double* const row = data.data[n];
    displacement[place_of(path, places, tags[n])] = {row[0], row[1], row[2]};
  }
  into.displacements.push_back(std::move(displacement));
  into.times.push_back(time);
}

void add_displacement(const std::string& path,
                      const GmshLibrary& gmsh,
                      const Places& places,
                      const MeshImportOptions& options,
                      ImportedMesh& into) {
  GmshArray<int> views(gmsh);
  gmsh.call<decltype(gmshViewGetTags)>("gmshViewGetTags", &views.data, &views.size);
  const auto option = [](std::size_t view, const char* of) {
    return "View[" + std::to_string(view) + "]." + of;
  };
  std::vector<std::string> names;
  for (std::size_t view = 0; view < views.size; ++view) {
    GmshArray<char> name(gmsh);
    gmsh.call<decltype(gmshOptionGetString)>("gmshOptionGetString", option(view, "Name").c_str(),
                                             &name.data);
    names.emplace_back(name.data == nullptr ? "" : name.data);
  }
  const auto chosen = choose_displacement(path, names, options);
  bool is_found = false;
  for (std::size_t view = 0; view < views.size; ++view) {
    if (is_found || names[view] != chosen) {
      into.left_out.push_back("data '" + names[view] + "'");
      continue;
    }
    is_found = true;
    double steps = 0;
    gmsh.call<decltype(gmshOptionGetNumber)>("gmshOptionGetNumber",
                                             option(view, "NbTimeStep").c_str(), &steps);
    for (int step = 0; step < static_cast<int>(steps); ++step) {
      add_step(path, gmsh, views[view], step, *chosen, places, into);
    }
  }
}
}  // namespace

ImportedMesh read_gmsh_mesh(const std::string& path, const MeshImportOptions& options) {
  check_format(path);
  const GmshLibrary gmsh(path);
  gmsh.call<decltype(gmshOpen)>("gmshOpen", path.c_str());
  ImportedMesh mesh;
  const Places places = add_nodes(path, gmsh, mesh);
  const CellNumbers numbers = add_cells(path, gmsh, places, mesh);
  add_numbers("original_cell", true, numbers.all(), mesh);
  add_groups(gmsh, numbers, mesh);
  add_displacement(path, gmsh, places, options, mesh);
  return mesh;
}

}  // namespace tetwarp
