/// @file vtkhdf_image.cpp
/// Attributes of grids, arrays of steps, and the checks of options.
#include "io/vtkhdf/vtkhdf_image.hpp"

#include <set>
#include <span>
#include <stdexcept>

#include "io/h5/h5_write.hpp"
#include "io/vtkhdf/vtkhdf_input.hpp"

namespace tetwarp {
namespace {
/// Checks arguments before the file is created.
std::string checked(const std::string& path,
                    const Grid& grid,
                    const std::vector<ArrayHeader>& arrays,
                    const VolumeWriteOptions& options) {
  if (arrays.empty()) throw IoError(path, "", "no volume to write");
  std::set<std::string> names;
  for (const ArrayHeader& array : arrays) {
    const auto refuse = [&](const std::string& problem) {
      throw IoError(path, "/VTKHDF/PointData/" + array.name, problem);
    };
    if (array.name.empty() || array.name.find_first_of("/.") != std::string::npos) {
      refuse("array names must not be empty or hold '/' or '.', rename '" + array.name + "'");
    }
    if (!names.insert(array.name).second) refuse("two arrays have this name, rename one");
    try {
      check_grid(grid, "grid");
    } catch (const std::invalid_argument& error) {
      refuse(error.what());
    }
    if (array.components < 1 || array.components > 9) refuse("expected 1 to 9 components");
  }
  check_compression(path, options);
  return path;
}
}  // namespace

void check_image_file(const std::string& path,
                      const Grid& grid,
                      const std::vector<ArrayHeader>& arrays,
                      const VolumeWriteOptions& options) {
  static_cast<void>(checked(path, grid, arrays, options));
}

void check_compression(const std::string& path, const VolumeWriteOptions& options) {
  if (options.compress >= 0 && options.compress <= 9) return;
  throw IoError(path, "",
                "compression level " + std::to_string(options.compress) + ", expected 0 to 9");
}

ImageFile::ImageFile(const std::string& path,
                     const Grid& grid,
                     const std::vector<ArrayHeader>& arrays,
                     const std::vector<std::array<std::int64_t, 3>>& chunks,
                     const VolumeWriteOptions& options,
                     bool is_temporal)
    : path_(checked(path, grid, arrays, options)),
      grid_(grid),
      headers_(arrays),
      is_temporal_(is_temporal),
      output_(path, "ImageData", is_temporal),
      point_data_(h5::create_ordered_group(output_.root(), "PointData")) {
  std::array<std::int32_t, 6> extent{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    extent[2 * axis + 1] = static_cast<std::int32_t>(grid.dims[axis] - 1);
  }
  h5::write_attribute(output_.root(), "WholeExtent", std::span<const std::int32_t>(extent));
  h5::write_attribute(output_.root(), "Origin", std::span<const double>(grid.origin));
  h5::write_attribute(output_.root(), "Spacing", std::span<const double>(grid.spacing));
  h5::write_attribute(output_.root(), "Direction", std::span<const double>(grid.direction));
  if (!options.fingerprint.empty()) {
    h5::write_text_attribute(output_.root(), "tetwarp_fingerprint", options.fingerprint);
  }
  std::vector<std::string> names;
  names.reserve(arrays.size());
  for (const ArrayHeader& array : arrays) names.push_back(array.name);
  const std::string active = active_array(names, options.scalars);
  h5::write_text_attribute(point_data_, "Scalars", active);
  for (std::size_t a = 0; a < arrays.size(); ++a) {
    arrays_.emplace_back(output_, point_data_, grid.dims, arrays[a], chunks[a], options,
                         is_temporal);
    if (names[a] == active) arrays_.back().mark_scalars();
  }
}

void ImageFile::begin_step(double time) {
  const std::int64_t row = rows_.empty() ? 0 : rows_.back() + 1;
  for (const ArrayWriter& array : arrays_) array.grow(row + 1);
  rows_.push_back(row);
  times_.push_back(time);
}

void ImageFile::repeat_step(double time) {
  if (rows_.empty()) throw IoError(path_, "", "no step to repeat");
  rows_.push_back(rows_.back());
  times_.push_back(time);
}

void ImageFile::write(std::size_t array, const Region& region, const void* samples) {
  arrays_[array].write(region, samples, is_temporal_ ? rows_.back() : 0, written_);
}

void ImageFile::write_steps() {
  if (rows_.empty()) throw IoError(path_, "", "no step was written");
  const hsize_t count = times_.size();
  const h5::Object steps = h5::create_group(output_.root(), "Steps");
  h5::write_dataset(steps, "Values", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {&count, 1}, times_.data());
  const h5::Object offsets = h5::create_group(steps, "PointDataOffsets");
  for (const ArrayHeader& array : headers_) {
    h5::write_dataset(offsets, array.name, H5T_STD_I64LE, H5T_NATIVE_INT64, {&count, 1},
                      rows_.data());
  }
  // NSteps is written last: readers treat a file with it as complete.
  h5::write_scalar_attribute(steps, "NSteps", static_cast<std::int64_t>(count));
}

WrittenFile ImageFile::finish() {
  if (is_temporal_) write_steps();
  arrays_.clear();
  point_data_.handle.close();
  written_.bytes = output_.finish();
  return written_;
}

}  // namespace tetwarp
