/// @file cmd_invert.cpp
/// The subcommand invert.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
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
#include "host/cli/common/ten_nodes_option.hpp"
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
  std::int64_t inverted = 0;      // tetrahedra, of hexahedra their parts
  std::int64_t points = 0;        // nodes and centers that were moved there and back
  std::int64_t straightened = 0;  // most of either way: mapped by the straight tetrahedron
  std::int64_t folded = 0;        // of `points`: another cell maps to a different place
  std::int64_t beside = 0;        // of `points`: come back by a curved cell beside their own
  double beside_error = 0;
  double largest_error = 0;  // of points that are none of the above
};

/// Whether each tetrahedron is inverted; parts of hexahedra come last, tets_per_hex of each.
std::vector<bool> inverted_tets(const Mesh& mesh, const std::vector<Point3>& deformed) {
  std::vector<bool> inverted;
  for (const auto& tet : with_split_hexes(mesh).tets) {
    const auto volume = [&](const std::vector<Point3>& nodes) {
      return tet_volume(at(nodes, tet[0]), at(nodes, tet[1]), at(nodes, tet[2]), at(nodes, tet[3]));
    };
    inverted.push_back(volume(mesh.rest_positions) * volume(deformed) < 0);
  }
  return inverted;
}

template <std::size_t count>
Point3 center_of(const std::vector<Point3>& nodes, const std::array<std::int32_t, count>& cell) {
  Point3 center{0, 0, 0};
  for (const std::int32_t node : cell) center = plus(center, times(1.0 / count, at(nodes, node)));
  return center;
}

/// Nodes and centers of cells, of curved ones also those of their straight faces, where places may
/// belong to another cell after the deformation.
std::vector<Point3> points_to_check(const CurvedMesh& curved) {
  const Mesh& mesh = curved.mesh;
  std::vector<Point3> points = mesh.rest_positions;
  for (const auto& tet : mesh.tets) points.push_back(center_of(mesh.rest_positions, tet));
  for (const auto& hex : mesh.hexes) points.push_back(center_of(mesh.rest_positions, hex));
  for (std::size_t t = 0; t < curved.mid_nodes.size(); ++t) {
    const auto& tet = mesh.tets[t];
    for (std::size_t face = 0; face < 4 && is_curved(curved, t); ++face) {
      points.push_back(
          center_of(mesh.rest_positions,
                    std::array{tet[(face + 1) % 4], tet[(face + 2) % 4], tet[(face + 3) % 4]}));
    }
  }
  return points;
}

/// Whether a cell has a curved map, in place of which its straight one may be taken either way.
bool is_curved_tet(const CurvedMesh& mesh, std::size_t cell) {
  return cell < mesh.mesh.tets.size() && is_curved(mesh, cell);
}

/// Nodes of a cell; hexahedra come after all tetrahedra.
std::span<const std::int32_t> nodes_of(const Mesh& mesh, std::size_t cell) {
  const std::size_t tets = mesh.tets.size();
  if (cell < tets) return mesh.tets[cell];
  return mesh.hexes[cell - tets];
}

/// @param inverted  of inverted_tets()
bool is_inverted(const Mesh& mesh, const std::vector<bool>& inverted, std::size_t cell) {
  const std::size_t tets = mesh.tets.size();
  if (cell < tets) return inverted[cell];
  const std::size_t first = tets + (cell - tets) * std::size_t{tets_per_hex};
  for (std::size_t part = first; part < first + tets_per_hex; ++part) {
    if (inverted[part]) return true;
  }
  return false;
}

/// Whether a place may belong to one cell before and to the other one after the deformation,
/// because ownership takes straight faces in place of curved ones: they have a node in common, one
/// is a curved tetrahedron and none is inverted.
bool are_curved_neighbors(const CurvedMesh& curved,
                          const std::vector<bool>& inverted,
                          std::size_t one,
                          std::size_t other) {
  const Mesh& mesh = curved.mesh;
  if (one == other || !(is_curved_tet(curved, one) || is_curved_tet(curved, other))) return false;
  if (is_inverted(mesh, inverted, one) || is_inverted(mesh, inverted, other)) return false;
  const std::span<const std::int32_t> nodes = nodes_of(mesh, one);
  return std::ranges::find_first_of(nodes, nodes_of(mesh, other)) != nodes.end();
}

InverseCheck check_inverse(const CurvedMesh& mesh, const std::vector<Point3>& deformed) {
  const std::vector<Point3> points = points_to_check(mesh);
  const MappedPoints there = map_points(mesh, deformed, points);
  const MappedPoints back = map_points(mesh, deformed, there.points, {.inverse = true});
  const Bounds box = bounds_of(mesh.mesh.rest_positions);
  const double tolerance = 1e-6 * norm(minus(box.high, box.low));
  const std::vector<bool> inverted = inverted_tets(mesh.mesh, deformed);
  InverseCheck check;
  check.inverted = std::ranges::count(inverted, true);
  check.straightened = std::max(there.straightened, back.straightened);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (there.owners[p] < 0 || back.owners[p] < 0) continue;  // nodes of no cell, rounded rims
    ++check.points;
    const double error = norm(minus(back.points[p], points[p]));
    const auto owner = static_cast<std::size_t>(there.owners[p]);
    if (error <= tolerance) {
      check.largest_error = std::max(check.largest_error, error);
    } else if (are_curved_neighbors(mesh, inverted, owner,
                                    static_cast<std::size_t>(back.owners[p]))) {
      ++check.beside;
      check.beside_error = std::max(check.beside_error, error);
    } else if (there.owners[p] != back.owners[p] || !is_curved_tet(mesh, owner)) {
      ++check.folded;
    }
  }
  return check;
}

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
