/// @file cmd_mesh.cpp
/// The subcommand mesh.
#include <fmt/format.h>

#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/make.hpp>
#include <tetwarp/scene_io.hpp>
#include <tetwarp/surface.hpp>

#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/job/warnings.hpp"
#include "host/cli/tools/read_array.hpp"

namespace tetwarp::cli {
namespace {
struct MeshArguments {
  std::string volume;
  std::string from_surface;
  std::string surface;
  std::int64_t surface_triangles = 0;  // 0: as many as there are
  std::string output;
  std::string array;
  std::string series;
  std::optional<std::int64_t> step;
  LatticeOptions lattice;
  bool quiet = false;
};

MeshArray array_of(const char* name, PixelType type, const void* data, std::size_t bytes) {
  const auto* const first = static_cast<const std::byte*>(data);
  return {name, false, type, 4, {first, first + bytes}};
}

/// Writes triangles with the nodes and weights that their points are bound to.
void write_bound_surface(const MeshArguments& arguments,
                         const Surface& surface,
                         const BoundPoints& bound) {
  const std::size_t points = surface.points.size();
  write_surface(arguments.surface, surface,
                {array_of("nodes", PixelType::int32, bound.nodes.data(), points * 16),
                 array_of("weights", PixelType::float64, bound.weights.data(), points * 32)});
  if (arguments.quiet) return;
  fmt::print("{} triangles, farthest point {:.3g} from the mesh: {}\n", surface.triangles.size(),
             bound.largest_distance, arguments.surface);
}

void report_mesh(const MeshArguments& arguments, const Mesh& mesh) {
  if (arguments.quiet) return;
  fmt::print("{} nodes, {} {}: {}\n", mesh.rest_positions.size(), mesh.cell_count(),
             arguments.lattice.hexahedra ? "hexahedra" : "tetrahedra", arguments.output);
}

void check_outputs(const MeshArguments& arguments, const std::string& input) {
  check_hdf_name(arguments.output);
  check_output_file(arguments.output, {input});
  if (arguments.surface.empty()) return;
  check_hdf_name(arguments.surface);
  check_output_file(arguments.surface, {input, arguments.output});
}

int run_mesh_of_surface(const MeshArguments& arguments) {
  check_outputs(arguments, arguments.from_surface);
  std::vector<std::string> left_out;
  std::string merged;
  const Surface surface = read_surface(arguments.from_surface, &left_out, &merged);
  print_merged(arguments.from_surface, merged);
  print_left_out(arguments.from_surface, left_out);
  Mesh mesh;
  try {
    mesh = make_lattice_mesh(surface, arguments.lattice.cells);
  } catch (const std::invalid_argument& error) {
    throw IoError(arguments.from_surface, "", error.what());
  }
  write_mesh(arguments.output, mesh);
  report_mesh(arguments, mesh);
  if (!arguments.surface.empty()) {
    write_bound_surface(arguments, surface, bind_points(mesh, surface.points));
  }
  return 0;
}

Surface surface_of(const MeshArguments& arguments, const Volume& volume, const Mesh& mesh) {
  if (!arguments.lattice.threshold) return boundary_surface(mesh);
  std::optional<std::int64_t> triangles;
  if (arguments.surface_triangles > 0) triangles = arguments.surface_triangles;
  return make_isosurface(volume, *arguments.lattice.threshold, triangles);
}

int run_mesh(const MeshArguments& arguments) {
  check_volume(arguments.volume, "usage: tetwarp mesh VOLUME -o MESH");
  check_outputs(arguments, arguments.volume);
  check_series(arguments.series, {arguments.volume});
  VolumeReadOptions read;
  read.series = arguments.series;
  const Volume volume = read_array(arguments.volume, arguments.array, arguments.step, read);
  Mesh mesh;
  Surface surface;
  try {
    mesh = make_lattice_mesh(volume, arguments.lattice);
    if (!arguments.surface.empty()) surface = surface_of(arguments, volume, mesh);
  } catch (const std::invalid_argument& error) {
    throw IoError(arguments.volume, volume.name, error.what());
  }
  write_mesh(arguments.output, mesh);
  report_mesh(arguments, mesh);
  if (!arguments.surface.empty()) {
    write_bound_surface(
        arguments, surface,
        arguments.lattice.threshold ? bind_points(mesh, surface.points) : bind_boundary(mesh));
  }
  return 0;
}

void check_options(const MeshArguments& arguments) {
  const bool is_of_surface = !arguments.from_surface.empty();
  if (arguments.volume.empty() != is_of_surface) {
    throw CLI::ValidationError("VOLUME", "expected a volume or --from-surface FILE");
  }
  const char* const refused = !is_of_surface                ? nullptr
                              : arguments.lattice.threshold ? "--threshold"
                              : arguments.lattice.hexahedra ? "--hexahedra"
                              : !arguments.array.empty()    ? "--array"
                              : !arguments.series.empty()   ? "--series"
                              : arguments.step              ? "--step"
                                                            : nullptr;
  if (refused != nullptr) {
    throw CLI::ValidationError(refused, "is not for --from-surface; leave it out");
  }
  if (!arguments.surface.empty() && arguments.lattice.hexahedra) {
    throw CLI::ValidationError("--surface", "binds to tetrahedra; leave out --hexahedra");
  }
  if (arguments.surface_triangles > 0 &&
      (arguments.surface.empty() || !arguments.lattice.threshold)) {
    throw CLI::ValidationError("--surface-triangles", "needs --surface and --threshold");
  }
}

void declare_options(CLI::App& command, MeshArguments& arguments) {
  command.add_option("VOLUME", arguments.volume, "volume, VTKHDF or NIfTI")->type_name("");
  command
      .add_option(
          "--from-surface", arguments.from_surface,
          "instead of a volume: tetrahedra that this closed surface (VTKHDF, .stl, .ply, .obj, "
          ".vtp, .vtu, .vtk, .msh) touches or contains")
      ->type_name("FILE");
  command.add_option("-o,--output", arguments.output, "mesh to write")
      ->required()
      ->type_name("MESH");
  command.add_option("--cells", arguments.lattice.cells, "cubes along the longest side [8]")
      ->check(between(1, 1000))
      ->type_name("N");
  command
      .add_option("--threshold", arguments.lattice.threshold,
                  "voxels above this value are foreground [every voxel]")
      ->check(finite_number())
      ->type_name("V");
  command.add_flag("--hexahedra", arguments.lattice.hexahedra,
                   "keep the cubes as trilinear hexahedra, instead of five tetrahedra each");
  command
      .add_option("--array", arguments.array,
                  "array to compare with the threshold [active scalars]")
      ->type_name("NAME");
  add_series(command, arguments.series);
  command.add_option("--step", arguments.step, "step of a volume file with several steps [0]")
      ->check(at_least(0))
      ->type_name("N");
  add_quiet(command, arguments.quiet);
  command
      .add_option("--surface", arguments.surface,
                  "also write triangles, whose points have the arrays nodes and weights of the "
                  "tetrahedra they are bound to: the isosurface at the threshold, without one the "
                  "boundary of the mesh")
      ->type_name("FILE");
  command
      .add_option("--surface-triangles", arguments.surface_triangles,
                  "about how many triangles of the isosurface [as many as there are]")
      ->check(between(4, 100'000'000))
      ->type_name("N");
}
}  // namespace

void add_mesh_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App* command = add_subcommand(
      app, "mesh", "Make a lattice of tetrahedra or cubes that embeds a volume",
      "VOLUME -o MESH [options]",
      "  tetwarp mesh ct.nii.gz -o mesh.vtkhdf --cells 8 --threshold -500\n"
      "  tetwarp mesh ct.nii.gz -o mesh.vtkhdf --threshold -500 --surface skin.vtkhdf\n"
      "  tetwarp mesh --from-surface skin.vtkhdf -o mesh.vtkhdf --cells 12\n");
  declare_options(*command, *arguments);
  command->callback([arguments, &run] {
    check_options(*arguments);
    run = [arguments] {
      return arguments->from_surface.empty() ? run_mesh(*arguments)
                                             : run_mesh_of_surface(*arguments);
    };
  });
}

}  // namespace tetwarp::cli
