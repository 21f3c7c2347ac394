/// @file cmd_points.cpp
/// The subcommand points.
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/point_file.hpp>
#include <vector>

#include "host/cli/common/axes_option.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/ten_nodes_option.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/step_selection.hpp"
#include "host/cli/job/warnings.hpp"
#include "host/cli/warp/mapped_points.hpp"

namespace tetwarp::cli {
namespace {
struct PointsArguments {
  std::string input;
  std::string mesh_file;
  std::string output;
  std::string like;
  std::string like_series;
  StepSelection steps;
  MeshReadOptions mesh;
  std::optional<Axes> axes;
  MapPointsOptions map;
  bool quiet = false;
};

/// One per step: the output itself, or its name with the number of the step.
std::vector<std::string> output_names(const PointsArguments& arguments,
                                      const std::vector<std::int64_t>& steps) {
  if (steps.size() == 1) return {arguments.output};
  SplitName name = split_name(arguments.output);
  constexpr std::string_view slicer = ".mrk";  // .mrk.json is one extension
  if (name.stem.ends_with(slicer)) {
    name.stem.resize(name.stem.size() - slicer.size());
    name.extension = std::string(slicer) + name.extension;
  }
  std::vector<std::string> names;
  for (const std::int64_t step : steps) {
    names.push_back(fmt::format("{}_{:04}{}", name.stem, step, name.extension));
  }
  return names;
}

/// Throws IoError when --axes lps turns neither points nor mesh.
void check_axes_turn(const PointsArguments& arguments, const PointFile& file) {
  if (arguments.axes != Axes::lps || file.takes_axes()) return;
  if (kind_of(arguments.mesh_file) != FileKind::mesh) return;
  throw IoError(arguments.input, "",
                "names its axes or is VTKHDF, as the mesh; leave out --axes, which is for others");
}

MappedPoints moved(const PointsArguments& arguments,
                   const MeshReader& mesh,
                   std::int64_t step,
                   const std::vector<Point3>& points,
                   const MapPointsOptions& options) {
  try {
    return mapped_by(mesh, mesh.read_step(step), points, options);
  } catch (const std::invalid_argument& error) {
    throw IoError(arguments.mesh_file, "", error.what());
  }
}

/// Tells of points that are in no cell, and of those without a place in a curved cell.
void print_kept(const PointsArguments& arguments,
                const std::string& output,
                const MappedPoints& mapped) {
  const std::size_t count = mapped.points.size();
  const std::int64_t outside = mapped.outside;
  if (mapped.straightened > 0) {
    fmt::print(stderr,
               "tetwarp: {}: {} of {} points of {} are mapped by the straight tetrahedron of their "
               "cell, whose curved map has no inverse there\n",
               output, mapped.straightened, count, arguments.input);
  }
  if (outside == 0) return;
  fmt::print(stderr,
             "tetwarp: {}: {} of {} points of {} are in no cell of the {} mesh and keep "
             "their place\n",
             output, outside, count, arguments.input, arguments.map.inverse ? "deformed" : "rest");
}

int run_points(const PointsArguments& arguments) {
  check_mesh(arguments.mesh_file, "the order is: tetwarp points FILE MESH -o FILE");
  MapPointsOptions options = arguments.map;
  if (!arguments.like.empty()) {
    check_volume(arguments.like, "--like takes the grid of a volume");
    check_series(arguments.like_series, {arguments.like}, "--like-series");
    VolumeReadOptions read;
    read.series = arguments.like_series;
    options.grid = read_volume_header(arguments.like, read).grid;
  }
  const Axes axes = arguments.axes.value_or(Axes::ras);
  const PointFile file(arguments.input, axes);
  check_axes_turn(arguments, file);
  file.check_output(arguments.output);
  MeshReadOptions read = arguments.mesh;
  if (kind_of(arguments.mesh_file) != FileKind::mesh) read.import.axes = axes;
  const MeshReader mesh(arguments.mesh_file, read);
  print_mesh_warnings(arguments.mesh_file, mesh.header(), arguments.mesh);
  const std::vector<std::int64_t> steps =
      arguments.steps.of(std::ssize(mesh.header().times), arguments.mesh_file);
  const std::vector<std::string> names = output_names(arguments, steps);
  std::vector<std::string> inputs = {arguments.input, arguments.mesh_file};
  if (!arguments.like.empty()) inputs.push_back(arguments.like);
  if (read.rest_file) inputs.push_back(*read.rest_file);
  for (const std::string& name : names) {
    check_output_file(name, inputs);
  }
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const MappedPoints mapped = moved(arguments, mesh, steps[s], file.points(), options);
    std::vector<std::uint8_t> inside;
    for (const std::int32_t owner : mapped.owners) inside.push_back(owner >= 0 ? 1 : 0);
    const std::string lost = file.write(names[s], mapped.points, inside);
    print_kept(arguments, names[s], mapped);
    if (!lost.empty()) fmt::print(stderr, "tetwarp: {}: left out: {}\n", names[s], lost);
    if (arguments.quiet) continue;
    fmt::print("{} points, {} moved {} step {}: {}\n", inside.size(),
               std::ssize(inside) - mapped.outside, arguments.map.inverse ? "back from" : "to",
               steps[s], names[s]);
  }
  return 0;
}

void declare_files(CLI::App& command, PointsArguments& arguments) {
  command
      .add_option("FILE", arguments.input,
                  "points: .csv, .tsv, .txt, .fcsv, .mrk.json, VTKHDF, .stl, .ply, .obj, .vtp, "
                  ".vtu or .vtk")
      ->required()
      ->type_name("");
  command.add_option("MESH", arguments.mesh_file, "mesh: VTKHDF, .msh, .vtu or .vtk")
      ->required()
      ->type_name("");
  command
      .add_option("-o,--output", arguments.output,
                  "copy of FILE with moved points and a column inside, 1 or 0")
      ->required()
      ->type_name("OUT");
  command
      .add_option_function<std::string>(
          "--steps",
          [&arguments](const std::string& text) {
            try {
              arguments.steps = StepSelection(text);
            } catch (const std::invalid_argument& error) {
              throw CLI::ValidationError("--steps", error.what());
            }
          },
          "steps of the mesh: numbers and half-open slices, e.g. 0:10:2 or -1 [all]")
      ->type_name("LIST");
  command
      .add_option("--displacement", arguments.mesh.import.displacement,
                  "of a mesh in .msh, .vtu or .vtk: point array (Gmsh: node data) that deforms it "
                  "[displacement]")
      ->type_name("NAME");
  add_ten_nodes(command, arguments.mesh.import.keeps_curved);
  command.add_option("--rest", arguments.mesh.rest_file, "mesh file that holds the rest positions")
      ->type_name("FILE");
  command
      .add_option("--rest-step", arguments.mesh.rest_step,
                  "step that holds the rest positions of moving points [0]")
      ->check(at_least(0))
      ->type_name("N");
}
}  // namespace

void add_points_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<PointsArguments>();
  CLI::App* command = add_subcommand(
      app, "points", "Move landmarks, contours and surfaces as a mesh deforms",
      "FILE MESH -o OUT [options]",
      "  tetwarp points landmarks.csv mesh.vtkhdf -o moved.csv --steps -1\n"
      "  tetwarp points F.mrk.json mesh.vtkhdf -o back.mrk.json --inverse --like ct.nii.gz\n");
  declare_files(*command, *arguments);
  command->add_flag("--inverse", arguments->map.inverse,
                    "from the deformed to the rest positions, as a warp samples its source");
  command
      ->add_option("--like", arguments->like,
                   "volume: cells own points by its rounding, as in a warp onto its grid")
      ->type_name("FILE");
  add_series(*command, arguments->like_series, "--like-series")->needs("--like");
  add_axes(*command, arguments->axes,
           "axes of files that do not name theirs: points, and meshes in .msh, .vtu and .vtk; lps "
           "is turned to ras and back [ras]");
  add_choice(*command, "--backend", arguments->map.backend, choices_of<Backend>(),
             "where to compute [auto, which is cpu]");
  add_device(*command, arguments->map.device);
  add_threads(*command, arguments->map.threads, "threads, 0 for all cores [0]");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, command, &run] {
    check_device(*command, arguments->map.backend);
    run = [arguments] { return run_points(*arguments); };
  });
}

}  // namespace tetwarp::cli
