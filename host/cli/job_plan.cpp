/// @file job_plan.cpp
#include "host/cli/job_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "host/cli/array_checks.hpp"
#include "host/cli/declare.hpp"
#include "host/cli/file_checks.hpp"
#include "host/cli/memory_plan.hpp"

namespace tetwarp::cli {

namespace {

namespace fs = std::filesystem;

const std::string order = "the order is: tetwarp warp VOLUME... MESH -o OUT";

std::vector<std::string> inputs_of(const WarpArguments& arguments) {
  std::vector<std::string> inputs = arguments.files;
  if (arguments.mesh.rest_file) inputs.push_back(*arguments.mesh.rest_file);
  if (arguments.grid.base != "same" && arguments.grid.base != "bounds") {
    inputs.push_back(arguments.grid.base);
  }
  return inputs;
}

void check_kinds(const WarpArguments& arguments) {
  for (const std::string& volume : arguments.volumes()) {
    check_kind(volume, FileKind::volume, order);
  }
  check_kind(arguments.mesh_file(), FileKind::mesh, order);
}

/// The arrays to warp: those asked for, else all but this command's own extra outputs.
std::vector<ArrayHeader> choose_arrays(const VolumeHeader& header,
                                       const WarpArguments& arguments,
                                       const std::string& path) {
  std::vector<ArrayHeader> chosen;
  std::vector<std::string> names;
  for (const ArrayHeader& array : header.arrays) {
    names.push_back(array.name);
    if (arguments.arrays.empty() && !array.name.starts_with("tetwarp_")) chosen.push_back(array);
  }
  for (const std::string& name : arguments.arrays) {
    const auto is_named = [&](const ArrayHeader& array) { return array.name == name; };
    const auto found = std::find_if(header.arrays.begin(), header.arrays.end(), is_named);
    if (found == header.arrays.end()) {
      throw IoError(path, name, "no such array; the file has " + listed(names));
    }
    if (std::find_if(chosen.begin(), chosen.end(), is_named) == chosen.end()) {
      chosen.push_back(*found);
    }
  }
  if (chosen.empty()) throw IoError(path, "", "holds no array to warp");
  return chosen;
}

void check_filter(const std::string& path, const ArrayHeader& array, Filter filter) {
  if (filter == Filter::nearest) return;
  const char* const type = name_of(array.type);
  if (filter != Filter::labels && is_integer(array.type) && size_of(array.type) == 8) {
    throw IoError(
        path, array.name,
        fmt::format("{} samples cannot be interpolated; use --filter nearest or labels", type));
  }
  if (filter == Filter::labels && !is_integer(array.type)) {
    throw IoError(
        path, array.name,
        fmt::format("{} samples are no labels; choose others with --array, or a --filter", type));
  }
  if (filter == Filter::labels && array.components != 1) {
    throw IoError(path, array.name,
                  fmt::format("labels have one component, these samples {}; choose others with "
                              "--array, or a --filter",
                              array.components));
  }
}

void check_arrays(const VolumePlan& plan, const WarpArguments& arguments) {
  check_quantities(plan.path, plan.arrays, arguments);
  for (const ArrayHeader& array : plan.arrays) {
    check_filter(plan.path, array, arguments.warp.filter);
    if (is_integer(array.type) && !std::isfinite(arguments.warp.background)) {
      throw IoError(plan.path, array.name,
                    fmt::format("{} samples cannot hold --background {}; give a finite value",
                                name_of(array.type), arguments.warp.background));
    }
    for (const std::size_t e : arguments.extra) {
      if (array.name == extra_outputs[e].array()) {
        throw IoError(plan.path, array.name,
                      "an extra output has this name; leave out one of them");
      }
    }
  }
}

/// True when writing beside the computing of a step saves time: a device computes, or a processor
/// has nothing to do, or deflating keeps a single one busy. Else both would only share processors.
bool leaves_time(Backend backend, const WarpArguments& arguments) {
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  const int threads = arguments.warp.threads > 0 ? arguments.warp.threads : processors;
  return backend != Backend::cpu || threads < processors || arguments.compress > 0;
}

void check_axes(const VolumePlan& plan) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (plan.written_grid.dims[axis] == 1) {
      throw std::invalid_argument(fmt::format(
          "{}: the output has a single voxel along {}, which VTK cannot read; widen --roi, --dims "
          "or the source to two",
          plan.path, "ijk"[axis]));
    }
  }
}

/// One output per step: `output` itself for a single one, else its stem with the step's number.
std::vector<std::string> output_names(const fs::path& output,
                                      const std::vector<std::int64_t>& steps,
                                      bool temporal) {
  if (temporal || steps.size() == 1) return {output.string()};
  std::vector<std::string> names;
  for (const std::int64_t step : steps) {
    fs::path name = output;
    name.replace_filename(
        fmt::format("{}_{:04}{}", output.stem().string(), step, output.extension().string()));
    names.push_back(name.string());
  }
  return names;
}

VolumePlan plan_volume(const std::string& path,
                       const fs::path& output,
                       const WarpArguments& arguments,
                       const MeshReader& mesh,
                       Backend backend,
                       const std::vector<std::int64_t>& steps) {
  const VolumeHeader header = read_volume_header(path);
  const auto step_count = std::max<std::int64_t>(1, std::ssize(header.times));
  if (arguments.source_step >= step_count) {
    throw IoError(path, "",
                  fmt::format("--source-step {} does not exist, the volume has {} (0 to {})",
                              arguments.source_step, step_count, step_count - 1));
  }
  VolumePlan plan;
  plan.path = path;
  plan.arrays = choose_arrays(header, arguments, path);
  plan.source_grid = header.grid;
  check_arrays(plan, arguments);
  plan.output_grid = resolve_grid(arguments.grid, header.grid, mesh, steps);
  plan.written_grid = cut_grid(plan.output_grid, arguments.warp.region);
  check_axes(plan);
  if (arguments.extra.contains(forward_output) && plan.output_grid != plan.source_grid) {
    throw std::invalid_argument(path +
                                ": --outputs forward is on the volume's own grid; leave out "
                                "--grid, --dims, --origin, --spacing and --direction");
  }
  plan.writes_beside =
      plan_memory(plan, arguments) && steps.size() > 1 && leaves_time(backend, arguments);
  // On processors beginning a step is computing it: the write of the one before starts first.
  plan.overlaps = plan.writes_beside && backend != Backend::cpu;
  plan.steps = steps;
  plan.outputs = output_names(output, steps, arguments.temporal);
  return plan;
}

/// The folder for several outputs is there and takes files, or can be made.
void check_folder(const std::string& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) {
    check_output_file(folder, {});
  } else if (!fs::is_directory(folder, error)) {
    throw IoError(folder, "", "is a file; the output of several volumes is a folder");
  } else {
    check_output_folder(folder, folder);
  }
}

/// Every output and the report can be written, and no two of them are one file.
void check_outputs(const JobPlan& plan, const WarpArguments& arguments) {
  if (!plan.output_folder.empty()) check_folder(plan.output_folder);
  std::vector<std::string> outputs = plan.outputs();
  if (!arguments.report.empty()) outputs.push_back(arguments.report);
  std::set<std::string> seen;
  for (const std::string& output : outputs) {
    std::error_code error;
    const bool folder_is_made = !plan.output_folder.empty() && output != arguments.report &&
                                !fs::exists(plan.output_folder, error);
    if (!folder_is_made) check_output_file(output, inputs_of(arguments));
    if (!seen.insert(canonical_path(output)).second) {
      throw IoError(output, "", "would be written twice; give the volumes or outputs other names");
    }
  }
}

}  // namespace

std::vector<std::string> JobPlan::outputs() const {
  std::vector<std::string> all;
  for (const VolumePlan& volume : volumes) {
    all.insert(all.end(), volume.outputs.begin(), volume.outputs.end());
  }
  return all;
}

JobPlan plan_job(const WarpArguments& arguments) {
  check_kinds(arguments);
  const auto [backend, reason] = choose_backend(arguments.warp.backend, arguments.warp.device);
  JobPlan plan{.mesh = MeshReader(arguments.mesh_file(), arguments.mesh),
               .steps = {},
               .backend = backend,
               .backend_reason = reason,
               .output_folder = {},
               .volumes = {}};
  const std::int64_t step_count = std::max<std::int64_t>(1, std::ssize(plan.mesh.header().times));
  try {
    plan.steps = arguments.steps.of(step_count);
  } catch (const std::invalid_argument& error) {
    throw IoError(arguments.mesh_file(), "", error.what());
  }
  const std::vector<std::string> volumes = arguments.volumes();
  const bool several = volumes.size() > 1;
  if (several) plan.output_folder = arguments.output;
  if (!several) check_hdf_name(arguments.output);
  for (const std::string& volume : volumes) {
    const fs::path output = several ? fs::path(arguments.output) / fs::path(volume).filename()
                                    : fs::path(arguments.output);
    plan.volumes.push_back(plan_volume(volume, output, arguments, plan.mesh, backend, plan.steps));
  }
  check_outputs(plan, arguments);
  return plan;
}

}  // namespace tetwarp::cli
