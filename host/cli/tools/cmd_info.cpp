/// @file cmd_info.cpp
/// The subcommand info.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tetwarp/io.hpp>
#include <type_traits>
#include <vector>

#include "host/base/pixel_dispatch.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/json_text.hpp"

namespace tetwarp::cli {
namespace {
using Json = nlohmann::ordered_json;

struct InfoArguments {
  std::string file;
  bool stats = false;
  bool json = false;
  std::string series;
  bool quiet = false;
};

Json times_json(const std::vector<double>& times) {
  Json json{{"steps", std::max<std::size_t>(1, times.size())}};
  if (times.size() > 1) json["times"] = {times.front(), times.back()};
  return json;
}

/// Of all steps of an array: the smallest and the largest finite sample, as integers where samples
/// are, and how many are none.
template <class T>
struct SampleRange {
  std::optional<T> low, high;
  std::int64_t nans = 0, infinities = 0;

  void include(T sample) {
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(sample)) {
        ++(std::isnan(sample) ? nans : infinities);
        return;
      }
    }
    low = std::min(low.value_or(sample), sample);
    high = std::max(high.value_or(sample), sample);
  }
};

/// Adds the range of an array, null when no sample is finite; of floating-point samples also the
/// numbers of NaN and of infinities.
void add_range(Json& json,
               const std::string& path,
               const ArrayHeader& array,
               std::int64_t steps,
               const VolumeReadOptions& read) {
  with_pixel_type(array.type, [&]<class T>(T) {
    SampleRange<T> range;
    for (std::int64_t step = 0; step < steps; ++step) {
      const Volume volume = read_volume(path, array.name, step, read);
      for (const T sample : volume.samples<T>()) range.include(sample);
    }
    json["min"] = range.low ? Json(*range.low) : Json();
    json["max"] = range.high ? Json(*range.high) : Json();
    if (is_integer(array.type)) return;
    json["nan"] = range.nans;
    json["infinite"] = range.infinities;
  });
}

Json volume_json(const InfoArguments& arguments) {
  check_series(arguments.series, {arguments.file});
  VolumeReadOptions read;
  read.series = arguments.series;
  const VolumeHeader header = read_volume_header(arguments.file, read);
  const FileKind kind = kind_of(arguments.file);
  // Formats of one array give it no name.
  const bool has_one_array =
      kind != FileKind::volume && header.arrays.size() == 1 && header.active == Volume{}.name;
  const char* const word = kind == FileKind::nifti   ? "nifti"
                           : kind == FileKind::image ? "image"
                                                     : "volume";
  Json json{{"kind", word},
            {"dims", header.grid.dims},
            {"origin", header.grid.origin},
            {"spacing", header.grid.spacing},
            {"direction", header.grid.direction}};
  json.update(times_json(header.times));
  const auto steps = std::max<std::int64_t>(1, std::ssize(header.times));
  if (has_one_array) {
    const ArrayHeader& array = header.arrays.front();
    json["type"] = name_of(array.type);
    json["components"] = array.components;
    if (arguments.stats) add_range(json, arguments.file, array, steps, read);
  }
  for (const ArrayHeader& array : has_one_array ? std::vector<ArrayHeader>() : header.arrays) {
    Json entry{{"type", name_of(array.type)}, {"components", array.components}};
    if (arguments.stats) add_range(entry, arguments.file, array, steps, read);
    json["arrays"][array.name] = entry;
  }
  if (header.arrays.size() > 1) json["active"] = header.active;
  if (!header.notes.empty()) json["notes"] = header.notes;
  if (!header.not_read.empty()) json["not_read"] = header.not_read;
  if (!header.left_out.empty()) json["left_out"] = header.left_out;
  if (const auto fingerprint = read_fingerprint(arguments.file)) json["fingerprint"] = *fingerprint;
  return json;
}

Json mesh_json(const InfoArguments& arguments) {
  const MeshReader reader(arguments.file);
  const MeshHeader& header = reader.header();
  Json json{{"kind", "mesh"}, {"nodes", header.node_count}, {"tetrahedra", header.tet_count}};
  if (header.hex_count > 0) json["hexahedra"] = header.hex_count;
  if (!header.merged.empty()) json["merged"] = header.merged;
  json.update(times_json(header.times));
  json["deformation"] = header.has_displacement    ? "array displacement"
                        : header.has_moving_points ? "points that move"
                                                   : "none";
  for (const auto& [group, name] : header.group_names) json["groups"][std::to_string(group)] = name;
  if (!header.not_read.empty()) json["not_read"] = header.not_read;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Point3 low{infinity, infinity, infinity};
  Point3 high{-infinity, -infinity, -infinity};
  for (const Point3& position : reader.mesh().rest_positions) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], position[axis]);
      high[axis] = std::max(high[axis], position[axis]);
    }
  }
  json["rest_box"] = {low, high};
  return json;
}

Json adhesion_json(const ContactProblem& problem) {
  const AdhesionState& adhesion = problem.adhesion;
  const auto [low, high] =
      std::minmax_element(adhesion.intensity.begin(), adhesion.intensity.end());
  const auto bonded = std::count_if(adhesion.intensity.begin(), adhesion.intensity.end(),
                                    [](double intensity) { return intensity > 0; });
  Json json{{"time_step", adhesion.time_step}, {"bonded", bonded}};
  if (low != high) json["intensity"] = {*low, *high};
  return json;
}

Json contact_json(const InfoArguments& arguments) {
  const ContactFileHeader header = read_contact_header(arguments.file);
  const ContactProblem problem = read_contact_problem(arguments.file);
  Json json{{"kind", "contact problem"}};
  if (!header.title.empty()) json["title"] = header.title;
  if (!header.description.empty()) json["description"] = one_line(header.description);
  json["form"] = problem.is_local() ? "local" : "global";
  json["contacts"] = problem.contact_count();
  if (problem.is_local()) {
    json["entries"] = {{"W", problem.delassus.value.size()}};
  } else {
    json["dofs"] = problem.dof_count();
    json["entries"] = {{"M", problem.system.value.size()}, {"H", problem.jacobian.value.size()}};
  }
  if (!problem.block_start.empty()) json["blocks"] = problem.block_start.size() - 1;
  if (!problem.bilateral.empty()) json["bilateral_rows"] = problem.bilateral.row_count();
  if (!problem.rolling.empty()) json["rolling_contacts"] = problem.rolling.count();
  if (!problem.friction.empty()) {
    const auto [low, high] = std::minmax_element(problem.friction.begin(), problem.friction.end());
    json["friction"] = {*low, *high};
  }
  if (!problem.adhesion.empty()) json["adhesion"] = adhesion_json(problem);
  if (!header.not_read.empty()) json["not_read"] = header.not_read;
  json["guesses"] = header.guesses;
  json["solution"] = header.status.value_or(header.has_solution ? "of unknown quality" : "none");
  if (header.residual) json["residual"] = *header.residual;
  return json;
}

/// One "key: value" per line, nested objects indented.
void print_lines(const Json& json, int indent) {
  for (const auto& [key, value] : json.items()) {
    fmt::print("{:{}}{}:", "", indent, key);
    if (value.is_object()) {
      fmt::print("\n");
      print_lines(value, indent + 2);
    } else {
      fmt::print(" {}\n", value.is_string() ? value.get<std::string>() : json_text(value, -1));
    }
  }
}

int run_info(const InfoArguments& arguments) {
  const FileKind kind = kind_of(arguments.file);
  Json json;
  switch (kind) {
    case FileKind::volume:
    case FileKind::nifti:
    case FileKind::image:
      json = volume_json(arguments);
      break;
    case FileKind::mesh:
      json = mesh_json(arguments);
      break;
    case FileKind::contact_problem:
      json = contact_json(arguments);
      break;
    default:
      if (kind == FileKind::unknown && has_mesh_extension(arguments.file)) {
        json = mesh_json(arguments);
        break;
      }
      check_sound(arguments.file, kind);
      throw IoError(
          arguments.file, "",
          std::string("is a ") + name_of(kind) +
              "; info reads volumes (VTKHDF, NIfTI), meshes (VTKHDF, .msh, .vtu, .vtk) and "
              "FCLIB contact problems");
  }
  if (arguments.quiet) return 0;
  if (arguments.json) {
    fmt::print("{}\n", json_text(json, 2));
  } else {
    print_lines(json, 0);
  }
  return 0;
}
}  // namespace

void add_info_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<InfoArguments>();
  CLI::App* command = add_subcommand(app, "info", "Show what a file holds", "FILE [options]",
                                     "  tetwarp info warped.nii.gz --stats\n");
  command->add_option("FILE", arguments->file, "volume, mesh or contact problem")
      ->required()
      ->type_name("");
  command->add_flag("--stats", arguments->stats,
                    "read the samples of all steps and show their range");
  command->add_flag("--json", arguments->json, "print JSON");
  add_series(*command, arguments->series);
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_info(*arguments); }; });
}

}  // namespace tetwarp::cli
