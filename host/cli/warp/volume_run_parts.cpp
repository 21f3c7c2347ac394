/// @file volume_run_parts.cpp
/// A series in one file that can be resumed: each step is first written to a file of its own, which
/// a run that is killed leaves for the next one.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <utility>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/warp/output_files.hpp"
#include "host/cli/warp/volume_run.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;

/// The files of the steps, in a folder beside the output.
std::vector<std::string> part_names(const fs::path& folder,
                                    const std::vector<std::int64_t>& steps) {
  std::vector<std::string> names;
  names.reserve(steps.size());
  for (const std::int64_t step : steps) {
    names.push_back((folder / fmt::format("step_{:04}.vtkhdf", step)).string());
  }
  return names;
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

bool may_resume_within(const VolumePlan& volume, const WarpArguments& arguments) {
  if (!arguments.temporal || !arguments.resume) return false;
  // VTKHDF holds no image of a single slice.
  return std::ranges::find(volume.written_grid.dims, 1) == volume.written_grid.dims.end();
}

void VolumeRun::run_in_parts(const Fingerprint& fingerprint) {
  const std::string& output = volume_.outputs.front();
  const fs::path folder = output + ".steps";
  const std::vector<std::int64_t>& steps = plan_.steps;
  VolumePlan parts = volume_;
  parts.steps = steps;
  parts.outputs = parts.files = part_names(folder, steps);
  WarpArguments arguments = arguments_;
  arguments.temporal = false;
  arguments.compress = 0;
  fs::create_directories(folder);
  // The other run reads the sources itself.
  sources_.clear();
  readers_.clear();
  planner_.reset();
  const std::int64_t written = result_.written, skipped = result_.skipped;
  VolumeRun(arguments, plan_, parts, ranks_, bar_, result_).run();
  result_.written = written;
  result_.skipped = skipped;
  bar_.show_phase("writing");
  const Stopwatch watch;
  begin_file(output, fingerprint, true);
  std::vector<Point3> last;
  for (std::size_t s = 0; s < steps.size(); ++s) {
    stop_if_interrupted();
    const std::int64_t number = steps[s];
    std::vector<Point3> positions = plan_.mesh.read_step(number);
    const double time = plan_.mesh.header().times[static_cast<std::size_t>(number)];
    const bool is_same_source =
        s > 0 && arguments_.source_step_of(number) == arguments_.source_step_of(steps[s - 1]);
    if (arguments_.warp.skip.unchanged_steps && is_same_source && positions == last) {
      writer_->repeat_step(time);
    } else {
      writer_->begin_step(time);
      copy_part(parts.outputs[s]);
    }
    last = std::move(positions);
  }
  stop_if_interrupted();
  result_.report.counts += counts_of(writer_->finish());
  writer_.reset();
  result_.report.timings.write += watch.seconds();
  result_.written += files_per_output();
  std::error_code ignored;
  for (const std::string& part : parts.outputs) fs::remove(part, ignored);
  fs::remove(folder, ignored);
}

/// Copies the arrays of the file of a step to the series.
void VolumeRun::copy_part(const std::string& part) {
  for (std::size_t a = 0; a < outputs_.size(); ++a) {
    const VolumeReader reader(part, outputs_[a].name);
    for (const Region& piece : pieces_of(volume_.written_grid, outputs_, is_whole_)) {
      stop_if_interrupted();
      const auto samples =
          std::make_unique_for_overwrite<std::byte[]>(bytes_of(outputs_[a], piece));
      reader.read(piece, samples.get());
      writer_->write(a, piece, samples.get());
    }
  }
}

}  // namespace tetwarp::cli
