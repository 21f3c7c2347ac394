#include "io/simulation_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tetwarp/error.hpp>

#include "io/h5_disk.hpp"
#include "io/h5_rows.hpp"
#include "io/vtkhdf_cells.hpp"
#include "io/vtkhdf_mesh_file.hpp"

namespace tetwarp {
namespace {
constexpr hsize_t step_chunk = 256;             // rows of datasets with one row per step
constexpr hsize_t value_chunk_bytes = 1 << 20;  // at most, of arrays

/// Datasets below Steps with one number per step that is the same in all steps.
struct SteadyColumn {
  const char* name;
  std::int64_t value;
  hsize_t width;
};
constexpr std::array<SteadyColumn, 5> steady_columns{{{"PartOffsets", 0, 0},
                                                      {"NumberOfParts", 1, 0},
                                                      {"PointOffsets", 0, 0},
                                                      {"CellOffsets", 0, 1},
                                                      {"ConnectivityIdOffsets", 0, 1}}};

hsize_t width_of(const StepArray& array) {
  return array.components > 1 ? static_cast<hsize_t>(array.components) : 0;
}

/// Rows of a chunk: a step, or an equal part of it.
hsize_t chunk_rows(hsize_t rows, int components) {
  const hsize_t most = value_chunk_bytes / (8 * static_cast<hsize_t>(components));
  const hsize_t parts = (rows + most - 1) / most;
  return std::max<hsize_t>(1, (rows + parts - 1) / std::max<hsize_t>(1, parts));
}
}  // namespace

struct StepMeshWriter::State {
  h5::Disk disk;
  h5::Object file, root, steps;
  std::vector<StepArray> arrays;
  std::vector<hsize_t> row_counts;  // of each array at a step
  std::vector<h5::GrowingDataset> values, offsets;
  std::vector<h5::GrowingDataset> steady;
  h5::GrowingDataset times;
  std::int64_t step_count = 0;

  State(const std::string& path,
        const std::vector<StepArray>& step_arrays,
        std::span<const Point3> points,
        const CellRows& cells);
  State(const std::string& path,
        const std::vector<StepArray>& step_arrays,
        std::size_t point_count,
        std::int64_t kept);
  void drop_later();
  void write_step_count();
};

StepMeshWriter::State::State(const std::string& path,
                             const std::vector<StepArray>& step_arrays,
                             std::span<const Point3> points,
                             const CellRows& cells)
    : file(h5::create_growing_file(path, disk)),
      root(h5::create_group(file, "VTKHDF")),
      arrays(step_arrays) {
  h5::write_attribute(root, "Version",
                      std::span<const std::int64_t>(std::array<std::int64_t, 2>{2, 0}));
  h5::write_text_attribute(root, "Type", "UnstructuredGrid");
  write_grid(root, points, cells);
  h5::create_group(root, "FieldData");
  const h5::Object groups[2] = {h5::create_group(root, "PointData"),
                                h5::create_group(root, "CellData")};
  steps = h5::create_group(root, "Steps");
  h5::write_scalar_attribute(steps, "NSteps", std::int64_t{0});
  times = h5::GrowingDataset::create(steps, "Values", H5T_IEEE_F64LE, 0, step_chunk);
  for (const SteadyColumn& column : steady_columns) {
    steady.push_back(
        h5::GrowingDataset::create(steps, column.name, H5T_STD_I64LE, column.width, step_chunk));
  }
  const h5::Object offset_groups[2] = {h5::create_group(steps, "PointDataOffsets"),
                                       h5::create_group(steps, "CellDataOffsets")};
  for (const StepArray& array : arrays) {
    const hsize_t rows = array.is_of_cells ? cells.types.size() : points.size();
    row_counts.push_back(rows);
    values.push_back(h5::GrowingDataset::create(groups[array.is_of_cells], array.name,
                                                H5T_IEEE_F64LE, width_of(array),
                                                chunk_rows(rows, array.components)));
    offsets.push_back(h5::GrowingDataset::create(offset_groups[array.is_of_cells], array.name,
                                                 H5T_STD_I64LE, 0, step_chunk));
  }
  h5::flush(file);
  disk.check(file);
}

StepMeshWriter::State::State(const std::string& path,
                             const std::vector<StepArray>& step_arrays,
                             std::size_t point_count,
                             std::int64_t kept)
    : file(h5::open_growing_file(path, disk)),
      root(h5::open_group(file, "VTKHDF")),
      steps(h5::open_group(root, "Steps")),
      arrays(step_arrays),
      step_count(kept) {
  const auto points = h5::read_integers(h5::open_dataset(root, "NumberOfPoints"));
  const auto cells = h5::read_integers(h5::open_dataset(root, "NumberOfCells"));
  if (points.size() != 1 || cells.size() != 1 ||
      points[0] != static_cast<std::int64_t>(point_count)) {
    root.fail("has other points than the scene; name the folder of the run that is continued");
  }
  times = h5::GrowingDataset::open(steps, "Values", 0);
  if (kept < 0 || times.rows() < static_cast<hsize_t>(kept)) {
    steps.fail("has " + std::to_string(times.rows()) + " steps, fewer than the " +
               std::to_string(kept) +
               " up to the checkpoint; name the folder of the run that "
               "is continued");
  }
  for (const SteadyColumn& column : steady_columns) {
    steady.push_back(h5::GrowingDataset::open(steps, column.name, column.width));
  }
  for (const StepArray& array : arrays) {
    const char* group = array.is_of_cells ? "CellData" : "PointData";
    const hsize_t rows = static_cast<hsize_t>(array.is_of_cells ? cells[0] : points[0]);
    row_counts.push_back(rows);
    values.push_back(
        h5::GrowingDataset::open(h5::open_group(root, group), array.name, width_of(array)));
    offsets.push_back(h5::GrowingDataset::open(
        h5::open_group(steps, std::string(group) + "Offsets"), array.name, 0));
    if (values.back().rows() < rows * static_cast<hsize_t>(kept) ||
        offsets.back().rows() < static_cast<hsize_t>(kept)) {
      root.fail("array " + array.name + " has fewer rows than the steps need");
    }
  }
}

void StepMeshWriter::State::drop_later() {
  const auto kept = static_cast<hsize_t>(step_count);
  times.truncate(kept);
  for (h5::GrowingDataset& column : steady) column.truncate(kept);
  for (std::size_t a = 0; a < arrays.size(); ++a) {
    values[a].truncate(row_counts[a] * kept);
    offsets[a].truncate(kept);
  }
  write_step_count();
}

void StepMeshWriter::State::write_step_count() {
  const h5::Handle attribute(H5Aopen(steps.id(), "NSteps", H5P_DEFAULT), H5Aclose);
  if (!attribute || H5Awrite(attribute.id(), H5T_NATIVE_INT64, &step_count) < 0) {
    steps.fail_with_reason("attribute NSteps cannot be written");
  }
  h5::flush(file);
  disk.check(file);
}

StepMeshWriter::StepMeshWriter(const std::string& path,
                               const Mesh& mesh,
                               const std::vector<StepArray>& arrays) {
  const h5::Silence silence;
  CellRows cells;
  cells.add<4>(vtk_tetra, mesh.tets);
  cells.add<8>(vtk_hexahedron, mesh.hexes);
  state_ = std::make_unique<State>(path, arrays, mesh.rest_positions, cells);
}

StepMeshWriter::StepMeshWriter(const std::string& path,
                               const Surface& surface,
                               const std::vector<StepArray>& arrays) {
  const h5::Silence silence;
  CellRows cells;
  cells.add<3>(vtk_triangle, surface.triangles);
  state_ = std::make_unique<State>(path, arrays, surface.points, cells);
}

StepMeshWriter::StepMeshWriter(const std::string& path,
                               std::size_t point_count,
                               const std::vector<StepArray>& arrays,
                               std::int64_t steps) {
  const h5::Silence silence;
  state_ = std::make_unique<State>(path, arrays, point_count, steps);
}

StepMeshWriter::StepMeshWriter(StepMeshWriter&&) noexcept = default;

StepMeshWriter::~StepMeshWriter() {
  const h5::Silence silence;
  state_.reset();
}

void StepMeshWriter::drop_later() {
  const h5::Silence silence;
  state_->drop_later();
}

void StepMeshWriter::append(double time, std::span<const std::span<const double>> values) {
  const h5::Silence silence;
  State& state = *state_;
  for (std::size_t a = 0; a < state.arrays.size(); ++a) {
    const StepArray& array = state.arrays[a];
    const std::size_t expected = state.row_counts[a] * static_cast<std::size_t>(array.components);
    if (a >= values.size() || values[a].size() != expected) {
      throw IoError(state.file.file, array.name,
                    "has another number of values than the mesh has rows");
    }
    if (!std::ranges::all_of(values[a], [](double value) { return std::isfinite(value); })) {
      throw IoError(state.file.file, array.name,
                    "is not finite at " + std::to_string(time) +
                        " s; the scene is unstable, choose a smaller time_step");
    }
  }
  for (std::size_t a = 0; a < state.arrays.size(); ++a) {
    const auto first = static_cast<std::int64_t>(state.values[a].rows());
    state.values[a].append(H5T_NATIVE_DOUBLE, state.row_counts[a], values[a].data());
    state.offsets[a].append(H5T_NATIVE_INT64, 1, &first);
  }
  for (std::size_t c = 0; c < steady_columns.size(); ++c) {
    state.steady[c].append(H5T_NATIVE_INT64, 1, &steady_columns[c].value);
  }
  state.times.append(H5T_NATIVE_DOUBLE, 1, &time);
  ++state.step_count;
  state.write_step_count();
}

void StepMeshWriter::close() {
  const h5::Silence silence;
  const std::string path = state_->file.file;
  h5::flush(state_->file);
  state_->disk.check(state_->file);
  state_.reset();
}

}  // namespace tetwarp
