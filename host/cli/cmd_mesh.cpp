#include <fmt/format.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/make.hpp>

#include "host/cli/commands.hpp"
#include "host/cli/declare.hpp"
#include "host/cli/file_checks.hpp"
#include "host/cli/read_array.hpp"

namespace tetwarp::cli {
namespace {
struct MeshArguments {
  std::string volume;
  std::string output;
  std::string array;
  std::int64_t step = 0;
  LatticeOptions lattice;
  bool quiet = false;
};

int run_mesh(const MeshArguments& arguments) {
  check_volume(arguments.volume, "usage: tetwarp mesh VOLUME -o MESH");
  check_hdf_name(arguments.output);
  check_output_file(arguments.output, {arguments.volume});
  const Volume volume = read_array(arguments.volume, arguments.array, arguments.step);
  Mesh mesh;
  try {
    mesh = make_lattice_mesh(volume, arguments.lattice);
  } catch (const std::invalid_argument& error) {
    throw IoError(arguments.volume, volume.name, error.what());
  }
  write_mesh(arguments.output, mesh);
  if (arguments.quiet) return 0;
  fmt::print("{} nodes, {} {}: {}\n", mesh.rest_positions.size(), mesh.cell_count(),
             arguments.lattice.hexahedra ? "hexahedra" : "tetrahedra", arguments.output);
  return 0;
}
}  // namespace

void add_mesh_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App* command =
      add_subcommand(app, "mesh", "Make a lattice of tetrahedra or cubes that embeds a volume",
                     "VOLUME -o MESH [options]",
                     "  tetwarp mesh ct.nii.gz -o mesh.vtkhdf --cells 8 --threshold -500\n");
  command->add_option("VOLUME", arguments->volume, "volume, VTKHDF or NIfTI")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", arguments->output, "mesh to write")
      ->required()
      ->type_name("MESH");
  command->add_option("--cells", arguments->lattice.cells, "cubes along the longest side [8]")
      ->check(between(1, 1000))
      ->type_name("N");
  command
      ->add_option("--threshold", arguments->lattice.threshold,
                   "voxels above this value are foreground [every voxel]")
      ->type_name("V");
  command->add_flag("--hexahedra", arguments->lattice.hexahedra,
                    "keep the cubes as trilinear hexahedra, instead of five tetrahedra each");
  command
      ->add_option("--array", arguments->array,
                   "array to compare with the threshold [active scalars]")
      ->type_name("NAME");
  command->add_option("--step", arguments->step, "step of a volume file with several steps [0]")
      ->check(at_least(0))
      ->type_name("N");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_mesh(*arguments); }; });
}

}  // namespace tetwarp::cli
