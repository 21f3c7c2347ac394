#include "io/vtkhdf/simulation_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tetwarp/error.hpp>
#include <utility>

#include "io/h5/h5_disk.hpp"
#include "io/h5/h5_rows.hpp"
#include "io/vtkhdf/vtkhdf_cells.hpp"
#include "io/vtkhdf/vtkhdf_mesh_file.hpp"

namespace tetwarp {
namespace {
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
  std::string path;
  std::vector<StepArray> arrays;
  h5::Disk disk = {};
  std::vector<hsize_t> row_counts = {};  // of each array at a step
  std::int64_t step_count = 0;           // in the file
  // Of steps that are not written; one vector for each array.
  std::vector<double> times = {};
  std::vector<std::vector<double>> kept = std::vector<std::vector<double>>(arrays.size());

  void create(std::span<const Point3> points, const CellRows& cells);
};

namespace {
/// A file while it is changed. It is closed between calls of flush(): each open file takes
/// megabytes, and HDF5 1.10 passes over the datasets of all open files whenever it flushes one.
class OpenFile {
 public:
  explicit OpenFile(h5::Object opened)
      : file_(std::move(opened)),
        root_(h5::open_group(file_, "VTKHDF")),
        steps_(h5::open_group(root_, "Steps")) {}

  const h5::Object& root() const { return root_; }
  const h5::Object& steps() const { return steps_; }
  h5::GrowingDataset times() const { return h5::GrowingDataset::open(steps_, "Values", 0); }
  h5::GrowingDataset steady(const SteadyColumn& column) const {
    return h5::GrowingDataset::open(steps_, column.name, column.width);
  }
  h5::GrowingDataset values(const StepArray& array) const {
    return h5::GrowingDataset::open(h5::open_group(root_, group_of(array)), array.name,
                                    width_of(array));
  }
  h5::GrowingDataset offsets(const StepArray& array) const {
    return h5::GrowingDataset::open(
        h5::open_group(steps_, std::string(group_of(array)) + "Offsets"), array.name, 0);
  }

  /// Arrays of points and of cells.
  std::size_t array_count() const {
    std::size_t count = 0;
    for (const char* const group : {"PointDataOffsets", "CellDataOffsets"}) {
      const h5::Object offsets = h5::open_group(steps_, group);
      H5G_info_t info;
      if (H5Gget_info(offsets.id(), &info) < 0) offsets.fail("cannot be read");
      count += static_cast<std::size_t>(info.nlinks);
    }
    return count;
  }

  /// Writes the number of steps and closes the file.
  void close(std::int64_t step_count, const h5::Disk& disk) {
    h5::Handle attribute(H5Aopen(steps_.id(), "NSteps", H5P_DEFAULT), H5Aclose);
    if (!attribute || H5Awrite(attribute.id(), H5T_NATIVE_INT64, &step_count) < 0) {
      steps_.fail_with_reason("attribute NSteps cannot be written");
    }
    attribute.close();
    steps_.handle.close();
    root_.handle.close();
    h5::close_written(file_, disk);
  }

 private:
  static const char* group_of(const StepArray& array) {
    return array.is_of_cells ? "CellData" : "PointData";
  }

  h5::Object file_, root_, steps_;
};
}  // namespace

void StepMeshWriter::State::create(std::span<const Point3> points, const CellRows& cells) {
  h5::Object file = h5::create_growing_file(path, disk);
  {
    const h5::Object root = h5::create_group(file, "VTKHDF");
    h5::write_attribute(root, "Version",
                        std::span<const std::int64_t>(std::array<std::int64_t, 2>{2, 0}));
    h5::write_text_attribute(root, "Type", "UnstructuredGrid");
    write_grid(root, points, cells);
    h5::create_group(root, "FieldData");
    const h5::Object groups[2] = {h5::create_group(root, "PointData"),
                                  h5::create_group(root, "CellData")};
    const h5::Object steps = h5::create_group(root, "Steps");
    h5::write_scalar_attribute(steps, "NSteps", std::int64_t{0});
    h5::GrowingDataset::create(steps, "Values", H5T_IEEE_F64LE, 0, h5::step_chunk);
    for (const SteadyColumn& column : steady_columns) {
      h5::GrowingDataset::create(steps, column.name, H5T_STD_I64LE, column.width, h5::step_chunk);
    }
    const h5::Object offset_groups[2] = {h5::create_group(steps, "PointDataOffsets"),
                                         h5::create_group(steps, "CellDataOffsets")};
    for (const StepArray& array : arrays) {
      const hsize_t rows = array.is_of_cells ? cells.types.size() : points.size();
      row_counts.push_back(rows);
      h5::GrowingDataset::create(groups[array.is_of_cells], array.name, H5T_IEEE_F64LE,
                                 width_of(array), chunk_rows(rows, array.components));
      h5::GrowingDataset::create(offset_groups[array.is_of_cells], array.name, H5T_STD_I64LE, 0,
                                 h5::step_chunk);
    }
  }
  h5::close_written(file, disk);
}

StepMeshWriter::StepMeshWriter(const std::string& path,
                               const Mesh& mesh,
                               const std::vector<StepArray>& arrays) {
  const h5::Silence silence;
  CellRows cells;
  cells.add<4>(vtk_tetra, mesh.tets);
  cells.add<8>(vtk_hexahedron, mesh.hexes);
  state_ = std::make_unique<State>(State{path, arrays});
  state_->create(mesh.rest_positions, cells);
}

StepMeshWriter::StepMeshWriter(const std::string& path,
                               const Surface& surface,
                               const std::vector<StepArray>& arrays) {
  const h5::Silence silence;
  CellRows cells;
  cells.add<3>(vtk_triangle, surface.triangles);
  state_ = std::make_unique<State>(State{path, arrays});
  state_->create(surface.points, cells);
}

StepMeshWriter::StepMeshWriter(const std::string& path,
                               std::size_t point_count,
                               const std::vector<StepArray>& arrays,
                               std::int64_t steps) {
  const h5::Silence silence;
  state_ = std::make_unique<State>(State{path, arrays});
  State& state = *state_;
  state.step_count = steps;
  const OpenFile open(h5::open_growing_file(path, state.disk));
  const auto points = h5::read_integers(h5::open_dataset(open.root(), "NumberOfPoints"));
  const auto cells = h5::read_integers(h5::open_dataset(open.root(), "NumberOfCells"));
  if (points.size() != 1 || cells.size() != 1 ||
      points[0] != static_cast<std::int64_t>(point_count)) {
    open.root().fail(
        "has other points than the scene; name the folder of the run that is continued");
  }
  const hsize_t rows = open.times().rows(), kept = static_cast<hsize_t>(steps);
  if (steps < 0 || rows < kept) {
    open.steps().fail("has " + std::to_string(rows) + " steps, fewer than the " +
                      std::to_string(steps) +
                      " up to the checkpoint; name the folder of the run that is continued");
  }
  for (const SteadyColumn& column : steady_columns) open.steady(column);
  if (open.array_count() != arrays.size()) {
    open.root().fail(
        "has other fields than output.fields of the scene; ask for those of the run that is "
        "continued, or name a new folder");
  }
  for (const StepArray& array : arrays) {
    state.row_counts.push_back(static_cast<hsize_t>(array.is_of_cells ? cells[0] : points[0]));
    if (open.values(array).rows() < state.row_counts.back() * kept ||
        open.offsets(array).rows() < kept) {
      open.root().fail("array " + array.name + " has fewer rows than the steps need");
    }
  }
}

StepMeshWriter::StepMeshWriter(StepMeshWriter&&) noexcept = default;

StepMeshWriter::~StepMeshWriter() {
  if (!state_) return;
  try {
    flush();
  } catch (const IoError&) {
    // The same error was thrown to a caller that flushed, or no caller is left.
  }
}

void StepMeshWriter::drop_later() {
  const h5::Silence silence;
  State& state = *state_;
  const auto kept = static_cast<hsize_t>(state.step_count);
  OpenFile open(h5::reopen_growing_file(state.path, state.disk));
  open.times().truncate(kept);
  for (const SteadyColumn& column : steady_columns) open.steady(column).truncate(kept);
  for (std::size_t a = 0; a < state.arrays.size(); ++a) {
    open.values(state.arrays[a]).truncate(state.row_counts[a] * kept);
    open.offsets(state.arrays[a]).truncate(kept);
  }
  open.close(state.step_count, state.disk);
}

void StepMeshWriter::append(double time, std::span<const std::span<const double>> values) {
  const h5::Silence silence;
  State& state = *state_;
  for (std::size_t a = 0; a < state.arrays.size(); ++a) {
    const StepArray& array = state.arrays[a];
    const std::size_t expected = state.row_counts[a] * static_cast<std::size_t>(array.components);
    if (a >= values.size() || values[a].size() != expected) {
      throw IoError(state.path, array.name, "has another number of values than the mesh has rows");
    }
    if (!std::ranges::all_of(values[a], [](double value) { return std::isfinite(value); })) {
      throw IoError(state.path, array.name,
                    "is not finite at " + std::to_string(time) +
                        " s; the scene is unstable, choose a smaller time_step");
    }
  }
  for (std::size_t a = 0; a < state.arrays.size(); ++a) {
    state.kept[a].insert(state.kept[a].end(), values[a].begin(), values[a].end());
  }
  state.times.push_back(time);
}

void StepMeshWriter::flush() {
  State& state = *state_;
  if (state.times.empty()) return;
  const std::vector<double> times = std::exchange(state.times, {});
  const auto kept = std::exchange(state.kept, std::vector<std::vector<double>>(state.kept.size()));
  const std::size_t count = times.size();
  const h5::Silence silence;
  OpenFile open(h5::reopen_growing_file(state.path, state.disk));
  std::vector<std::int64_t> column(count);
  for (std::size_t a = 0; a < state.arrays.size(); ++a) {
    h5::GrowingDataset own = open.values(state.arrays[a]);
    for (std::size_t step = 0; step < count; ++step) {
      column[step] = static_cast<std::int64_t>(own.rows() + step * state.row_counts[a]);
    }
    own.append(H5T_NATIVE_DOUBLE, count * state.row_counts[a], kept[a].data());
    open.offsets(state.arrays[a]).append(H5T_NATIVE_INT64, count, column.data());
  }
  for (const SteadyColumn& steady : steady_columns) {
    std::ranges::fill(column, steady.value);
    open.steady(steady).append(H5T_NATIVE_INT64, count, column.data());
  }
  open.times().append(H5T_NATIVE_DOUBLE, count, times.data());
  state.step_count += static_cast<std::int64_t>(count);
  open.close(state.step_count, state.disk);
}

}  // namespace tetwarp
