/// @file vtkhdf_array.cpp
/// Shapes of chunks, and chunks that hold nothing but the background.
#include "io/vtkhdf/vtkhdf_array.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "host/base/pixel_dispatch.hpp"
#include "io/h5/h5_write.hpp"
#include "io/nifti/nifti_facts.hpp"

namespace tetwarp {
namespace {
constexpr std::int64_t chunk_bytes = std::int64_t{256} << 10;
constexpr std::int64_t max_row_bytes = std::int64_t{1} << 20;

template <class T>
std::vector<std::byte> bytes_of(T value) {
  std::vector<std::byte> bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

template <class T>
std::vector<std::byte> integer_bytes(double value) {
  const double rounded = std::nearbyint(value);
  if (std::isnan(rounded)) return bytes_of(T{0});
  if (rounded <= static_cast<double>(std::numeric_limits<T>::min())) {
    return bytes_of(std::numeric_limits<T>::min());
  }
  // The largest 64-bit integer is not a double: converted it rounds up, out of range.
  if (rounded >= static_cast<double>(std::numeric_limits<T>::max())) {
    return bytes_of(std::numeric_limits<T>::max());
  }
  return bytes_of(static_cast<T>(rounded));
}

/// Edges along the axes of a dataset, then components where there are several, after `row` in
/// temporal files.
std::vector<hsize_t> file_shape(const std::array<std::int64_t, 3>& xyz,
                                const std::vector<std::size_t>& axes,
                                int components,
                                bool is_temporal,
                                std::int64_t row) {
  std::vector<hsize_t> shape;
  if (is_temporal) shape.push_back(static_cast<hsize_t>(row));
  for (const std::size_t axis : axes) shape.push_back(static_cast<hsize_t>(xyz[axis]));
  if (components > 1) shape.push_back(static_cast<hsize_t>(components));
  return shape;
}
}  // namespace

std::vector<std::size_t> axes_in_file(const std::array<std::int64_t, 3>& dims, bool is_temporal) {
  std::vector<std::size_t> axes;
  for (std::size_t axis = 3; axis-- > 0;) {
    if (dims[axis] > 1) axes.push_back(axis);
  }
  if (axes.empty() && !is_temporal) axes.push_back(0);
  return axes;
}

std::array<std::int64_t, 3> row_chunk(const std::array<std::int64_t, 3>& dims,
                                      std::int64_t voxel_bytes) {
  const std::int64_t x = std::min(dims[0], max_row_bytes / voxel_bytes);
  const std::int64_t rows = std::max<std::int64_t>(1, chunk_bytes / (x * voxel_bytes));
  const std::int64_t y = std::min(dims[1], rows);
  return {x, y, std::min(dims[2], std::max<std::int64_t>(1, rows / y))};
}

std::array<std::int64_t, 3> brick_chunk(const std::array<std::int64_t, 3>& dims,
                                        std::int64_t voxel_bytes) {
  std::array<std::int64_t, 3> edges = {8, 8, 8};
  for (std::size_t axis = 0; 2 * edges[0] * edges[1] * edges[2] * voxel_bytes <= chunk_bytes;
       axis = (axis + 1) % 3) {
    edges[axis] *= 2;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) edges[axis] = std::min(edges[axis], dims[axis]);
  return edges;
}

std::vector<std::byte> sample_bytes(PixelType type, double value) {
  std::vector<std::byte> bytes;
  with_pixel_type(type, [&]<class T>(T) {
    if constexpr (std::is_integral_v<T>) {
      bytes = integer_bytes<T>(value);
    } else {
      bytes = bytes_of(static_cast<T>(value));
    }
  });
  return bytes;
}

ArrayWriter::ArrayWriter(const VtkhdfOutput& output,
                         const h5::Object& point_data,
                         const std::array<std::int64_t, 3>& dims,
                         const ArrayHeader& header,
                         const std::array<std::int64_t, 3>& chunk,
                         const VolumeWriteOptions& options,
                         bool is_temporal)
    : output_(&output),
      dims_(dims),
      axes_(axes_in_file(dims, is_temporal)),
      type_(header.type),
      components_(header.components),
      is_temporal_(is_temporal),
      chunk_(chunk),
      background_(sample_bytes(header.type, options.background)),
      skips_background_(options.skip_background_chunks) {
  const std::vector<hsize_t> shape = file_shape(dims_, axes_, components_, is_temporal, 0);
  const std::vector<hsize_t> edges = file_shape(chunk_, axes_, components_, is_temporal, 1);
  std::vector<hsize_t> largest = shape;
  if (is_temporal) largest[0] = H5S_UNLIMITED;
  const int rank = static_cast<int>(shape.size());
  const h5::Handle space(H5Screate_simple(rank, shape.data(), largest.data()), H5Sclose);
  const h5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  bool is_good =
      H5Pset_chunk(properties.id(), rank, edges.data()) >= 0 &&
      H5Pset_fill_value(properties.id(), h5::memory_type_of(type_), background_.data()) >= 0;
  if (options.compress > 0) {
    is_good = is_good && H5Pset_shuffle(properties.id()) >= 0 &&
              H5Pset_deflate(properties.id(), static_cast<unsigned>(options.compress)) >= 0;
  }
  if (!is_good) point_data.fail_with_reason("chunks for " + header.name + " cannot be set up");
  dataset_ = h5::create_dataset(point_data, header.name, h5::file_type_of(type_), space.id(),
                                properties.id());
  if (header.nifti) write_fact_attributes(dataset_, *header.nifti);
}

void ArrayWriter::mark_scalars() const {
  h5::write_text_attribute(dataset_, "Attribute", "Scalars");
}

void ArrayWriter::grow(std::int64_t rows) const {
  const std::vector<hsize_t> shape = file_shape(dims_, axes_, components_, true, rows);
  if (H5Dset_extent(dataset_.id(), shape.data()) < 0) dataset_.fail_with_reason("cannot grow");
}

void ArrayWriter::write(const Region& region,
                        const void* samples,
                        std::int64_t row,
                        WrittenFile& written) const {
  Region chunk;
  const auto& begin = chunk.begin;
  for (chunk.begin[2] = region.begin[2]; begin[2] < region.end[2]; chunk.begin[2] += chunk_[2]) {
    for (chunk.begin[1] = region.begin[1]; begin[1] < region.end[1]; chunk.begin[1] += chunk_[1]) {
      for (chunk.begin[0] = region.begin[0]; begin[0] < region.end[0];
           chunk.begin[0] += chunk_[0]) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          chunk.end[axis] = std::min(begin[axis] + chunk_[axis], region.end[axis]);
        }
        ++written.chunks;
        if (skips_background_ && is_background(chunk, region, samples)) {
          ++written.chunks_background;
        } else {
          write_chunk(chunk, region, samples, row);
        }
      }
    }
  }
}

bool ArrayWriter::is_background(const Region& chunk,
                                const Region& region,
                                const void* samples) const {
  const std::size_t sample = background_.size();
  const std::size_t voxel = sample * static_cast<std::size_t>(components_);
  const std::size_t bytes = static_cast<std::size_t>(chunk.end[0] - chunk.begin[0]) * voxel;
  const std::int64_t nx = region.end[0] - region.begin[0], ny = region.end[1] - region.begin[1];
  for (std::int64_t k = chunk.begin[2]; k < chunk.end[2]; ++k) {
    for (std::int64_t j = chunk.begin[1]; j < chunk.end[1]; ++j) {
      const std::int64_t line = (k - region.begin[2]) * ny + (j - region.begin[1]);
      const std::int64_t first = line * nx + (chunk.begin[0] - region.begin[0]);
      const std::byte* at =
          static_cast<const std::byte*>(samples) + static_cast<std::size_t>(first) * voxel;
      // A row is all background when its first sample is and every sample equals the one before.
      if (std::memcmp(at, background_.data(), sample) != 0 ||
          std::memcmp(at, at + sample, bytes - sample) != 0) {
        return false;
      }
    }
  }
  return true;
}

void ArrayWriter::write_chunk(const Region& chunk,
                              const Region& region,
                              const void* samples,
                              std::int64_t row) const {
  // In memory there is an axis at least.
  const std::vector<std::size_t> axes = axes_.empty() ? std::vector<std::size_t>{0} : axes_;
  std::array<std::int64_t, 3> edges, extent, start;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    edges[axis] = chunk.end[axis] - chunk.begin[axis];
    extent[axis] = region.end[axis] - region.begin[axis];
    start[axis] = chunk.begin[axis] - region.begin[axis];
  }
  const std::vector<hsize_t> whole = file_shape(extent, axes, components_, false, 0);
  std::vector<hsize_t> memory_start = file_shape(start, axes, components_, false, 0);
  std::vector<hsize_t> file_start = file_shape(chunk.begin, axes_, components_, is_temporal_, row);
  if (components_ > 1) memory_start.back() = file_start.back() = 0;
  const std::vector<hsize_t> memory_count = file_shape(edges, axes, components_, false, 0);
  const std::vector<hsize_t> file_count = file_shape(edges, axes_, components_, is_temporal_, 1);

  const h5::Handle memory(H5Screate_simple(static_cast<int>(whole.size()), whole.data(), nullptr),
                          H5Sclose);
  const h5::Handle file(H5Dget_space(dataset_.id()), H5Sclose);
  const auto select = [](const h5::Handle& space, const std::vector<hsize_t>& from,
                         const std::vector<hsize_t>& count) {
    return H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, from.data(), nullptr, count.data(),
                               nullptr) >= 0;
  };
  if (!memory || !file || !select(memory, memory_start, memory_count) ||
      !select(file, file_start, file_count) ||
      H5Dwrite(dataset_.id(), h5::memory_type_of(type_), memory.id(), file.id(), H5P_DEFAULT,
               samples) < 0) {
    dataset_.fail_with_reason("cannot be written");
  }
  output_->check_disk(dataset_);
}

}  // namespace tetwarp
