/// @file cmd_invert.cpp
/// The subcommand invert.
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "host/cli/common/axes_option.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/ten_nodes_option.hpp"
#include "host/cli/job/warnings.hpp"
#include "host/cli/tools/mesh_options.hpp"
#include "host/warp/compose/mesh_inverse.hpp"

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

void print_check(const InvertArguments& arguments, const InverseCheck& check) {
  if (check.straightened > 0) {
    fmt::print(stderr,
               "tetwarp: {}: {} of {} points are mapped by the straight tetrahedron of their "
               "cell, whose curved map has no inverse there\n",
               arguments.input, check.straightened, check.points);
  }
  if (check.inverted == 0 && check.folded == 0) return;
  fmt::print(stderr,
             "tetwarp: {}: folds: {} inverted tetrahedra, {} of {} points come back to another "
             "place; there the inverse is that of the cell of the lowest number\n",
             arguments.input, check.inverted, check.folded, check.points);
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
  print_mesh_warnings(arguments.input, reader.header(), arguments.mesh);
  const auto count = std::ssize(reader.header().times);
  const std::int64_t step = arguments.step.value_or(count - 1);
  if (step >= count || (count > 1 && !arguments.step)) {
    throw IoError(arguments.input, "",
                  fmt::format("has {} steps, each with an inverse of its own; choose one with "
                              "--step 0 to {}",
                              count, count - 1));
  }
  const std::vector<Point3> deformed = reader.read_step(step);
  const CurvedMesh mesh{reader.mesh(), reader.mid_nodes()};
  const InverseCheck check = check_inverse(mesh, deformed);
  write_mesh(arguments.output,
             CurvedMesh{{deformed, mesh.mesh.tets, mesh.mesh.hexes}, mesh.mid_nodes},
             {differences(mesh.mesh.rest_positions, deformed)},
             {reader.header().times[static_cast<std::size_t>(step)]});
  print_left_out(arguments.input, reader.header().not_read);
  print_check(arguments, check);
  if (arguments.quiet) return 0;
  fmt::print(
      "{} cells, step {}, round trip of {} points within {:.3g}{}: {}\n", mesh.mesh.cell_count(),
      step, check.points - check.folded - check.beside, check.largest_error,
      check.beside == 0
          ? ""
          : fmt::format(", of {} at curved faces within {:.3g}", check.beside, check.beside_error),
      arguments.output);
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
  add_ten_nodes(*command, arguments->mesh.import.keeps_curved);
  add_mesh_axes(*command, arguments->axes);
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_invert(*arguments); }; });
}

}  // namespace tetwarp::cli
