/// @file warnings.cpp
/// The texts of warnings and when they are given.
#include "host/cli/job/warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <stdexcept>
#include <type_traits>

#include "host/base/pixel_dispatch.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/job/output_writer.hpp"
#include "io/files/extension.hpp"

namespace tetwarp::cli {
namespace {
/// The value that a sample of this type gets; integers are rounded half to even and saturate.
/// @pre  of integers: the value is finite
double stored_value(PixelType type, double value) {
  double stored = 0;
  with_pixel_type(type, [&]<class T>(T) {
    if constexpr (std::is_integral_v<T>) {
      using Limits = std::numeric_limits<T>;
      stored = std::clamp(std::nearbyint(value), static_cast<double>(Limits::min()),
                          static_cast<double>(Limits::max()));
    } else {
      stored = static_cast<double>(static_cast<T>(value));
    }
  });
  return stored;
}

/// True when a type can hold a value: integers exactly, floating-point numbers rounded.
bool fits(PixelType type, double value) {
  const double stored = stored_value(type, value);
  return is_integer(type) ? stored == value : std::isfinite(stored) == std::isfinite(value);
}

/// Steps by number; several volumes give a step several times.
using Steps = std::map<std::int64_t, const Counts*>;

/// "step 3", "step 3 and 2 more".
std::string steps_text(const Steps& steps) {
  std::string text = fmt::format("step {}", steps.begin()->first);
  if (steps.size() > 1) text += fmt::format(" and {} more", steps.size() - 1);
  return text;
}
}  // namespace

Warnings mesh_warnings(const std::string& path,
                       const MeshHeader& mesh,
                       const MeshReadOptions& options) {
  Warnings warnings;
  if (!mesh.merged.empty()) warnings.push_back(path + ": " + mesh.merged);
  if (!mesh.has_displacement && !mesh.has_moving_points && !options.rest_file) {
    warnings.push_back(
        path +
        ": the mesh has no point array 'displacement', no points that move "
        "and no --rest: nothing is deformed" +
        (kind_of(path) == FileKind::mesh ? "" : "; --displacement names another point array"));
  }
  return warnings;
}

Warnings volume_warnings(const std::string& path,
                         const VolumeHeader& volume,
                         const MeshHeader& mesh,
                         const WarpArguments& arguments) {
  Warnings warnings;
  if (!arguments.pair && !arguments.source_step && volume.times.size() > 1 &&
      mesh.times.size() > 1) {
    warnings.push_back(
        fmt::format("{}: all steps of the mesh warp step 0 of the {} steps of the volume; --pair "
                    "takes step n for step n, --source-step another one",
                    path, volume.times.size()));
  }
  if (arguments.pair && volume.times.size() > mesh.times.size()) {
    warnings.push_back(fmt::format(
        "{}: --pair: the mesh has {} of the {} steps of the volume, the others are left out{}",
        path, mesh.times.size(), volume.times.size(),
        mesh.times.size() == 1 ? "; without --pair its one step warps all of them" : ""));
  }
  if (!arguments.arrays.empty()) return warnings;
  std::string changes;
  if (!volume.not_read.empty()) changes = "not warped: " + listed(volume.not_read);
  if (!volume.widened.empty()) {
    changes += changes.empty() ? "" : "; ";
    changes += "float16 becomes float32: " + listed(volume.widened);
  }
  if (!changes.empty()) {
    warnings.push_back(path + ": " + changes + "; --array names what to warp");
  }
  return warnings;
}

Warnings volume_notes(const std::string& path,
                      const VolumeHeader& volume,
                      const WarpArguments& arguments) {
  Warnings notes;
  for (const std::string& note : volume.notes) notes.push_back(path + ": " + note);
  if (!volume.left_out.empty()) notes.push_back(path + ": left out: " + listed(volume.left_out));
  if (!arguments.arrays.empty()) return notes;
  std::vector<std::string> results;
  for (const ArrayHeader& array : volume.arrays) {
    if (array.name.starts_with("tetwarp_")) results.push_back(array.name);
  }
  if (!results.empty() && results.size() < volume.arrays.size()) {
    notes.push_back(path + ": not warped: " + listed(results) +
                    ", results of an earlier warp; --array names what to warp");
  }
  return notes;
}

Warnings label_notes(const std::string& path,
                     const VolumeHeader& stored,
                     const std::vector<ArrayHeader>& arrays) {
  Warnings notes;
  for (const ArrayHeader& array : arrays) {
    const PixelType type = std::ranges::find(stored.arrays, array.name, &ArrayHeader::name)->type;
    if (type == array.type) continue;
    notes.push_back(fmt::format("{}: {}: labels of {} are written as {}", path, array.name,
                                name_of(type), name_of(array.type)));
  }
  return notes;
}

Warnings slice_notes(const std::string& output,
                     const Grid& grid,
                     const std::vector<ArrayHeader>& arrays) {
  const auto is_field = [](const ArrayHeader& array) { return nifti_array(array).is_itk_field; };
  if (!has_nifti_name(output) || itk_components(grid) != 2 ||
      std::ranges::none_of(arrays, is_field)) {
    return {};
  }
  return {output + ": " + itk_slice_note};
}

Warnings array_warnings(const std::string& volume,
                        const std::vector<ArrayHeader>& arrays,
                        const WarpArguments& arguments) {
  Warnings warnings;
  const WarpOptions& warp = arguments.warp;
  for (const ArrayHeader& array : arrays) {
    const auto warn = [&](const std::string& problem) {
      warnings.push_back(fmt::format("{}: {}: {}", volume, array.name, problem));
    };
    const char* type = name_of(array.type);
    if (warp.outside == Outside::background && !fits(array.type, warp.background)) {
      warn(fmt::format("--background {} does not fit {}, {} is stored", warp.background, type,
                       stored_value(array.type, warp.background)));
    }
    if (warp.intensity != Intensity::value && is_integer(array.type)) {
      warn(
          fmt::format("--intensity {} rounds to whole numbers of {} and cuts values beyond its "
                      "range: totals change; use a volume of floating-point samples",
                      name_of(warp.intensity), type));
    }
  }
  return warnings;
}

Warnings step_warnings(const std::string& mesh,
                       std::int64_t mesh_steps,
                       std::span<const StepReport> steps) {
  Steps inverted, uncovered, straightened;
  for (const StepReport& step : steps) {
    const Counts& counts = step.counts;
    const std::int64_t number = mesh_steps > 1 ? step.step : 0;
    if (counts.inverted > 0) inverted.emplace(number, &counts);
    if (counts.voxels_straightened > 0) straightened.emplace(number, &counts);
    if (counts.voxels > 0 && counts.covered == 0) uncovered.emplace(number, &counts);
  }
  Warnings warnings;
  if (!inverted.empty()) {
    const Counts& first = *inverted.begin()->second;
    warnings.push_back(
        fmt::format("{}: {} of {} tetrahedra are inverted at {}: their voxels show "
                    "the source mirrored",
                    mesh, first.inverted, first.tetrahedra, steps_text(inverted)));
  }
  if (!straightened.empty()) {
    std::int64_t voxels = 0;
    for (const auto& [step, counts] : straightened) voxels += counts->voxels_straightened;
    warnings.push_back(fmt::format(
        "{}: {} voxels are mapped by straight tetrahedra at {}: the curved map of their "
        "tetrahedron of ten nodes has no inverse there; correct its nodes on edges",
        mesh, voxels, steps_text(straightened)));
  }
  if (!uncovered.empty()) {
    warnings.push_back(
        fmt::format("{}: the mesh covers no voxel of an output at {}; check that "
                    "mesh and volume share axes and units, or use --grid bounds",
                    mesh, steps_text(uncovered)));
  }
  return warnings;
}

void refuse_warnings(const Warnings& warnings) {
  if (!warnings.empty()) {
    throw std::runtime_error(warnings.front() + " (an error because of --strict)");
  }
}

void print_warnings(const Warnings& warnings, const std::string& job) {
  for (const std::string& warning : warnings) {
    fmt::print(stderr, "tetwarp: {}{}warning: {}\n", job, job.empty() ? "" : ": ",
               one_line(warning));
  }
}

void print_mesh_warnings(const std::string& path,
                         const MeshHeader& mesh,
                         const MeshReadOptions& options) {
  print_warnings(mesh_warnings(path, mesh, options), "");
}

void print_merged(const std::string& path, const std::string& merged) {
  if (!merged.empty()) print_warnings({path + ": " + merged}, "");
}

void print_notes(const std::string& path, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    fmt::print(stderr, "tetwarp: {}{}{}\n", path, path.empty() ? "" : ": ", one_line(note));
  }
}

void print_left_out(const std::string& path, const std::vector<std::string>& left_out) {
  if (left_out.empty()) return;
  fmt::print(stderr, "tetwarp: {}: left out: {}\n", path, one_line(listed(left_out)));
}

}  // namespace tetwarp::cli
