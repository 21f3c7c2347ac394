/// @file transform_job.cpp
/// Reads the transform and the volume, resamples and writes step by step.
#include "host/cli/warp/transform_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/resample.hpp>
#include <tetwarp/transform_file.hpp>
#include <variant>
#include <vector>

#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/progress_bar.hpp"
#include "host/cli/job/array_checks.hpp"
#include "host/cli/job/output_grid.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/warnings.hpp"

namespace tetwarp::cli {
namespace {
const std::string order = "the order is: tetwarp warp IMAGE FIELD -o OUT";

/// Throws std::invalid_argument for options that have no meaning without a mesh.
void check_options(const WarpArguments& arguments, const CLI::App& command) {
  const std::set<std::string> known{"--output",    "--array",   "--source-step", "--axes",
                                    "--fsl",       "--grid",    "--like",        "--dims",
                                    "--origin",    "--spacing", "--direction",   "--filter",
                                    "--overshoot", "--outside", "--background",  "--compress",
                                    "--threads",   "--quiet",   "--backend",     "--series"};
  for (const CLI::Option* const option : command.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || name == "FILES" || known.contains(name)) continue;
    throw std::invalid_argument(name + " is for warps by a mesh; leave it out");
  }
  if (arguments.files.size() != 2) {
    throw std::invalid_argument("a transform resamples one image at a time; " + order);
  }
  if (arguments.warp.backend == Backend::cuda || arguments.warp.backend == Backend::reference) {
    throw std::invalid_argument("--backend: transforms run on cpu; leave it out");
  }
  if (extends(arguments.warp.outside)) {
    throw std::invalid_argument(std::string("--outside ") + name_of(arguments.warp.outside) +
                                " is for warps by a mesh; use background or identity");
  }
  if (arguments.grid.base == "bounds") {
    throw std::invalid_argument("--grid bounds is for warps by a mesh; name a volume instead");
  }
}

ResampleOptions resample_options(const WarpArguments& arguments, const CLI::App& command) {
  ResampleOptions options;
  options.filter = arguments.warp.filter;
  options.overshoot = arguments.warp.overshoot;
  options.background = arguments.warp.background;
  options.threads = arguments.warp.threads;
  options.only_in_field =
      command.count("--outside") > 0 && arguments.warp.outside == Outside::background;
  return options;
}

/// The volume to resample.
struct Source {
  VolumeReadOptions read;
  VolumeHeader header;
  std::vector<ArrayHeader> arrays;
  std::vector<std::int64_t> steps;
  bool is_series = false;
};

Source open_source(const WarpArguments& arguments) {
  const std::string& path = arguments.files.front();
  Source source;
  source.read.are_labels = arguments.warp.filter == Filter::labels;
  source.read.series = arguments.series;
  source.header = read_volume_header(path, source.read);
  source.arrays = choose_arrays(source.header, arguments, path);
  check_arrays(path, source.header.grid, source.arrays, arguments);
  const auto count = std::max<std::int64_t>(1, std::ssize(source.header.times));
  if (arguments.source_step && *arguments.source_step >= count) {
    throw IoError(path, "",
                  fmt::format("--source-step {} does not exist, the volume has {} (0 to {})",
                              *arguments.source_step, count, count - 1));
  }
  source.is_series = count > 1 && !arguments.source_step;
  const std::int64_t first = arguments.source_step.value_or(0);
  for (std::int64_t step = first; step < (source.is_series ? count : first + 1); ++step) {
    source.steps.push_back(step);
  }
  return source;
}

/// Resamples the arrays of a step.
void write_step(const WarpArguments& arguments,
                const Source& source,
                std::int64_t step,
                const Transform& transform,
                const ResampleOptions& options,
                OutputWriter& writer,
                ProgressBar& bar) {
  const Grid& output = *options.output_grid;
  for (std::size_t a = 0; a < source.arrays.size(); ++a) {
    const Volume volume =
        read_volume(arguments.files.front(), source.arrays[a].name, step, source.read);
    stop_if_interrupted();
    Volume result = make_volume(output, volume.type, volume.components, volume.name);
    const VolumeView view(volume);
    void* const data = result.data.data();
    const auto share = static_cast<double>(source.arrays.size());
    resample(std::span(&view, 1), transform, options, std::span(&data, 1), [&](double fraction) {
      const double done = (static_cast<double>(a) + fraction) / share;
      bar.update(done, done * static_cast<double>(output.voxel_count()));
      return !is_interrupted();
    });
    writer.write(a, {{0, 0, 0}, output.dims}, data);
  }
  bar.finish_step();
}
}  // namespace

bool names_transform(const WarpArguments& arguments) {
  const std::string& last = arguments.files.back();
  std::error_code error;
  if (!std::filesystem::exists(last, error)) return false;
  if (arguments.fsl && kind_of(last) != FileKind::nifti) {
    throw IoError(last, "", "is no NIfTI image; --fsl is for warp fields of FSL");
  }
  return is_transform_file(last, arguments.transform_options());
}

void run_transform_job(const WarpArguments& arguments, const CLI::App& command) {
  check_options(arguments, command);
  const std::string& path = arguments.files.front();
  check_volume(path, order);
  check_series(arguments.series, {path});
  check_volume_name(arguments.output);
  std::vector<std::string> inputs = arguments.files;
  if (arguments.grid.base != "same") inputs.push_back(arguments.grid.base);
  const Source source = open_source(arguments);
  ResampleOptions options = resample_options(arguments, command);
  options.output_grid = resolve_grid(arguments.grid, source.header.grid, Mesh{}, {});
  for (const std::string& file : files_of_output(arguments.output, source.arrays)) {
    check_output_file(file, inputs);
  }
  const TransformFile file = read_transform(arguments.files.back(), arguments.transform_options());
  if (file.ends_with_field && command.count("--outside") == 0) options.only_in_field = true;
  const InterruptFlag flag;
  ProgressBar bar(!arguments.quiet, "warp", source.steps.size());
  OutputWriter writer(arguments.output, *options.output_grid, source.arrays,
                      {.compress = arguments.compress,
                       .background = arguments.warp.background,
                       .scalars = source.header.active},
                      source.is_series, source.arrays.size(), ChunkShape::rows);
  for (const std::int64_t step : source.steps) {
    if (source.is_series) {
      writer.begin_step(source.header.times[static_cast<std::size_t>(step)]);
    }
    write_step(arguments, source, step, file.transform, options, writer, bar);
  }
  writer.finish();
  print_notes(path, source.header.notes);
  std::vector<std::string> lost = source.header.not_read;
  lost.insert(lost.end(), source.header.left_out.begin(), source.header.left_out.end());
  if (!lost.empty()) {
    fmt::print(stderr, "tetwarp: {}: left out: {}\n", path, one_line(listed(lost)));
  }
  if (arguments.quiet) return;
  const Grid& grid = *options.output_grid;
  fmt::print("{} x {} x {} voxels{} by {}: {}\n", grid.dims[0], grid.dims[1], grid.dims[2],
             source.is_series ? fmt::format(", {} steps", source.steps.size()) : "",
             file.convention, arguments.output);
}

}  // namespace tetwarp::cli
