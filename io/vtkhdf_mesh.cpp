/// @file vtkhdf_mesh.cpp
/// Rest and deformed positions of a mesh file.
#include <tetwarp/io.hpp>
#include <utility>

#include "io/vtkhdf_mesh_file.hpp"

namespace tetwarp {

struct MeshReader::State {
  MeshFile file;
  MeshHeader header;
  Mesh mesh;
  std::vector<MeshPart> parts;  // that `mesh` was read from
};

namespace {
void check_node_count(const h5::Object& about, std::size_t found, std::size_t expected) {
  if (found == expected) return;
  about.fail("has " + std::to_string(found) + " nodes, the mesh has " + std::to_string(expected));
}

/// Two steps have the same topology when their cells and connectivity are the same rows.
bool is_same_topology(const std::vector<MeshPart>& a, std::vector<MeshPart> b) {
  if (a.size() != b.size()) return false;
  for (std::size_t part = 0; part < a.size(); ++part) b[part].first_node = a[part].first_node;
  return a == b;
}
}  // namespace

MeshReader::MeshReader(const std::string& path, const MeshReadOptions& options) {
  const h5::Silence silence;
  state_ = std::make_unique<State>(State{MeshFile(path), {}, {}, {}});
  State& state = *state_;
  const VtkhdfInput& file = state.file.file();
  file.check_step(options.rest_step);
  state.parts = state.file.parts_of(options.rest_step);
  MeshCells cells = state.file.read_cells(options.rest_step);
  state.mesh.tets = std::move(cells.tets);
  state.mesh.hexes = std::move(cells.hexes);
  state.mesh.rest_positions = state.file.read_points(options.rest_step);
  if (options.rest_file) {
    const MeshFile rest(*options.rest_file);
    std::vector<Point3> positions = rest.read_points(0);
    check_node_count(rest.file().file, positions.size(), state.mesh.rest_positions.size());
    state.mesh.rest_positions = std::move(positions);
  }
  state.header.node_count = static_cast<std::int64_t>(state.mesh.rest_positions.size());
  state.header.tet_count = static_cast<std::int64_t>(state.mesh.tets.size());
  state.header.hex_count = static_cast<std::int64_t>(state.mesh.hexes.size());
  state.header.times = file.is_temporal() ? file.times : std::vector<double>{0.0};
  state.header.has_displacement = state.file.has_displacement();
}

MeshReader::MeshReader(MeshReader&&) noexcept = default;
MeshReader::~MeshReader() = default;

const MeshHeader& MeshReader::header() const {
  return state_->header;
}
const Mesh& MeshReader::mesh() const {
  return state_->mesh;
}

std::vector<Point3> MeshReader::read_step(std::int64_t step) const {
  const h5::Silence silence;
  const State& state = *state_;
  const h5::Object& file = state.file.file().file;
  state.file.file().check_step(step);
  if (!is_same_topology(state.parts, state.file.parts_of(step))) {
    const MeshCells cells = state.file.read_cells(step);
    if (cells.tets != state.mesh.tets || cells.hexes != state.mesh.hexes) {
      file.fail("step " + std::to_string(step) + " has other cells than the rest step");
    }
  }
  std::vector<Point3> positions = state.header.has_displacement ? state.file.read_displacement(step)
                                                                : state.file.read_points(step);
  check_node_count(file, positions.size(), state.mesh.rest_positions.size());
  if (!state.header.has_displacement) return positions;
  for (std::size_t node = 0; node < positions.size(); ++node) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      positions[node][axis] += state.mesh.rest_positions[node][axis];
    }
  }
  return positions;
}

}  // namespace tetwarp
