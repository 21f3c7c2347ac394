/// @file cmd_invert.cpp
/// The subcommand invert.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/map_points.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "host/cli/common/axes_option.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/job/warnings.hpp"
#include "host/cli/tools/mesh_options.hpp"
#include "host/warp/hex_split.hpp"

namespace tetwarp::cli {
namespace {
struct InvertArguments {
  std::string input;
  std::string output;
  std::optional<std::int64_t> step;
  MeshReadOptions mesh;
  std::optional<Axes> axes;
  bool quiet = false;
};

/// Counts that show whether a deformation has an inverse.
struct InverseCheck {
  std::int64_t inverted = 0;  // tetrahedra, of hexahedra their parts
  std::int64_t points = 0;    // nodes and centers of cells that were moved there and back
  std::int64_t folded = 0;    // of these, those where another cell maps to a different place
  double largest_error = 0;   // of the others
};

std::int64_t count_inverted(const Mesh& mesh, const std::vector<Point3>& deformed) {
  std::int64_t inverted = 0;
  for (const auto& tet : with_split_hexes(mesh).tets) {
    const auto volume = [&](const std::vector<Point3>& nodes) {
      return tet_volume(at(nodes, tet[0]), at(nodes, tet[1]), at(nodes, tet[2]), at(nodes, tet[3]));
    };
    inverted += volume(mesh.rest_positions) * volume(deformed) < 0;
  }
  return inverted;
}

template <std::size_t count>
Point3 center_of(const std::vector<Point3>& nodes, const std::array<std::int32_t, count>& cell) {
  Point3 center{0, 0, 0};
  for (const std::int32_t node : cell) center = plus(center, times(1.0 / count, at(nodes, node)));
  return center;
}

InverseCheck check_inverse(const Mesh& mesh, const std::vector<Point3>& deformed) {
  std::vector<Point3> points = mesh.rest_positions;
  for (const auto& tet : mesh.tets) points.push_back(center_of(mesh.rest_positions, tet));
  for (const auto& hex : mesh.hexes) points.push_back(center_of(mesh.rest_positions, hex));
  const MappedPoints there = map_points(mesh, deformed, points);
  const MappedPoints back = map_points(mesh, deformed, there.points, {.inverse = true});
  const Bounds box = bounds_of(mesh.rest_positions);
  const double tolerance = 1e-6 * norm(minus(box.high, box.low));
  InverseCheck check;
  check.inverted = count_inverted(mesh, deformed);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (there.owners[p] < 0 || back.owners[p] < 0) continue;  // nodes of no cell, rounded rims
    ++check.points;
    const double error = norm(minus(back.points[p], points[p]));
    if (error > tolerance) {
      ++check.folded;
    } else {
      check.largest_error = std::max(check.largest_error, error);
    }
  }
  return check;
}

int run_invert(const InvertArguments& arguments) {
  check_mesh(arguments.input, "usage: tetwarp invert MESH -o MESH");
  check_hdf_name(arguments.output);
  std::vector<std::string> inputs = {arguments.input};
  if (arguments.mesh.rest_file) inputs.push_back(*arguments.mesh.rest_file);
  check_output_file(arguments.output, inputs);
  MeshReadOptions options = arguments.mesh;
  options.import.axes = axes_of_mesh(arguments.input, arguments.axes);
  const MeshReader reader(arguments.input, options);
  print_merged(arguments.input, reader.header().merged);
  const auto count = std::ssize(reader.header().times);
  const std::int64_t step = arguments.step.value_or(count - 1);
  if (step >= count || (count > 1 && !arguments.step)) {
    throw IoError(arguments.input, "",
                  fmt::format("has {} steps, each with an inverse of its own; choose one with "
                              "--step 0 to {}",
                              count, count - 1));
  }
  const std::vector<Point3> deformed = reader.read_step(step);
  const Mesh& mesh = reader.mesh();
  const InverseCheck check = check_inverse(mesh, deformed);
  write_mesh(arguments.output, Mesh{deformed, mesh.tets, mesh.hexes},
             {differences(mesh.rest_positions, deformed)},
             {reader.header().times[static_cast<std::size_t>(step)]});
  if (check.inverted > 0 || check.folded > 0) {
    fmt::print(stderr,
               "tetwarp: {}: folds: {} inverted tetrahedra, {} of {} points come back to another "
               "place; there the inverse is that of the cell of the lowest number\n",
               arguments.input, check.inverted, check.folded, check.points);
  }
  if (arguments.quiet) return 0;
  fmt::print("{} cells, step {}, round trip of {} points within {:.3g}: {}\n", mesh.cell_count(),
             step, check.points - check.folded, check.largest_error, arguments.output);
  return 0;
}
}  // namespace

void add_invert_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<InvertArguments>();
  CLI::App* command = add_subcommand(
      app, "invert", "Exchange the rest and the deformed positions of a mesh: its exact inverse",
      "MESH -o MESH [options]",
      "  tetwarp invert moving.vtkhdf -o back.vtkhdf --step 7\n"
      "  tetwarp warp warped.nii.gz back.vtkhdf -o restored.nii.gz\n");
  add_mesh_to_mesh(*command, arguments->input, arguments->output);
  command->add_option("--step", arguments->step, "step to invert [the only one]")
      ->check(at_least(0))
      ->type_name("N");
  command
      ->add_option("--displacement", arguments->mesh.import.displacement,
                   "of a mesh in .msh, .vtu or .vtk: point array (Gmsh: node data) that deforms it "
                   "[displacement]")
      ->type_name("NAME");
  command
      ->add_option("--rest", arguments->mesh.rest_file, "mesh file that holds the rest positions")
      ->type_name("FILE");
  command
      ->add_option("--rest-step", arguments->mesh.rest_step,
                   "step that holds the rest positions of moving points [0]")
      ->check(at_least(0))
      ->type_name("N");
  add_mesh_axes(*command, arguments->axes);
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_invert(*arguments); }; });
}

}  // namespace tetwarp::cli
