/// @file vtkhdf_write.cpp
/// Writing VTKHDF ImageData: whole volumes, step by step, block by block.
#include <algorithm>
#include <array>
#include <stdexcept>
#include <tetwarp/io.hpp>

#include "io/files/sink_checks.hpp"
#include "io/image/image_write.hpp"
#include "io/image/vti_write.hpp"
#include "io/nifti/nifti_write.hpp"
#include "io/vtkhdf/vtkhdf_image.hpp"

namespace tetwarp {
namespace {
using Edges = std::array<std::int64_t, 3>;

std::int64_t voxel_bytes(const ArrayHeader& array) {
  return array.components * static_cast<std::int64_t>(size_of(array.type));
}

std::vector<Edges> row_chunks(const Grid& grid, const std::vector<ArrayHeader>& arrays) {
  std::vector<Edges> chunks;
  chunks.reserve(arrays.size());
  for (const ArrayHeader& array : arrays)
    chunks.push_back(row_chunk(grid.dims, voxel_bytes(array)));
  return chunks;
}

std::vector<ArrayHeader> headers_of(const std::string& path,
                                    const std::vector<const Volume*>& volumes) {
  std::vector<ArrayHeader> headers;
  for (const Volume* volume : volumes) {
    if (volume == nullptr) throw IoError(path, "", "a volume to write is null");
    const auto refuse = [&](const std::string& problem) {
      throw IoError(path, "/VTKHDF/PointData/" + volume->name, problem);
    };
    if (volume->grid != volumes.front()->grid) {
      refuse("has another grid than '" + volumes.front()->name + "', write it to another file");
    }
    try {
      check_grid(volume->grid, "grid");
      static_cast<void>(VolumeView(*volume));  // checks that the samples fill the grid
    } catch (const std::invalid_argument& error) {
      refuse(error.what());
    }
    headers.push_back({volume->name, volume->type, volume->components});
  }
  return headers;
}

/// A file for whole volumes.
std::unique_ptr<ImageFile> create_image(const std::string& path,
                                        const std::vector<const Volume*>& volumes,
                                        const VolumeWriteOptions& options,
                                        bool is_temporal) {
  const std::vector<ArrayHeader> headers = headers_of(path, volumes);
  const Grid grid = volumes.empty() ? Grid{} : volumes.front()->grid;
  return std::make_unique<ImageFile>(path, grid, headers, row_chunks(grid, headers), options,
                                     is_temporal);
}

void write_all(ImageFile& file, const std::vector<const Volume*>& volumes) {
  for (std::size_t array = 0; array < volumes.size(); ++array) {
    file.write(array, {{0, 0, 0}, file.grid().dims}, volumes[array]->data.data());
  }
}
}  // namespace

WrittenFile write_volumes(const std::string& path,
                          const std::vector<const Volume*>& volumes,
                          const VolumeWriteOptions& options) {
  const h5::Silence silence;
  const std::unique_ptr<ImageFile> file = create_image(path, volumes, options, false);
  write_all(*file, volumes);
  return file->finish();
}

struct TemporalVolumeWriter::State {
  std::string path;
  VolumeWriteOptions options;
  std::unique_ptr<ImageFile> file;  // created by the first step, which defines the arrays
};

TemporalVolumeWriter::TemporalVolumeWriter(const std::string& path,
                                           const VolumeWriteOptions& options)
    : state_(std::make_unique<State>(State{path, options, {}})) {
  check_compression(path, options);
}

TemporalVolumeWriter::TemporalVolumeWriter(TemporalVolumeWriter&&) noexcept = default;

TemporalVolumeWriter::~TemporalVolumeWriter() {
  const h5::Silence silence;
  state_.reset();
}

void TemporalVolumeWriter::append(double time, const std::vector<const Volume*>& volumes) {
  const h5::Silence silence;
  State& state = *state_;
  if (!state.file) state.file = create_image(state.path, volumes, state.options, true);
  const std::vector<ArrayHeader> headers = headers_of(state.path, volumes);
  const std::vector<ArrayHeader>& arrays = state.file->arrays();
  if (headers.size() != arrays.size()) {
    throw IoError(state.path, "",
                  "a step has " + std::to_string(headers.size()) + " arrays, the first step has " +
                      std::to_string(arrays.size()));
  }
  for (std::size_t array = 0; array < arrays.size(); ++array) {
    if (headers[array] != arrays[array] || volumes[array]->grid != state.file->grid()) {
      throw IoError(state.path, "/VTKHDF/PointData/" + headers[array].name,
                    "name, grid, type or components differ from the first step's");
    }
  }
  check_time(state.path, time);
  state.file->begin_step(time);
  write_all(*state.file, volumes);
}

void TemporalVolumeWriter::repeat(double time) {
  if (!state_->file) throw IoError(state_->path, "", "no step to repeat");
  check_time(state_->path, time);
  state_->file->repeat_step(time);
}

WrittenFile TemporalVolumeWriter::finish() {
  const h5::Silence silence;
  if (!state_->file) throw IoError(state_->path, "", "no step was written");
  return state_->file->finish();
}

struct BlockVolumeWriter::State {
  std::string path;
  std::unique_ptr<VolumeSink> file;
};

BlockVolumeWriter::BlockVolumeWriter(const std::string& path,
                                     const Grid& grid,
                                     const std::vector<ArrayHeader>& arrays,
                                     const VolumeWriteOptions& options,
                                     bool is_temporal,
                                     ChunkShape chunks) {
  const h5::Silence silence;
  if (has_nifti_name(path)) {
    check_compression(path, options);
    state_.reset(new State{path, make_nifti_sink(path, grid, arrays, options, is_temporal)});
    return;
  }
  if (has_image_name(path)) {
    check_compression(path, options);
    state_.reset(new State{path, make_image_sink(path, grid, arrays, options, is_temporal)});
    return;
  }
  if (has_vtk_image_name(path)) {
    state_.reset(new State{path, make_vti_sink(path, grid, arrays, options, is_temporal)});
    return;
  }
  const std::vector<Edges> edges =
      chunks == ChunkShape::rows ? row_chunks(grid, arrays)
                                 : std::vector<Edges>(arrays.size(), block_step(grid, arrays));
  state_.reset(new State{
      path, std::make_unique<ImageFile>(path, grid, arrays, edges, options, is_temporal)});
}

BlockVolumeWriter::BlockVolumeWriter(BlockVolumeWriter&&) noexcept = default;

BlockVolumeWriter::~BlockVolumeWriter() {
  const h5::Silence silence;
  state_.reset();
}

void BlockVolumeWriter::begin_step(double time) {
  const h5::Silence silence;
  check_time(state_->path, time);
  state_->file->begin_step(time);
}

void BlockVolumeWriter::repeat_step(double time) {
  const h5::Silence silence;
  check_time(state_->path, time);
  state_->file->repeat_step(time);
}

void BlockVolumeWriter::write(std::size_t array, const Region& region, const void* samples) {
  const h5::Silence silence;
  state_->file->write(array, region, samples);
}

WrittenFile BlockVolumeWriter::finish() {
  const h5::Silence silence;
  return state_->file->finish();
}

std::array<std::int64_t, 3> block_step(const Grid& grid, const std::vector<ArrayHeader>& arrays) {
  std::int64_t largest = 1;
  for (const ArrayHeader& array : arrays) largest = std::max(largest, voxel_bytes(array));
  return brick_chunk(grid.dims, largest);
}

}  // namespace tetwarp
