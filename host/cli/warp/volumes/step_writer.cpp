/// @file step_writer.cpp
/// Begins, fills and ends the files of steps.
#include "host/cli/warp/volumes/step_writer.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/job/output_files.hpp"

namespace tetwarp::cli {
namespace {
/// A region in the indices of a grid whose voxel 0 is voxel `origin` of the region's grid.
Region moved(const Region& region, const std::array<std::int64_t, 3>& origin) {
  Region moved = region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    moved.begin[axis] -= origin[axis];
    moved.end[axis] -= origin[axis];
  }
  return moved;
}

/// The whole grid, or the bricks in which blocks are stored.
std::vector<Region> pieces_of(const Grid& grid,
                              const std::vector<ArrayHeader>& arrays,
                              bool is_whole) {
  if (is_whole) return {Region{{0, 0, 0}, grid.dims}};
  const std::array<std::int64_t, 3> edge = block_step(grid, arrays);
  std::vector<Region> pieces;
  std::array<std::int64_t, 3> at{};
  for (at[2] = 0; at[2] < grid.dims[2]; at[2] += edge[2]) {
    for (at[1] = 0; at[1] < grid.dims[1]; at[1] += edge[1]) {
      for (at[0] = 0; at[0] < grid.dims[0]; at[0] += edge[0]) {
        Region piece{at, at};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          piece.end[axis] = std::min(at[axis] + edge[axis], grid.dims[axis]);
        }
        pieces.push_back(piece);
      }
    }
  }
  return pieces;
}
}  // namespace

void StepWriter::begin_file(const std::string& output,
                            const Fingerprint& fingerprint,
                            bool is_temporal) {
  file_.emplace(output, task_.volume.written_grid, task_.outputs,
                write_options(task_.arguments, task_.volume, fingerprint), is_temporal,
                task_.volume.changing_arrays(),
                task_.is_whole ? ChunkShape::rows : ChunkShape::bricks);
}

void StepWriter::write(const VolumePart& part) {
  const Stopwatch watch;
  VolumeStep& step = *part.step;
  const bool has_own_file = !step.output.empty();
  if (part.is_first && has_own_file) {
    begin_file(step.output, step.fingerprint, false);
  } else if (part.is_first && step.is_repeat) {
    file_->repeat_step(step.time);
  } else if (part.is_first) {
    file_->begin_step(step.time);
  }
  const Region region = moved(part.region, task_.region.begin);
  for (std::size_t a = 0; !step.is_repeat && a < task_.outputs.size(); ++a) {
    file_->write(a, region, (*part.outputs)[a].get());
  }
  if (part.is_last && has_own_file) step.written = finish();
  step.write_seconds += watch.seconds();
}

void StepWriter::copy_step(double time, const std::string& path) {
  file_->begin_step(time);
  const std::vector<Region> pieces =
      pieces_of(task_.volume.written_grid, task_.outputs, task_.is_whole);
  for (std::size_t a = 0; a < task_.outputs.size(); ++a) {
    const VolumeReader reader(path, task_.outputs[a].name);
    for (const Region& piece : pieces) {
      stop_if_interrupted();
      const Samples samples = make_samples({task_.outputs[a]}, piece);
      reader.read(piece, samples.front().get());
      file_->write(a, piece, samples.front().get());
    }
  }
}

Counts StepWriter::finish() {
  const Counts counts = counts_of(file_->finish());
  file_.reset();
  return counts;
}

}  // namespace tetwarp::cli
