/// @file mesh_gmsh.cpp
/// Meshes and node data in Gmsh's MSH 2 and 4.1, read by Gmsh.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <string_view>
#include <tetwarp/error.hpp>
#include <unordered_map>

#include "io/reader/gmsh_library.hpp"
#include "io/reader/mesh_readers.hpp"

namespace tetwarp {
namespace {
/// The kept cells of Gmsh's types. Nodes are in VTK's order but the last two of ten.
CellShape shape_of_type(int type) {
  switch (type) {
    case 2:
      return CellShape::triangle;
    case 4:
      return CellShape::tetrahedron;
    case 5:
      return CellShape::hexahedron;
    case 6:
      return CellShape::wedge;
    case 7:
      return CellShape::pyramid;
    case 11:
      return CellShape::curved_tetrahedron;
    default:
      return CellShape::other;
  }
}

/// Sections of which ImportedMesh keeps nothing.
constexpr std::string_view unread_sections[] = {
    "$Comments", "$GhostElements", "$InterpolationScheme", "$Parametrizations", "$Periodic"};

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
  return {name.data == nullptr ? "cell of type " + std::to_string(type) : name.data, dimension,
          shape_of_type(type)};
}

CellNumbers add_cells(const std::string& path,
                      const GmshLibrary& gmsh,
                      const Places& places,
                      const MeshImportOptions& options,
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
    const std::size_t kept_nodes = node_count(kind.shape);
    const bool is_curved = kind.shape == CellShape::curved_tetrahedron;
    check(path, nodes.sizes[type] >= tags.sizes[type] * kept_nodes, "lacks nodes of its cells");
    if (!options.needs_solids && kind.dimension == 2 && kept_nodes == 0) {
      throw IoError(path, "",
                    "holds cells of kind " + kind.name +
                        ", expected triangles of three nodes; triangulate the surface");
    }
    for (std::size_t c = 0; c < tags.sizes[type]; ++c) {
      const std::size_t* const tags_of_cell = nodes.data[type] + c * kept_nodes;
      add_cell(
          path, kind, static_cast<std::int64_t>(tags.data[type][c]),
          [&](std::size_t n) {
            return place_of(path, places, tags_of_cell[is_curved && n > 7 ? 17 - n : n]);
          },
          into, numbers);
    }
  }
  return numbers;
}

/// The physical groups of cells by their tags, in the order of the groups.
using CellGroups = std::unordered_map<std::size_t, std::vector<std::int64_t>>;

/// Adds to each cell of an entity a physical group of that entity.
void add_group(const GmshLibrary& gmsh, int entity, int group, CellGroups& groups) {
  GmshArray<int> types(gmsh);
  GmshArrays<std::size_t> tags(gmsh), nodes(gmsh);
  gmsh.call<decltype(gmshModelMeshGetElements)>("gmshModelMeshGetElements", &types.data,
                                                &types.size, &tags.data, &tags.sizes, &tags.size,
                                                &nodes.data, &nodes.sizes, &nodes.size, 3, entity);
  for (std::size_t type = 0; type < tags.size; ++type) {
    for (std::size_t c = 0; c < tags.sizes[type]; ++c) {
      groups[tags.data[type][c]].push_back(group);
    }
  }
}

std::string name_of_group(const GmshLibrary& gmsh, int dimension, int group) {
  GmshArray<char> name(gmsh);
  gmsh.call<decltype(gmshModelGetPhysicalName)>("gmshModelGetPhysicalName", dimension, group,
                                                &name.data);
  return name.data == nullptr ? "" : name.data;
}

/// Adds the array `group`, with the groups' names, where the file has physical groups of volumes;
/// where cells are in several groups also `group_2` with their second ones, and so on.
void add_groups(const GmshLibrary& gmsh, const CellNumbers& numbers, ImportedMesh& into) {
  GmshArray<int> physical(gmsh);  // pairs of dimension and tag
  gmsh.call<decltype(gmshModelGetPhysicalGroups)>("gmshModelGetPhysicalGroups", &physical.data,
                                                  &physical.size, 3);
  CellGroups groups;
  std::map<std::int64_t, std::string> names;
  for (std::size_t at = 0; at + 1 < physical.size; at += 2) {
    const int group = physical[at + 1];
    GmshArray<int> entities(gmsh);
    gmsh.call<decltype(gmshModelGetEntitiesForPhysicalGroup)>(
        "gmshModelGetEntitiesForPhysicalGroup", 3, group, &entities.data, &entities.size);
    for (std::size_t e = 0; e < entities.size; ++e) add_group(gmsh, entities[e], group, groups);
    if (const std::string name = name_of_group(gmsh, 3, group); !name.empty()) names[group] = name;
  }
  std::size_t most = 0;
  for (const auto& [cell, own] : groups) most = std::max(most, own.size());
  for (std::size_t place = 0; place < most; ++place) {
    std::vector<std::int64_t> rows;
    for (const std::int64_t number : numbers.all()) {
      const auto found = groups.find(static_cast<std::size_t>(number));
      rows.push_back(found != groups.end() && place < found->second.size() ? found->second[place]
                                                                           : 0);
    }
    add_numbers(place == 0 ? "group" : "group_" + std::to_string(place + 1), true, rows, into);
    into.arrays.back().value_names = names;
  }
}

/// Counts nodes that Gmsh does not keep: of MSH 2 those of no cell.
/// @param counts  the line after "$Nodes": the number of nodes, of MSH 4 after that of their groups
void add_lost_nodes(const std::string& counts, ImportedMesh& into) {
  long long first = 0, second = 0, low = 0, high = 0;
  const int found =
      std::sscanf(counts.c_str(), "%lld %lld %lld %lld", &first, &second, &low, &high);
  const long long nodes = found == 4 ? second : found == 1 ? first : 0;
  const long long lost = nodes - std::ssize(into.mesh.rest_positions);
  if (lost > 0 && lost < nodes) into.left_out.push_back(std::to_string(lost) + " nodes of no cell");
}

/// Names what the file holds and ImportedMesh does not: groups of surfaces, curves and points,
/// partitions, and other sections.
void add_left_out(const std::string& path, const GmshLibrary& gmsh, ImportedMesh& into) {
  GmshArray<int> physical(gmsh);
  gmsh.call<decltype(gmshModelGetPhysicalGroups)>("gmshModelGetPhysicalGroups", &physical.data,
                                                  &physical.size, -1);
  for (std::size_t at = 0; at + 1 < physical.size; at += 2) {
    const int dimension = physical[at], group = physical[at + 1];
    if (dimension == 3) continue;
    const std::string name = name_of_group(gmsh, dimension, group);
    into.left_out.push_back("group " + (name.empty() ? std::to_string(group) : "'" + name + "'") +
                            " of dimension " + std::to_string(dimension));
  }
  GmshArray<int> entities(gmsh);
  gmsh.call<decltype(gmshModelGetEntities)>("gmshModelGetEntities", &entities.data, &entities.size,
                                            3);
  std::set<int> partitions;
  for (std::size_t at = 0; at + 1 < entities.size; at += 2) {
    GmshArray<int> own(gmsh);
    gmsh.call<decltype(gmshModelGetPartitions)>("gmshModelGetPartitions", entities[at],
                                                entities[at + 1], &own.data, &own.size);
    for (std::size_t p = 0; p < own.size; ++p) partitions.insert(own[p]);
  }
  if (!partitions.empty()) {
    into.left_out.push_back("numbers of " + std::to_string(partitions.size()) + " partitions");
  }
  std::ifstream file(path, std::ios::binary);
  std::set<std::string> found;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with('$')) continue;
    if (line.starts_with("$Nodes") && std::getline(file, line)) add_lost_nodes(line, into);
    line.resize(std::min(line.find_last_not_of(" \t\r") + 1, line.size()));
    if (std::ranges::find(unread_sections, line) != std::end(unread_sections)) found.insert(line);
  }
  for (const std::string& section : found) into.left_out.push_back("section " + section);
}

/// Adds one step of node data, which every node of a cell must have; the others get 0 without it.
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
      data.size != tags.size) {
    throw IoError(path, name,
                  "step " + std::to_string(step) + ": expected three components for every node");
  }
  std::vector<Point3> displacement(places.size());
  std::vector<bool> lacks_data = nodes_of_cells(into.mesh, into.triangles, into.mid_nodes);
  for (std::size_t n = 0; n < tags.size; ++n) {
    check(path, data.sizes[n] >= 3, "lacks numbers of '" + name + "'");
    const double* const row = data.data[n];
    const std::size_t place = place_of(path, places, tags[n]);
    displacement[place] = {row[0], row[1], row[2]};
    lacks_data[place] = false;
  }
  if (const auto lacking = std::ranges::find(lacks_data, true); lacking != lacks_data.end()) {
    const auto place = static_cast<std::size_t>(lacking - lacks_data.begin());
    const auto node = std::ranges::find(places, place, &Places::value_type::second);
    throw IoError(path, name,
                  "step " + std::to_string(step) + " has no data of node " +
                      std::to_string(node->first) +
                      ", which cells have; give all nodes of cells data");
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
  const CellNumbers numbers = add_cells(path, gmsh, places, options, mesh);
  add_numbers("original_cell", true, numbers.all(), mesh);
  add_groups(gmsh, numbers, mesh);
  add_displacement(path, gmsh, places, options, mesh);
  add_left_out(path, gmsh, mesh);
  return mesh;
}

}  // namespace tetwarp
