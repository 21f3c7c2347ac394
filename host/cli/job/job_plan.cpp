/// @file job_plan.cpp
/// Reads all headers, checks all arguments and names all outputs.
#include "host/cli/job/job_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <tetwarp/itk_space.hpp>
#include <thread>
#include <tuple>
#include <utility>

#include "host/base/region_grid.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/ranks.hpp"
#include "host/cli/job/array_checks.hpp"
#include "host/cli/job/disk_plan.hpp"
#include "host/cli/job/memory_plan.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/provenance.hpp"
#include "host/warp/backend_choice.hpp"
#include "host/warp/curve_checks.hpp"
#include "io/files/extension.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;

constexpr int symmetric_intent = 1005;  // NIfTI's SYMMATRIX

const std::string order = "the order is: tetwarp warp VOLUME... MESH -o OUT";

void check_kinds(const WarpArguments& arguments) {
  for (const std::string& volume : arguments.volumes()) {
    check_volume(volume, order);
  }
  check_series(arguments.series, arguments.volumes());
  check_mesh(arguments.mesh_file(), order);
}

/// True when --axes lps turns the components of an array, as it does those of meshes.
bool is_turned(const ArrayHeader& array) {
  const bool is_tensor =
      array.components == 6 && array.nifti && array.nifti->intent_code == symmetric_intent;
  return !is_integer(array.type) && (array.components == 3 || array.components == 9 || is_tensor);
}

/// How a volume is read: --axes applies if it is an image of vectors or tensors.
VolumeReadOptions read_options(const std::string& path,
                               const WarpArguments& arguments,
                               const fs::path& output) {
  VolumeReadOptions options;
  options.scratch = output.string();
  options.series = arguments.series;
  if (arguments.axes == Axes::lps && has_component_axes(path) &&
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
      "tensors in NIfTI, NRRD and MetaImage files; leave it out");
}

/// Checks that the volume has the last step that is to be warped.
void check_volume_step(const std::string& path,
                       const VolumeHeader& header,
                       const WarpArguments& arguments,
                       std::int64_t last) {
  const auto count = std::max<std::int64_t>(1, std::ssize(header.times));
  if (last < count) return;
  throw IoError(path, "",
                arguments.pair
                    ? fmt::format("--pair: step {} of the mesh has no pair, the volume has {} (0 "
                                  "to {}); choose steps of the mesh with --steps",
                                  last, count, count - 1)
                    : fmt::format("--source-step {} does not exist, the volume has {} (0 to {})",
                                  last, count, count - 1));
}

/// Which step of the mesh warps which step of the volume.
void set_steps(VolumePlan& plan,
               const VolumeHeader& header,
               const WarpArguments& arguments,
               const MeshHeader& mesh,
               const std::vector<std::int64_t>& steps) {
  plan.has_one_deformation = mesh.times.size() <= 1 && header.times.size() > 1 && !arguments.pair &&
                             !arguments.source_step;
  plan.is_series = arguments.temporal || plan.has_one_deformation;
  if (plan.has_one_deformation) {
    for (std::int64_t step = 0; step < std::ssize(header.times); ++step) {
      plan.steps.push_back({step, 0, step, header.times[static_cast<std::size_t>(step)]});
    }
    return;
  }
  for (const std::int64_t step : steps) {
    const std::int64_t source = arguments.pair ? step : arguments.source_step.value_or(0);
    plan.steps.push_back({step, step, source, mesh.times[static_cast<std::size_t>(step)]});
  }
  check_volume_step(plan.path, header, arguments, plan.steps.back().volume_step);
}

/// True when writing a step while the next one is computed saves time: on a device, with fewer
/// threads than processors, or with compression, which uses one thread.
bool leaves_time(Backend backend, const WarpArguments& arguments) {
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  const int threads = arguments.warp.threads > 0 ? arguments.warp.threads : processors;
  return backend != Backend::cpu || threads < processors || arguments.compress > 0;
}

/// One file per step: `output` for a single file, else its stem with the number of the step.
std::vector<std::string> output_names(const fs::path& output, const VolumePlan& plan) {
  if (plan.is_series || plan.steps.size() == 1) return {output.string()};
  std::vector<std::string> names;
  for (const WarpStep& step : plan.steps) {
    const SplitName name = split_name(output.string());
    names.push_back(fmt::format("{}_{:04}{}", name.stem, step.number, name.extension));
  }
  return names;
}

/// Sets names of outputs, checks that they can hold the arrays, and warns of times that the output
/// does not keep.
void set_outputs(VolumePlan& plan, const fs::path& output, const WarpArguments& arguments) {
  plan.outputs = output_names(output, plan);
  for (const std::string& name : plan.outputs) {
    const std::vector<std::string> files = files_of_output(name, arrays_written(plan, arguments));
    plan.files.insert(plan.files.end(), files.begin(), files.end());
    check_output_arrays(name, plan.written_grid, arrays_written(plan, arguments),
                        {.compress = arguments.compress}, plan.is_series);
  }
  if (plan.is_series) {
    std::vector<double> times;
    times.reserve(plan.steps.size());
    for (const WarpStep& step : plan.steps) times.push_back(step.time);
    const std::string warning = times_warning(output.string(), times);
    if (!warning.empty()) plan.warnings.push_back(warning);
  }
}

/// What is read and which grid is written.
VolumePlan plan_volume(const std::string& path,
                       const fs::path& output,
                       const WarpArguments& arguments,
                       const MeshReader& mesh,
                       const std::vector<std::int64_t>& steps) {
  VolumePlan plan;
  plan.path = path;
  plan.read = read_options(path, arguments, output);
  const VolumeHeader stored = read_volume_header(path, plan.read);
  plan.read.are_labels = arguments.warp.filter == Filter::labels;
  const VolumeHeader header = read_volume_header(path, plan.read);
  set_steps(plan, header, arguments, mesh.header(), steps);
  plan.arrays = choose_arrays(header, arguments, path);
  plan.active = header.active;
  plan.notes = volume_notes(path, header, arguments);
  append(plan.notes, label_notes(path, stored, plan.arrays));
  plan.source_grid = header.grid;
  check_arrays(path, header, plan.arrays, arguments);
  plan.warnings = volume_warnings(path, header, mesh.header(), arguments);
  append(plan.warnings, array_warnings(path, plan.arrays, arguments));
  const std::optional<Point3> world = itk_factor(path, header);
  if (!world) take_base_facts(arguments.grid, plan.arrays);
  plan.output_grid = resolve_grid(arguments.grid, header.grid, world, mesh, steps);
  try {
    const Region region = checked_region(plan.output_grid, arguments.warp.region);
    plan.written_grid = grid_of_region(plan.output_grid, region);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "", fmt::format("--roi: {}", error.what()));
  }
  if (arguments.extra.contains(forward_output) && plan.output_grid != plan.source_grid) {
    throw std::invalid_argument(path +
                                ": --outputs forward is on the volume's own grid; leave out "
                                "--grid, --dims, --origin, --spacing and --direction");
  }
  return plan;
}

/// Plans memory, what is done at the same time, and the output files.
void plan_outputs(VolumePlan& plan,
                  const fs::path& output,
                  const WarpArguments& arguments,
                  const MeshReader& mesh,
                  Backend backend,
                  const std::vector<std::int64_t>& steps) {
  plan.writes_beside = plan_memory(plan, arguments, mesh, steps) && plan.steps.size() > 1 &&
                       leaves_time(backend, arguments);
  set_outputs(plan, output, arguments);
  append(plan.notes,
         slice_notes(output.string(), plan.written_grid, arrays_written(plan, arguments)));
}

/// What the cpu takes for all that one of the processes of this job computes.
double cpu_seconds_of(const JobPlan& plan, const WarpArguments& arguments) {
  double samples = 0;
  for (const VolumePlan& volume : plan.volumes) {
    for (const ArrayHeader& array : volume.arrays) {
      samples += static_cast<double>(volume.steps.size()) * array.components *
                 static_cast<double>(volume.written_grid.voxel_count());
    }
  }
  return estimated_cpu_seconds(arguments.warp, samples / launched_count(),
                               plan.mesh.header().hex_count > 0, !plan.mesh.mid_nodes().empty());
}

/// The name of an output in a folder. Throws IoError when the name of the volume has none for it.
std::string output_name_of(const std::string& volume) {
  std::error_code error;
  const OutputNames names = output_names_of(volume);
  if (fs::is_directory(volume, error)) return names.of_folder;
  if (!has_one_of(names.of_file, volume_endings)) {
    throw IoError(volume, "",
                  "its name ends like that of no format, and its output would have the same name; "
                  "rename it, or warp it alone with a name behind -o");
  }
  return names.of_file;
}

/// Checks that the folder of the outputs can be written to, or made.
void check_folder(const std::string& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw IoError(folder, "", "is a file; the output of several volumes is a folder");
  }
  check_new_folder(folder, folder);
}

/// Checks that all files can be written and that no two of them are the same file.
void check_outputs(const JobPlan& plan, const WarpArguments& arguments) {
  if (!plan.output_folder.empty()) check_folder(plan.output_folder);
  check_compress(plan.outputs(), arguments.compress);
  check_output_files(files_to_write(arguments, plan.outputs()), arguments.inputs());
}

/// Throws IoError about options that need affine maps, where the mesh has tetrahedra of ten nodes.
void check_curves(const MeshReader& mesh, const WarpArguments& arguments) {
  if (mesh.mid_nodes().empty()) return;
  WarpOptions warp = arguments.warp;
  for (const auto& [array, quantity] : arguments.quantities) warp.quantities.push_back(quantity);
  const std::string refusal = curves_refusal(warp, arguments.extra.contains(forward_output));
  if (refusal.empty()) return;
  throw IoError(arguments.mesh_file(), "",
                refusal + " by --ten-nodes split into eight straight ones");
}

}  // namespace

OutputNames output_names_of(const std::string& volume) {
  fs::path path = fs::absolute(volume).lexically_normal();  // a name of "." and ".." also
  if (path.filename().empty()) path = path.parent_path();   // of a folder with a slash at its end
  const std::string name = path.filename().string(), of_folder = name + ".nii.gz";
  constexpr std::pair<std::string_view, std::string_view> written[] = {
      {".hdr", ".nii.gz"}, {".hdr.gz", ".nii.gz"}, {".img", ".nii.gz"}, {".img.gz", ".nii.gz"},
      {".dcm", ".nii.gz"}, {".nhdr", ".nrrd"},     {".mgh.gz", ".mgz"}};
  for (const auto& [end, own] : written) {
    if (!has_extension(name, end)) continue;
    return {of_folder, name.substr(0, name.size() - end.size()).append(own)};
  }
  return {of_folder, name};
}

std::vector<std::string> JobPlan::outputs() const {
  std::vector<std::string> all;
  for (const VolumePlan& volume : volumes) {
    all.insert(all.end(), volume.files.begin(), volume.files.end());
  }
  return all;
}

bool may_resume_within(const VolumePlan& volume, const WarpArguments& arguments) {
  return volume.is_series && arguments.resume;
}

JobPlan plan_job(const WarpArguments& arguments) {
  check_kinds(arguments);
  MeshReadOptions mesh_options = arguments.mesh;
  mesh_options.import.axes = arguments.axes.value_or(Axes::ras);
  JobPlan plan{.mesh = MeshReader(arguments.mesh_file(), mesh_options),
               .steps = {},
               .backend = {},
               .backend_reason = {},
               .output_folder = {},
               .volumes = {},
               .warnings = {},
               .notes = {}};
  check_curves(plan.mesh, arguments);
  plan.warnings = mesh_warnings(arguments.mesh_file(), plan.mesh.header(), arguments.mesh);
  const std::int64_t step_count = std::max<std::int64_t>(1, std::ssize(plan.mesh.header().times));
  plan.steps = arguments.steps.of(step_count, arguments.mesh_file());
  const std::vector<std::string> volumes = arguments.volumes();
  const bool several = volumes.size() > 1;
  if (several) plan.output_folder = arguments.output;
  if (!several) check_volume_name(arguments.output);
  const auto output_of = [&](const std::string& volume) {
    return several ? fs::path(arguments.output) / output_name_of(volume)
                   : fs::path(arguments.output);
  };
  for (const std::string& volume : volumes) {
    plan.volumes.push_back(
        plan_volume(volume, output_of(volume), arguments, plan.mesh, plan.steps));
  }
  std::tie(plan.backend, plan.backend_reason) =
      choose_backend_for(cpu_seconds_of(plan, arguments), arguments.warp);
  for (VolumePlan& planned : plan.volumes) {
    plan_outputs(planned, output_of(planned.path), arguments, plan.mesh, plan.backend, plan.steps);
    append(plan.warnings, planned.warnings);
    append(plan.notes, planned.notes);
  }
  check_room(plan.volumes, arguments);
  check_axes_turn(plan, arguments);
  check_outputs(plan, arguments);
  return plan;
}

}  // namespace tetwarp::cli
