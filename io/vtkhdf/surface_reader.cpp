/// @file surface_reader.cpp
/// Triangles and points of VTKHDF files, and of files that VTK and Gmsh read.
#include <algorithm>
#include <cmath>
#include <optional>
#include <tetwarp/io.hpp>
#include <tetwarp/mesh_import.hpp>
#include <tetwarp/surface_reader.hpp>
#include <utility>

#include "io/vtkhdf/vtkhdf_mesh_file.hpp"

namespace tetwarp {

bool is_surface_file(const std::string& path) {
  if (has_surface_extension(path)) return true;
  const h5::Silence silence;
  return kind_of(path) == FileKind::mesh && !MeshFile(path).has_solids(0);
}

struct SurfaceReader::State {
  std::string path;
  std::optional<MeshFile> file;  ///< of VTKHDF, whose steps are read one by one
  ImportedMesh imported;         ///< of other formats, with all steps
  std::vector<std::array<std::int32_t, 3>> triangles;

  /// Displacements at a step; none where points are stored as they move.
  std::vector<Point3> displacements(std::int64_t step) const {
    if (file)
      return file->has_displacement() ? file->read_displacement(step) : std::vector<Point3>();
    if (imported.displacements.empty()) return {};
    return imported.displacements[static_cast<std::size_t>(step)];
  }
};

SurfaceReader::SurfaceReader(const std::string& path) : state_(std::make_unique<State>()) {
  const h5::Silence silence;
  state_->path = path;
  if ((has_mesh_extension(path) || has_surface_extension(path)) &&
      kind_of(path) == FileKind::unknown) {
    state_->imported = import_mesh(path, {.needs_solids = false});
    if (std::ranges::count(state_->imported.left_out, "point array 'displacement'") > 0) {
      throw IoError(path, "displacement",
                    "is not read of this format; move the points by it, or write VTKHDF");
    }
    state_->triangles = std::move(state_->imported.triangles);
  } else {
    state_->file.emplace(path);
    state_->triangles = state_->file->read_cells(0, CellChoice::triangles).triangles;
  }
}

SurfaceReader::SurfaceReader(SurfaceReader&&) noexcept = default;
SurfaceReader::~SurfaceReader() = default;

const std::string& SurfaceReader::path() const {
  return state_->path;
}

const std::vector<std::array<std::int32_t, 3>>& SurfaceReader::triangles() const {
  return state_->triangles;
}

std::int64_t SurfaceReader::step_count() const {
  const auto& times = state_->file ? state_->file->file().times : state_->imported.times;
  return std::max<std::int64_t>(1, std::ssize(times));
}

std::vector<Point3> SurfaceReader::points(std::int64_t step) const {
  const h5::Silence silence;
  const std::string name = "step " + std::to_string(step);
  if (step < 0 || step >= step_count()) {
    throw IoError(state_->path, "",
                  "has no " + name + "; it has " + std::to_string(step_count()) + " steps");
  }
  if (state_->file && step > 0 &&
      state_->file->read_cells(step, CellChoice::triangles).triangles != state_->triangles) {
    throw IoError(state_->path, "",
                  name + " has other triangles than step 0; write all steps with the same");
  }
  std::vector<Point3> points =
      state_->file ? state_->file->read_points(step) : state_->imported.mesh.rest_positions;
  const std::vector<Point3> ways = state_->displacements(step);
  for (std::size_t p = 0; p < ways.size(); ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) points[p][axis] += ways[p][axis];
  }
  const auto bad = std::ranges::find_if_not(points, [](const Point3& point) {
    return std::ranges::all_of(point, [](double x) { return std::isfinite(x); });
  });
  if (bad != points.end()) {
    throw IoError(state_->path, "",
                  name + ": point " + std::to_string(bad - points.begin()) +
                      " is not finite; correct or remove it");
  }
  return points;
}

}  // namespace tetwarp
