/// @file vtkhdf_write.cpp
/// Writing VTKHDF ImageData: static files of Version [1,0], temporal ones of Version [2,0].
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <tetwarp/io.hpp>

#include "io/finished_file.hpp"
#include "io/vtkhdf_array.hpp"
#include "io/vtkhdf_output.hpp"

namespace tetwarp {

namespace {

std::string array_path(const Volume& volume) {
  return "/VTKHDF/PointData/" + volume.name;
}

void check_volumes(const std::string& path, const std::vector<const Volume*>& volumes) {
  if (volumes.empty()) throw IoError(path, "", "no volume to write");
  std::set<std::string> names;
  for (const Volume* volume : volumes) {
    if (volume == nullptr) throw IoError(path, "", "a volume to write is null");
    const auto refuse = [&](const std::string& problem) {
      throw IoError(path, array_path(*volume), problem);
    };
    if (volume->name.empty() || volume->name.find_first_of("/.") != std::string::npos) {
      refuse("array names must not be empty or hold '/' or '.', rename '" + volume->name + "'");
    }
    if (!names.insert(volume->name).second) refuse("two arrays have this name, rename one");
    if (volume->grid != volumes.front()->grid) {
      refuse("lies on another grid than '" + volumes.front()->name + "', write it to its own file");
    }
    try {
      check_grid(volume->grid, "grid");
      static_cast<void>(VolumeView(*volume));  // checks that the samples fill the grid
    } catch (const std::invalid_argument& error) {
      refuse(error.what());
    }
    if (volume->components < 1 || volume->components > 9) refuse("expected 1 to 9 components");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (volume->grid.dims[axis] == 1) {
        refuse("has one sample on axis " + std::to_string(axis) +
               ", VTK cannot read such images; repeat the slice or export to NIfTI");
      }
    }
  }
}

void check_options(const std::string& path, const VolumeWriteOptions& options) {
  if (options.compress >= 0 && options.compress <= 9) return;
  throw IoError(path, "",
                "compression level " + std::to_string(options.compress) + ", expected 0 to 9");
}

/// /VTKHDF/PointData with its datasets, all of them still empty.
struct ImageFile {
  VtkhdfOutput output;
  h5::Object point_data;
  std::vector<ArrayWriter> arrays;
  WrittenFile written;

  ImageFile(const std::string& path,
            const std::vector<const Volume*>& volumes,
            const VolumeWriteOptions& options,
            bool is_temporal)
      : output(path, "ImageData", is_temporal),
        point_data(h5::create_group(output.root(), "PointData")) {
    const Grid& grid = volumes.front()->grid;
    std::array<std::int32_t, 6> extent{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      extent[2 * axis + 1] = static_cast<std::int32_t>(grid.dims[axis] - 1);
    }
    h5::write_attribute(output.root(), "WholeExtent", std::span<const std::int32_t>(extent));
    h5::write_attribute(output.root(), "Origin", std::span<const double>(grid.origin));
    h5::write_attribute(output.root(), "Spacing", std::span<const double>(grid.spacing));
    h5::write_attribute(output.root(), "Direction", std::span<const double>(grid.direction));
    if (!options.fingerprint.empty()) {
      h5::write_text_attribute(output.root(), "tetwarp_fingerprint", options.fingerprint);
    }
    h5::write_text_attribute(point_data, "Scalars", volumes.front()->name);
    for (const Volume* volume : volumes) {
      arrays.emplace_back(output, point_data, *volume, options, is_temporal);
    }
  }

  WrittenFile finish() {
    arrays.clear();
    point_data.handle.close();
    written.bytes = output.finish();
    return written;
  }
};

}  // namespace

WrittenFile write_volumes(const std::string& path,
                          const std::vector<const Volume*>& volumes,
                          const VolumeWriteOptions& options) {
  const h5::Silence silence;
  check_volumes(path, volumes);
  check_options(path, options);
  ImageFile file(path, volumes, options, false);
  for (std::size_t array = 0; array < volumes.size(); ++array) {
    file.arrays[array].write(*volumes[array], 0, file.written);
  }
  return file.finish();
}

struct TemporalVolumeWriter::State {
  std::string path;
  VolumeWriteOptions options;
  std::optional<ImageFile> file;  // made by the first step, which knows the arrays
  Grid grid;
  std::vector<double> times;
  std::vector<std::int64_t> rows;  // of the time axis, one per step
};

TemporalVolumeWriter::TemporalVolumeWriter(const std::string& path,
                                           const VolumeWriteOptions& options) {
  check_options(path, options);
  state_ = std::make_unique<State>();
  state_->path = path;
  state_->options = options;
}

TemporalVolumeWriter::TemporalVolumeWriter(TemporalVolumeWriter&&) noexcept = default;

TemporalVolumeWriter::~TemporalVolumeWriter() {
  const h5::Silence silence;
  state_.reset();
}

void TemporalVolumeWriter::append(double time, const std::vector<const Volume*>& volumes) {
  const h5::Silence silence;
  State& state = *state_;
  check_volumes(state.path, volumes);
  if (!state.file) {
    state.file.emplace(state.path, volumes, state.options, true);
    state.grid = volumes.front()->grid;
  }
  const std::vector<ArrayWriter>& arrays = state.file->arrays;
  if (volumes.size() != arrays.size()) {
    throw IoError(state.path, "",
                  "a step of " + std::to_string(volumes.size()) + " arrays after steps of " +
                      std::to_string(arrays.size()));
  }
  const std::int64_t row = state.rows.empty() ? 0 : state.rows.back() + 1;
  for (std::size_t array = 0; array < arrays.size(); ++array) {
    if (!arrays[array].fits(*volumes[array]) || volumes[array]->grid != state.grid) {
      throw IoError(state.path, array_path(*volumes[array]),
                    "name, grid, type or components differ from the first step's");
    }
  }
  for (std::size_t array = 0; array < arrays.size(); ++array) {
    arrays[array].write(*volumes[array], row, state.file->written);
  }
  state.rows.push_back(row);
  state.times.push_back(time);
}

void TemporalVolumeWriter::repeat(double time) {
  if (state_->rows.empty()) throw IoError(state_->path, "", "no step to repeat");
  state_->rows.push_back(state_->rows.back());
  state_->times.push_back(time);
}

WrittenFile TemporalVolumeWriter::finish() {
  const h5::Silence silence;
  State& state = *state_;
  if (state.rows.empty()) throw IoError(state.path, "", "no step was written");
  const hsize_t count = state.times.size();
  {
    const h5::Object steps = h5::create_group(state.file->output.root(), "Steps");
    h5::write_dataset(steps, "Values", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {&count, 1},
                      state.times.data());
    const h5::Object offsets = h5::create_group(steps, "PointDataOffsets");
    for (const ArrayWriter& array : state.file->arrays) {
      h5::write_dataset(offsets, array.name(), H5T_STD_I64LE, H5T_NATIVE_INT64, {&count, 1},
                        state.rows.data());
    }
    // Readers count on everything that NSteps announces: it comes last.
    h5::write_scalar_attribute(steps, "NSteps", static_cast<std::int64_t>(count));
  }
  return state.file->finish();
}

}  // namespace tetwarp
