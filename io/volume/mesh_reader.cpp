/// @file mesh_reader.cpp
/// Rest and deformed positions of a mesh file of any format.
#include <algorithm>
#include <cmath>
#include <optional>
#include <tetwarp/io.hpp>
#include <utility>

#include "host/base/repeated_cells.hpp"
#include "io/volume/mesh_arrays.hpp"
#include "io/vtkhdf/vtkhdf_mesh_file.hpp"

namespace tetwarp {
struct MeshReader::State {
  /// Steps of a file of Gmsh or VTK, which is read as a whole.
  struct ImportedSteps {
    std::vector<Point3> points;
    std::vector<std::vector<Point3>> displacements;  ///< per step, or points where these move;
                                                     ///< empty: neither
  };

  std::string path;
  std::optional<MeshFile> file;  ///< VTKHDF; else `imported`
  ImportedSteps imported;
  MeshHeader header;
  Mesh mesh;
  std::vector<MidNodes> mid_nodes;  ///< those that the reader keeps
  bool keeps_curved;
  std::vector<MeshPart> parts;  ///< that `mesh` was read from
  std::vector<std::size_t> tet_firsts,
      hex_firsts;  ///< of the cells of the file; see first_copies()

  void open_vtkhdf(const MeshReadOptions& options);
  void take_cells(MeshCells cells, Mesh& into, std::vector<MidNodes>& mids) const;
  void import(const MeshReadOptions& options);
  std::vector<Point3> vectors_of(std::int64_t step) const;
};

namespace {
void add_skipped(const std::map<std::string, std::int64_t>& skipped,
                 std::vector<std::string>& not_read) {
  for (const auto& [kind, count] : skipped) not_read.push_back(std::to_string(count) + " " + kind);
}

void check_node_count(const std::string& path, std::size_t found, std::size_t expected) {
  if (found == expected) return;
  throw IoError(
      path, "",
      "has " + std::to_string(found) + " nodes, the mesh has " + std::to_string(expected));
}

/// Adds to each row that of the same node.
void add(const std::vector<Point3>& more, std::vector<Point3>& rows) {
  for (std::size_t node = 0; node < rows.size(); ++node) {
    for (std::size_t axis = 0; axis < 3; ++axis) rows[node][axis] += more[node][axis];
  }
}

/// Two steps have the same topology when their cells and connectivity are the same rows.
bool is_same_topology(const std::vector<MeshPart>& a, std::vector<MeshPart> b) {
  if (a.size() != b.size()) return false;
  for (std::size_t part = 0; part < a.size(); ++part) b[part].first_node = a[part].first_node;
  return a == b;
}

/// Whether steps of a file have points of their own.
bool moves_points(const MeshFile& file) {
  const std::vector<MeshPart> first = file.parts_of(0);
  for (std::size_t step = 1; step < file.file().times.size(); ++step) {
    if (file.parts_of(static_cast<std::int64_t>(step)) != first) return true;
  }
  return false;
}

/// Files of Gmsh and VTK are recognized by their names, unless they hold something else.
bool is_imported(const std::string& path) {
  return has_mesh_extension(path) && kind_of(path) == FileKind::unknown;
}

/// The step of a rest file, 0 where its points do not move.
std::int64_t rest_file_step(const std::string& path,
                            bool moves_points,
                            std::size_t count,
                            const std::optional<std::int64_t>& step) {
  if (!moves_points && step.value_or(0) != 0) {
    throw IoError(path, "", "its points do not move; leave out --rest-step");
  }
  if (moves_points && !step) {
    throw IoError(path, "",
                  "has points that move in " + std::to_string(count) +
                      " steps; choose those of the rest by --rest-step N");
  }
  const std::int64_t steps = std::max<std::int64_t>(1, static_cast<std::int64_t>(count));
  if (step && (*step < 0 || *step >= steps)) {
    throw IoError(path, "", "has no step " + std::to_string(*step) + " of points");
  }
  return step.value_or(0);
}

std::vector<Point3> read_rest_points(const std::string& path, const MeshReadOptions& options) {
  if (is_imported(path)) {
    ImportedMesh mesh = import_mesh(path, {.axes = options.import.axes});
    const std::int64_t step =
        rest_file_step(path, mesh.moves_points, mesh.times.size(), options.rest_step);
    if (mesh.moves_points) {
      add(mesh.displacements[static_cast<std::size_t>(step)], mesh.mesh.rest_positions);
    }
    return std::move(mesh.mesh.rest_positions);
  }
  const MeshFile file(path);
  const std::size_t count = file.file().times.size();
  return file.read_points(rest_file_step(path, moves_points(file), count, options.rest_step));
}

/// Whether rest positions of two files are the same but for rounding of float32.
bool are_same_places(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double size = 0, largest = 0;
  for (std::size_t node = 0; node < a.size(); ++node) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      size = std::max(size, std::abs(b[node][axis]));
      largest = std::max(largest, std::abs(a[node][axis] - b[node][axis]));
    }
  }
  return largest <= 1e-6 * size;
}
}  // namespace

void MeshReader::State::open_vtkhdf(const MeshReadOptions& options) {
  file.emplace(path);
  const VtkhdfInput& input = file->file();
  if (options.import.displacement) {
    throw IoError(path, "",
                  "is a VTKHDF mesh, whose displacement is the array 'displacement'; leave out "
                  "--displacement");
  }
  const std::int64_t rest = options.rest_file ? 0 : options.rest_step.value_or(0);
  input.check_step(rest);
  parts = file->parts_of(rest);
  MeshCells cells = file->read_cells(rest);
  mesh.rest_positions = file->read_points(rest);
  tet_firsts = first_tet_copies(mesh.rest_positions, cells.tets, cells.mid_nodes);
  hex_firsts = first_copies(mesh.rest_positions, cells.hexes, SameCells::places);
  header.merged = merged_text(copy_count(tet_firsts) + copy_count(hex_firsts),
                              cells.tets.size() + cells.hexes.size(), "cells");
  if (header.merged.empty()) tet_firsts = hex_firsts = {};
  header.not_read = file->not_read();
  add_skipped(cells.skipped, header.not_read);
  take_cells(std::move(cells), mesh, mid_nodes);
  header.times = input.is_temporal() ? input.times : std::vector<double>{0.0};
  header.has_displacement = file->has_displacement();
  header.group_names = file->group_names();
  header.has_moving_points = moves_points(*file);
}

/// Cells of a step without copies, those of ten nodes kept or divided.
void MeshReader::State::take_cells(MeshCells cells, Mesh& into, std::vector<MidNodes>& mids) const {
  if (cells.tets.size() == tet_firsts.size()) {
    keep_firsts(tet_firsts, cells.mid_nodes);
    keep_firsts(tet_firsts, cells.tets);
  }
  if (cells.hexes.size() == hex_firsts.size()) keep_firsts(hex_firsts, cells.hexes);
  into.tets = std::move(cells.tets);
  into.hexes = std::move(cells.hexes);
  if (keeps_curved || cells.mid_nodes.empty()) {
    mids = std::move(cells.mid_nodes);
  } else {
    into = split_curved({std::move(into), std::move(cells.mid_nodes)});
  }
}

void MeshReader::State::import(const MeshReadOptions& options) {
  ImportedMesh whole = import_mesh(path, options.import);
  const std::int64_t rest = options.rest_file ? 0 : options.rest_step.value_or(0);
  if (rest != 0 && (!whole.moves_points || rest < 0 || rest >= std::ssize(whole.times))) {
    throw IoError(path, "",
                  "has no step " + std::to_string(rest) + " of points" +
                      (whole.moves_points ? "" : ": its points do not move, --rest-step is 0"));
  }
  mesh = std::move(whole.mesh);
  mid_nodes = std::move(whole.mid_nodes);
  imported.displacements = std::move(whole.displacements);
  header.has_displacement = !imported.displacements.empty() && !whole.moves_points;
  header.has_moving_points = whole.moves_points;
  if (whole.moves_points) {
    for (std::vector<Point3>& points : imported.displacements) add(mesh.rest_positions, points);
    mesh.rest_positions = imported.displacements[static_cast<std::size_t>(rest)];
  }
  header.merged = whole.merged;
  for (MeshArray& array : whole.arrays) {
    if (array.is_of_cells && array.name == "group") {
      header.group_names = std::move(array.value_names);
    }
    if (array.name.starts_with("original_")) continue;  // numbers that import_mesh() has made
    header.not_read.push_back((array.is_of_cells ? "cell array '" : "point array '") + array.name +
                              "'");
  }
  header.not_read.insert(header.not_read.end(), whole.left_out.begin(), whole.left_out.end());
  add_skipped(whole.skipped, header.not_read);
  header.times = imported.displacements.empty() ? std::vector<double>{0.0} : std::move(whole.times);
  if (imported.displacements.empty()) imported.points = mesh.rest_positions;
}

/// The displacement of a step or, without one, its points.
std::vector<Point3> MeshReader::State::vectors_of(std::int64_t step) const {
  if (!file) {
    if (step < 0 || step >= std::ssize(header.times)) {
      throw IoError(path, "", "has no step " + std::to_string(step));
    }
    return imported.displacements.empty() ? imported.points
                                          : imported.displacements[static_cast<std::size_t>(step)];
  }
  file->file().check_step(step);
  if (!is_same_topology(parts, file->parts_of(step))) {
    Mesh cells;
    std::vector<MidNodes> mids;
    take_cells(file->read_cells(step), cells, mids);
    if (cells.tets != mesh.tets || cells.hexes != mesh.hexes || mids != mid_nodes) {
      throw IoError(path, "",
                    "step " + std::to_string(step) + " has other cells than the rest step");
    }
  }
  if (!header.has_displacement) return file->read_points(step);
  std::vector<Point3> displacement = file->read_displacement(step);
  if (displacement.size() == mesh.rest_positions.size()) {
    clear_unused(nodes_of_cells(mesh, {}, mid_nodes), displacement);
  }
  file->check_displacement(displacement);
  return displacement;
}

MeshReader::MeshReader(const std::string& path, const MeshReadOptions& options) {
  const h5::Silence silence;
  state_ = std::make_unique<State>();
  State& state = *state_;
  state.path = path;
  state.keeps_curved = options.import.keeps_curved;
  is_imported(path) ? state.import(options) : state.open_vtkhdf(options);
  Mesh& mesh = state.mesh;
  if (options.rest_file) {
    std::vector<Point3> positions = read_rest_points(*options.rest_file, options);
    check_node_count(*options.rest_file, positions.size(), mesh.rest_positions.size());
    if (state.header.has_displacement && !are_same_places(positions, mesh.rest_positions)) {
      throw IoError(path, "",
                    "has an array of displacements from its points, which are not those of '" +
                        *options.rest_file + "'; leave out --rest, or the array in the file");
    }
    mesh.rest_positions = std::move(positions);
  }
  state.header.node_count = static_cast<std::int64_t>(mesh.rest_positions.size());
  state.header.tet_count = static_cast<std::int64_t>(mesh.tets.size());
  state.header.hex_count = static_cast<std::int64_t>(mesh.hexes.size());
}

MeshReader::MeshReader(MeshReader&&) noexcept = default;
MeshReader::~MeshReader() = default;

const MeshHeader& MeshReader::header() const {
  return state_->header;
}
const Mesh& MeshReader::mesh() const {
  return state_->mesh;
}

const std::vector<MidNodes>& MeshReader::mid_nodes() const {
  return state_->mid_nodes;
}

std::vector<Point3> MeshReader::read_step(std::int64_t step) const {
  const h5::Silence silence;
  const State& state = *state_;
  std::vector<Point3> positions = state.vectors_of(step);
  check_node_count(state.path, positions.size(), state.mesh.rest_positions.size());
  if (!state.header.has_displacement) return positions;
  add(state.mesh.rest_positions, positions);
  return positions;
}

}  // namespace tetwarp
