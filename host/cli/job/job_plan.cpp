/// @file job_plan.cpp
/// Reads all headers, checks all arguments and names all outputs.
#include "host/cli/job/job_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "host/base/region_grid.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/job/array_checks.hpp"
#include "host/cli/job/memory_plan.hpp"
#include "host/cli/job/output_writer.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;

constexpr int symmetric_intent = 1005;  // NIfTI's SYMMATRIX

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
    check_volume(volume, order);
  }
  check_mesh(arguments.mesh_file(), order);
}

/// True when --axes lps turns the components of an array, as it does those of meshes.
bool is_turned(const ArrayHeader& array) {
  const bool is_tensor = array.components == 6 && array.nifti->intent_code == symmetric_intent;
  return !is_integer(array.type) && (array.components == 3 || array.components == 9 || is_tensor);
}

/// How a volume is read: --axes applies if it is a NIfTI image of vectors or tensors.
VolumeReadOptions read_options(const std::string& path,
                               const WarpArguments& arguments,
                               const fs::path& output) {
  VolumeReadOptions options;
  options.scratch = output.string();
  if (arguments.axes == Axes::lps && kind_of(path) == FileKind::nifti &&
      is_turned(read_volume_header(path).arrays.front())) {
    options.axes = Axes::lps;
  }
  return options;
}

/// Throws IoError when --axes lps turns nothing.
void check_axes_turn(const JobPlan& plan, const WarpArguments& arguments) {
  if (arguments.axes != Axes::lps) return;
  const auto is_vtkhdf = [](const std::string& path) { return kind_of(path) == FileKind::mesh; };
  const auto turns = [](const VolumePlan& volume) { return volume.read.axes == Axes::lps; };
  const std::optional<std::string>& rest = arguments.mesh.rest_file;
  if (!is_vtkhdf(arguments.mesh_file()) || (rest && !is_vtkhdf(*rest)) ||
      std::ranges::any_of(plan.volumes, turns)) {
    return;
  }
  throw std::invalid_argument(
      "--axes lps turns nothing: it is for meshes in .msh, .vtu and .vtk and for vectors and "
      "tensors "
      "in NIfTI images; leave it out");
}

/// The arrays to warp: those of --array, else all except extra outputs of an earlier warp.
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

/// Checks that the volume has the steps that are to be warped.
void check_source_steps(const std::string& path,
                        const VolumeHeader& header,
                        const WarpArguments& arguments,
                        const std::vector<std::int64_t>& steps) {
  const auto count = std::max<std::int64_t>(1, std::ssize(header.times));
  const std::int64_t last = arguments.source_step_of(steps.back());
  if (last < count) return;
  throw IoError(path, "",
                arguments.pair
                    ? fmt::format("--pair: step {} of the mesh has no pair, the volume has {} (0 "
                                  "to {}); choose steps of the mesh with --steps",
                                  last, count, count - 1)
                    : fmt::format("--source-step {} does not exist, the volume has {} (0 to {})",
                                  last, count, count - 1));
}

/// True when writing a step while the next one is computed saves time: on a device, with fewer
/// threads than processors, or with compression, which uses one thread.
bool leaves_time(Backend backend, const WarpArguments& arguments) {
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  const int threads = arguments.warp.threads > 0 ? arguments.warp.threads : processors;
  return backend != Backend::cpu || threads < processors || arguments.compress > 0;
}

/// Throws std::invalid_argument when VTKHDF cannot hold the output.
void check_flat(const VolumePlan& plan, const fs::path& output) {
  if (has_nifti_name(output.string())) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (plan.written_grid.dims[axis] == 1) {
      throw std::invalid_argument(
          fmt::format("{}: the output has a single voxel along {}, which VTK cannot read; write "
                      "NIfTI (.nii.gz) "
                      "or widen --roi, --dims or the source to two",
                      plan.path, "ijk"[axis]));
    }
  }
}

/// One file per step: `output` for a single file, else its stem with the number of the step.
std::vector<std::string> output_names(const fs::path& output,
                                      const std::vector<std::int64_t>& steps,
                                      bool temporal) {
  if (temporal || steps.size() == 1) return {output.string()};
  std::vector<std::string> names;
  for (const std::int64_t step : steps) {
    const SplitName name = split_name(output.string());
    names.push_back(fmt::format("{}_{:04}{}", name.stem, step, name.extension));
  }
  return names;
}

/// Sets steps and names of outputs, and warns of times that the output does not keep.
void set_outputs(VolumePlan& plan,
                 const fs::path& output,
                 const WarpArguments& arguments,
                 const MeshReader& mesh,
                 const std::vector<std::int64_t>& steps) {
  plan.steps = steps;
  plan.outputs = output_names(output, steps, arguments.temporal);
  for (const std::string& name : plan.outputs) {
    const std::vector<std::string> files = files_of_output(name, arrays_written(plan, arguments));
    plan.files.insert(plan.files.end(), files.begin(), files.end());
  }
  if (arguments.temporal) {
    std::vector<double> times;
    times.reserve(steps.size());
    for (const std::int64_t step : steps) {
      times.push_back(mesh.header().times[static_cast<std::size_t>(step)]);
    }
    const std::string warning = times_warning(output.string(), times);
    if (!warning.empty()) plan.warnings.push_back(warning);
  }
}

VolumePlan plan_volume(const std::string& path,
                       const fs::path& output,
                       const WarpArguments& arguments,
                       const MeshReader& mesh,
                       Backend backend,
                       const std::vector<std::int64_t>& steps) {
  VolumePlan plan;
  plan.path = path;
  plan.read = read_options(path, arguments, output);
  const VolumeHeader header = read_volume_header(path, plan.read);
  check_source_steps(path, header, arguments, steps);
  plan.arrays = choose_arrays(header, arguments, path);
  plan.active = header.active;
  plan.source_grid = header.grid;
  check_arrays(path, plan.source_grid, plan.arrays, arguments);
  plan.warnings = volume_warnings(path, header, mesh.header(), arguments);
  const Warnings more = array_warnings(path, plan.arrays, arguments);
  plan.warnings.insert(plan.warnings.end(), more.begin(), more.end());
  plan.output_grid = resolve_grid(arguments.grid, header.grid, mesh, steps);
  try {
    const Region region = checked_region(plan.output_grid, arguments.warp.region);
    plan.written_grid = grid_of_region(plan.output_grid, region);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "", fmt::format("--roi: {}", error.what()));
  }
  check_flat(plan, output);
  if (arguments.extra.contains(forward_output) && plan.output_grid != plan.source_grid) {
    throw std::invalid_argument(path +
                                ": --outputs forward is on the volume's own grid; leave out "
                                "--grid, --dims, --origin, --spacing and --direction");
  }
  plan.writes_beside = plan_memory(plan, arguments, mesh, steps) && steps.size() > 1 &&
                       leaves_time(backend, arguments);
  // On the cpu begin_step() computes the step: the previous one is finished and written first.
  plan.overlaps = plan.writes_beside && backend != Backend::cpu;
  set_outputs(plan, output, arguments, mesh, steps);
  return plan;
}

/// The name of an output in a folder: that of its volume. A pair .hdr and .img becomes one file
/// .nii.gz.
std::string output_name_of(const std::string& volume) {
  std::string name = fs::path(volume).filename().string();
  for (const std::string end : {".hdr", ".hdr.gz", ".img", ".img.gz"}) {
    if (name.ends_with(end)) return name.substr(0, name.size() - end.size()) + ".nii.gz";
  }
  check_volume_name(name);
  return name;
}

/// Checks that the folder of the outputs can be written to, or made.
/// @param makes_parents  the folders above it, too
void check_folder(const std::string& folder, bool makes_parents) {
  std::error_code error;
  if (!fs::exists(folder, error)) {
    makes_parents ? check_new_folder(folder, folder) : check_output_file(folder, {});
  } else if (!fs::is_directory(folder, error)) {
    throw IoError(folder, "", "is a file; the output of several volumes is a folder");
  } else {
    check_output_folder(folder, folder);
  }
}

/// Checks that outputs and report can be written and that no two of them are the same file.
void check_outputs(const JobPlan& plan, const WarpArguments& arguments) {
  const fs::path folder = plan.output_folder;
  if (!folder.empty()) check_folder(folder.string(), arguments.makes_folder);
  std::vector<std::string> outputs = plan.outputs();
  if (!arguments.report.empty()) outputs.push_back(arguments.report);
  std::set<std::string> seen;
  for (const std::string& output : outputs) {
    std::error_code error;
    const bool is_in_folder =
        output != arguments.report || fs::path(output).parent_path() == folder;
    const bool folder_is_made = !folder.empty() && is_in_folder && !fs::exists(folder, error);
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
    all.insert(all.end(), volume.files.begin(), volume.files.end());
  }
  return all;
}

bool may_resume_within(const VolumePlan& volume, const WarpArguments& arguments) {
  if (!arguments.temporal || !arguments.resume) return false;
  // VTKHDF holds no image of a single slice.
  return std::ranges::find(volume.written_grid.dims, 1) == volume.written_grid.dims.end();
}

JobPlan plan_job(const WarpArguments& arguments) {
  check_kinds(arguments);
  const auto [backend, reason] = choose_backend(arguments.warp.backend, arguments.warp.device);
  MeshReadOptions mesh_options = arguments.mesh;
  mesh_options.import.axes = arguments.axes.value_or(Axes::ras);
  JobPlan plan{.mesh = MeshReader(arguments.mesh_file(), mesh_options),
               .steps = {},
               .backend = backend,
               .backend_reason = reason,
               .output_folder = {},
               .volumes = {},
               .warnings = {}};
  plan.warnings = mesh_warnings(plan.mesh.header(), arguments);
  const std::int64_t step_count = std::max<std::int64_t>(1, std::ssize(plan.mesh.header().times));
  try {
    plan.steps = arguments.steps.of(step_count);
  } catch (const std::invalid_argument& error) {
    throw IoError(arguments.mesh_file(), "", error.what());
  }
  const std::vector<std::string> volumes = arguments.volumes();
  const bool several = volumes.size() > 1;
  if (several) plan.output_folder = arguments.output;
  if (!several) {
    check_volume_name(arguments.output);
    const fs::path folder = fs::path(arguments.output).parent_path();
    std::error_code error;
    if (arguments.makes_folder && !folder.empty() && !fs::exists(folder, error)) {
      plan.output_folder = folder.string();
    }
  }
  for (const std::string& volume : volumes) {
    const fs::path output =
        several ? fs::path(arguments.output) / output_name_of(volume) : fs::path(arguments.output);
    plan.volumes.push_back(plan_volume(volume, output, arguments, plan.mesh, backend, plan.steps));
    const Warnings& more = plan.volumes.back().warnings;
    plan.warnings.insert(plan.warnings.end(), more.begin(), more.end());
  }
  check_axes_turn(plan, arguments);
  check_outputs(plan, arguments);
  return plan;
}

}  // namespace tetwarp::cli
