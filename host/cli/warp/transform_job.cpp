/// @file transform_job.cpp
/// Checks the arguments of a warp by a transform, and runs it.
#include "host/cli/warp/transform_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/itk_space.hpp>
#include <tetwarp/resample.hpp>
#include <tetwarp/transform_file.hpp>
#include <tetwarp/version.hpp>
#include <vector>

#include "host/base/parallel.hpp"
#include "host/base/stopwatch.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/job/array_checks.hpp"
#include "host/cli/job/output_grid.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/provenance.hpp"
#include "host/cli/job/warnings.hpp"
#include "host/cli/warp/transform_run.hpp"
#include "host/cli/warp/warp_job.hpp"
#include "io/files/finished_file.hpp"

namespace tetwarp::cli {
namespace {
const std::string order = "the order is: tetwarp warp IMAGE FIELD -o OUT";

/// Throws std::invalid_argument for options that have no meaning without a mesh.
void check_options(const WarpArguments& arguments) {
  const bool has_steps =
      transform_step_count(arguments.files.back(), arguments.transform_options()) > 1;
  for (const auto& [name, values] : arguments.given) {
    if (name == "steps" && has_steps) continue;
    const std::string refusal = transform_refusal(name, values, arguments.provenance);
    if (!refusal.empty()) throw std::invalid_argument(refusal);
  }
  if (arguments.files.size() != 2) {
    throw std::invalid_argument("a transform resamples one image at a time; " + order);
  }
  const std::string axes = arguments.axes ? axes_refusal(arguments.files.back()) : "";
  if (!axes.empty()) throw std::invalid_argument(axes);
}

bool is_given(const WarpArguments& arguments, const std::string& option) {
  return std::ranges::any_of(arguments.given, [&](const auto& one) { return one.first == option; });
}

ResampleOptions resample_options(const WarpArguments& arguments) {
  ResampleOptions options;
  options.filter = arguments.warp.filter;
  options.label_rule = arguments.warp.label_rule;
  options.label_gaussian = arguments.warp.label_gaussian;
  options.overshoot = arguments.warp.overshoot;
  options.background = arguments.warp.background;
  options.threads = arguments.warp.threads;
  options.only_in_field =
      is_given(arguments, "outside") && arguments.warp.outside == Outside::background;
  return options;
}

TransformSource open_source(const WarpArguments& arguments) {
  const std::string& path = arguments.files.front();
  TransformSource source;
  source.read.are_labels = arguments.warp.filter == Filter::labels;
  source.read.series = arguments.series;
  source.header = read_volume_header(path, source.read);
  source.arrays = choose_arrays(source.header, arguments, path);
  check_arrays(path, source.header, source.arrays, arguments);
  source.world = itk_factor(path, source.header);
  if (!source.world) take_base_facts(arguments.grid, source.arrays);
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

/// What a job reads, all arguments checked.
TransformSource checked_source(const WarpArguments& arguments) {
  check_options(arguments);
  const std::string& path = arguments.files.front();
  check_volume(path, order);
  check_series(arguments.series, {path});
  check_volume_name(arguments.output);
  return open_source(arguments);
}

/// What the source and the output lose, as of a warp by a mesh.
void add_losses(const WarpArguments& arguments,
                const TransformSource& source,
                const Grid& grid,
                const JobContext& context,
                JobResult& result) {
  const std::string& path = arguments.files.front();
  Warnings warnings = volume_warnings(path, source.header, MeshHeader{}, arguments);
  append(warnings, array_warnings(path, source.arrays, arguments));
  if (source.is_series) {
    const std::string warning = times_warning(arguments.output, source.header.times);
    if (!warning.empty()) warnings.push_back(warning);
  }
  if (arguments.strict) refuse_warnings(warnings);
  add_warnings(warnings, context, result);
  VolumeReadOptions as_stored = source.read;
  as_stored.are_labels = false;
  Warnings notes = volume_notes(path, source.header, arguments);
  append(notes, label_notes(path, read_volume_header(path, as_stored), source.arrays));
  append(notes, slice_notes(arguments.output, grid, source.arrays));
  add_notes(notes, context, result);
}

/// Resamples all steps, or plans them with --dry-run.
void resample_source(const WarpArguments& arguments,
                     const TransformSource& source,
                     const ResampleOptions& options,
                     const JobContext& context,
                     JobResult& result) {
  const Grid& grid = *options.output_grid;
  TransformRun run(arguments, source, options);
  if (arguments.dry_run) return run.plan(result);
  run.run(context, result);
  result.steps = fmt::format(
      "{} x {} x {} voxels{} by {}", grid.dims[0], grid.dims[1], grid.dims[2],
      source.is_series ? fmt::format(", {} steps", source.steps.size()) : "", run.convention());
}
}  // namespace

std::string transform_refusal(const std::string& option,
                              const std::vector<std::string>& values,
                              bool has_provenance) {
  static const std::set<std::string> known{
      "output",     "array",    "source-step", "axes",       "fsl",     "grid",      "like",
      "dims",       "origin",   "spacing",     "direction",  "filter",  "overshoot", "outside",
      "background", "compress", "threads",     "quiet",      "backend", "series",    "like-series",
      "label-rule", "report",   "dry-run",     "provenance", "resume",  "memory",    "strict"};
  const std::string value = values.empty() ? "" : values.front();
  const std::string for_meshes = "--" + option + " " + value + " is for warps by a mesh; ";
  if (!known.contains(option)) return "--" + option + " is for warps by a mesh; leave it out";
  if (option == "resume" && !has_provenance) {
    return "--resume of a warp by a transform needs --provenance; add it";
  }
  if (option == "backend" && value != name_of(Backend::automatic) &&
      value != name_of(Backend::cpu)) {
    return "--backend: transforms run on cpu; leave it out";
  }
  if (option == "outside" && value != name_of(Outside::background) &&
      value != name_of(Outside::identity)) {
    return for_meshes + "use background or identity";
  }
  if (option == "grid" && value == "bounds") return for_meshes + "name a volume instead";
  if (option == "label-rule" && value == name_of(LabelRule::volume)) {
    return for_meshes + "use linear or gaussian";
  }
  return {};
}

std::string axes_refusal(const std::string& transform) {
  const FileKind kind = kind_of(transform);
  if (kind == FileKind::nifti || kind == FileKind::image) return {};
  return transform +
         (kind == FileKind::volume ? ": is a VTKHDF field, which is not turned"
                                   : ": is a transform of ITK, which is along LPS axes") +
         "; leave out --axes";
}

bool names_transform(const WarpArguments& arguments) {
  const std::string& last = arguments.files.back();
  std::error_code error;
  if (!std::filesystem::exists(last, error)) return false;
  if (arguments.fsl && kind_of(last) != FileKind::nifti) {
    throw IoError(last, "", "is no NIfTI image; --fsl is for warp fields of FSL");
  }
  return is_transform_file(last, arguments.transform_options());
}

std::vector<std::string> transform_job_files(const WarpArguments& arguments) {
  return files_of_output(arguments.output, open_source(arguments).arrays);
}

JobResult run_transform_job(const WarpArguments& arguments, const JobContext& context) {
  const InterruptFlag interrupts_set_a_flag;
  const Stopwatch watch;
  const TransformSource source = checked_source(arguments);
  ResampleOptions options = resample_options(arguments);
  options.output_grid = resolve_grid(arguments.grid, source.header.grid, source.world, Mesh{}, {});
  const std::vector<std::string> files = files_of_output(arguments.output, source.arrays);
  check_output_files(files_to_write(arguments, files), arguments.inputs());
  check_compress({arguments.output}, arguments.compress);
  check_output_arrays(arguments.output, *options.output_grid, source.arrays,
                      {.compress = arguments.compress}, source.is_series);
  JobResult result;
  result.outputs = {arguments.output};
  result.report.version = TETWARP_VERSION;
  result.report.backend = Backend::cpu;
  result.report.backend_reason = "transforms run on cpu";
  result.report.threads = thread_count(arguments.warp.threads);
  add_losses(arguments, source, *options.output_grid, context, result);
  const InputFacts inputs = input_facts(arguments);
  const bool keeps = arguments.resume && !arguments.dry_run &&
                     provenance_state(arguments, inputs, files) == ProvenanceState::agrees;
  if (keeps) {
    result.skipped = 1;
  } else {
    resample_source(arguments, source, options, context, result);
  }
  result.report.timings.total = watch.seconds();
  if (!keeps) write_provenance(arguments, inputs, files, result);
  if (!arguments.report.empty()) {
    write_finished_file(arguments.report, report_json(result) + "\n");
  }
  return result;
}

std::string transform_summary(const WarpArguments& arguments, const JobResult& result) {
  if (!result.plans.empty() || result.skipped > 0) return summary(result);
  return fmt::format("{}: {}\n", result.steps, arguments.output);
}

}  // namespace tetwarp::cli
