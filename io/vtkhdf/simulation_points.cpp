#include "io/vtkhdf/simulation_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tetwarp/error.hpp>

#include "io/h5/h5_disk.hpp"
#include "io/h5/h5_rows.hpp"

namespace tetwarp {
namespace {
constexpr std::uint8_t vtk_vertex = 1;
constexpr hsize_t point_chunk = 4096;  // rows of datasets with one row per point

/// A dataset with one number per step: where the step begins, or how much it has.
enum class StepNumber { parts, one, rows, count };
struct StepColumn {
  const char* name;
  StepNumber number;
  hsize_t width;
  bool is_of_steps;  ///< in the group Steps, else beside Points
};
constexpr std::array<StepColumn, 8> step_columns{
    {{"PartOffsets", StepNumber::parts, 0, true},
     {"NumberOfParts", StepNumber::one, 0, true},
     {"PointOffsets", StepNumber::rows, 0, true},
     {"CellOffsets", StepNumber::rows, 1, true},
     {"ConnectivityIdOffsets", StepNumber::rows, 1, true},
     {"NumberOfPoints", StepNumber::count, 0, false},
     {"NumberOfCells", StepNumber::count, 0, false},
     {"NumberOfConnectivityIds", StepNumber::count, 0, false}}};

hsize_t width_of(const PointArray& array) {
  return array.components > 1 ? static_cast<hsize_t>(array.components) : 0;
}
}  // namespace

struct StepPointsWriter::State {
  h5::Disk disk;
  h5::Object file, root, steps;
  std::vector<PointArray> arrays;
  h5::GrowingDataset points, connectivity, offsets, types, times;
  std::vector<h5::GrowingDataset> columns;  // as step_columns
  std::vector<h5::GrowingDataset> values, value_offsets;
  std::int64_t step_count = 0;
  hsize_t point_count = 0;  // of all steps that are kept

  State(const std::string& path, const std::vector<PointArray>& point_arrays);
  State(const std::string& path, const std::vector<PointArray>& point_arrays, std::int64_t kept);
  void drop_later();
  void write_step_count();
};

StepPointsWriter::State::State(const std::string& path, const std::vector<PointArray>& point_arrays)
    : file(h5::create_growing_file(path, disk)),
      root(h5::create_group(file, "VTKHDF")),
      arrays(point_arrays) {
  using h5::GrowingDataset;
  h5::write_attribute(root, "Version",
                      std::span<const std::int64_t>(std::array<std::int64_t, 2>{2, 0}));
  h5::write_text_attribute(root, "Type", "UnstructuredGrid");
  points = GrowingDataset::create(root, "Points", H5T_IEEE_F64LE, 3, point_chunk);
  connectivity = GrowingDataset::create(root, "Connectivity", H5T_STD_I64LE, 0, point_chunk);
  offsets = GrowingDataset::create(root, "Offsets", H5T_STD_I64LE, 0, point_chunk);
  types = GrowingDataset::create(root, "Types", H5T_STD_U8LE, 0, point_chunk);
  h5::create_group(root, "FieldData");
  h5::create_group(root, "CellData");
  const h5::Object data = h5::create_group(root, "PointData");
  steps = h5::create_group(root, "Steps");
  h5::write_scalar_attribute(steps, "NSteps", std::int64_t{0});
  times = GrowingDataset::create(steps, "Values", H5T_IEEE_F64LE, 0, h5::step_chunk);
  for (const StepColumn& column : step_columns) {
    columns.push_back(GrowingDataset::create(column.is_of_steps ? steps : root, column.name,
                                             H5T_STD_I64LE, column.width, h5::step_chunk));
  }
  const h5::Object data_offsets = h5::create_group(steps, "PointDataOffsets");
  for (const PointArray& array : arrays) {
    values.push_back(GrowingDataset::create(data, array.name,
                                            array.is_integer ? H5T_STD_I64LE : H5T_IEEE_F64LE,
                                            width_of(array), point_chunk));
    value_offsets.push_back(
        GrowingDataset::create(data_offsets, array.name, H5T_STD_I64LE, 0, h5::step_chunk));
  }
  h5::flush(file);
  disk.check(file);
}

StepPointsWriter::State::State(const std::string& path,
                               const std::vector<PointArray>& point_arrays,
                               std::int64_t kept)
    : file(h5::open_growing_file(path, disk)),
      root(h5::open_group(file, "VTKHDF")),
      steps(h5::open_group(root, "Steps")),
      arrays(point_arrays),
      step_count(kept) {
  using h5::GrowingDataset;
  times = GrowingDataset::open(steps, "Values", 0);
  const auto counts = h5::read_integers(h5::open_dataset(root, "NumberOfPoints"));
  if (kept < 0 || times.rows() < static_cast<hsize_t>(kept) ||
      counts.size() < static_cast<std::size_t>(kept)) {
    steps.fail("has " + std::to_string(times.rows()) + " steps, fewer than the " +
               std::to_string(kept) +
               " up to the checkpoint; name the file of the run that is continued");
  }
  for (std::int64_t step = 0; step < kept; ++step) {
    const std::int64_t count = counts[static_cast<std::size_t>(step)];
    if (count < 0) root.fail("NumberOfPoints is negative; name another file");
    point_count += static_cast<hsize_t>(count);
  }
  points = GrowingDataset::open(root, "Points", 3);
  connectivity = GrowingDataset::open(root, "Connectivity", 0);
  offsets = GrowingDataset::open(root, "Offsets", 0);
  types = GrowingDataset::open(root, "Types", 0);
  for (const StepColumn& column : step_columns) {
    columns.push_back(
        GrowingDataset::open(column.is_of_steps ? steps : root, column.name, column.width));
  }
  const h5::Object data = h5::open_group(root, "PointData");
  const h5::Object data_offsets = h5::open_group(steps, "PointDataOffsets");
  for (const PointArray& array : arrays) {
    values.push_back(GrowingDataset::open(data, array.name, width_of(array)));
    value_offsets.push_back(GrowingDataset::open(data_offsets, array.name, 0));
    if (values.back().rows() < point_count) root.fail("array " + array.name + " is too short");
  }
  if (points.rows() < point_count) root.fail("Points is too short");
}

void StepPointsWriter::State::drop_later() {
  const auto kept = static_cast<hsize_t>(step_count);
  for (h5::GrowingDataset& column : columns) column.truncate(kept);
  for (h5::GrowingDataset& column : value_offsets) column.truncate(kept);
  for (h5::GrowingDataset& array : values) array.truncate(point_count);
  times.truncate(kept);
  points.truncate(point_count);
  connectivity.truncate(point_count);
  types.truncate(point_count);
  offsets.truncate(point_count + kept);  // one more than points at every step
  write_step_count();
}

void StepPointsWriter::State::write_step_count() {
  const h5::Handle attribute(H5Aopen(steps.id(), "NSteps", H5P_DEFAULT), H5Aclose);
  if (!attribute || H5Awrite(attribute.id(), H5T_NATIVE_INT64, &step_count) < 0) {
    steps.fail_with_reason("attribute NSteps cannot be written");
  }
  h5::flush(file);
  disk.check(file);
}

StepPointsWriter::StepPointsWriter(const std::string& path, const std::vector<PointArray>& arrays) {
  const h5::Silence silence;
  state_ = std::make_unique<State>(path, arrays);
}

StepPointsWriter::StepPointsWriter(const std::string& path,
                                   const std::vector<PointArray>& arrays,
                                   std::int64_t steps) {
  const h5::Silence silence;
  state_ = std::make_unique<State>(path, arrays, steps);
}

StepPointsWriter::StepPointsWriter(StepPointsWriter&&) noexcept = default;

StepPointsWriter::~StepPointsWriter() {
  const h5::Silence silence;
  state_.reset();
}

void StepPointsWriter::drop_later() {
  const h5::Silence silence;
  state_->drop_later();
}

void StepPointsWriter::append(double time,
                              std::span<const Point3> points,
                              std::span<const std::span<const double>> values) {
  const h5::Silence silence;
  State& state = *state_;
  const auto count = static_cast<hsize_t>(points.size());
  const auto check = [&](const std::string& name, std::span<const double> numbers,
                         std::size_t expected) {
    if (numbers.size() != expected) {
      throw IoError(state.file.file, name, "has another number of values than there are points");
    }
    if (!std::ranges::all_of(numbers, [](double value) { return std::isfinite(value); })) {
      throw IoError(state.file.file, name,
                    "is not finite at " + std::to_string(time) +
                        " s; the scene is unstable, choose a smaller time_step");
    }
  };
  check("Points", {points.empty() ? nullptr : points.front().data(), 3 * points.size()},
        3 * points.size());
  for (std::size_t a = 0; a < state.arrays.size(); ++a) {
    const std::span<const double> numbers =
        a < values.size() ? values[a] : std::span<const double>();
    check(state.arrays[a].name, numbers,
          points.size() * static_cast<std::size_t>(state.arrays[a].components));
  }
  std::vector<std::int64_t> cells(points.size() + 1);
  std::iota(cells.begin(), cells.end(), std::int64_t{0});
  const std::vector<std::uint8_t> kinds(points.size(), vtk_vertex);
  state.points.append(H5T_NATIVE_DOUBLE, count, points.data());
  state.connectivity.append(H5T_NATIVE_INT64, count, cells.data());
  state.offsets.append(H5T_NATIVE_INT64, count + 1, cells.data());
  state.types.append(H5T_NATIVE_UINT8, count, kinds.data());
  const auto first = static_cast<std::int64_t>(state.point_count);
  for (std::size_t a = 0; a < state.arrays.size(); ++a) {
    state.values[a].append(H5T_NATIVE_DOUBLE, count, values[a].data());
    state.value_offsets[a].append(H5T_NATIVE_INT64, 1, &first);
  }
  const std::array<std::int64_t, 4> numbers{state.step_count, 1, first,
                                            static_cast<std::int64_t>(count)};
  for (std::size_t c = 0; c < step_columns.size(); ++c) {
    const auto number = static_cast<std::size_t>(step_columns[c].number);
    state.columns[c].append(H5T_NATIVE_INT64, 1, &numbers[number]);
  }
  state.times.append(H5T_NATIVE_DOUBLE, 1, &time);
  state.point_count += count;
  ++state.step_count;
  state.write_step_count();
}

void StepPointsWriter::close() {
  const h5::Silence silence;
  h5::flush(state_->file);
  state_->disk.check(state_->file);
  state_.reset();
}

}  // namespace tetwarp
