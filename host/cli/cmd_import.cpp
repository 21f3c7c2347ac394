#include <fmt/format.h>

#include <memory>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/mesh_import.hpp>

#include "host/cli/commands.hpp"
#include "host/cli/declare.hpp"
#include "host/cli/file_checks.hpp"

namespace tetwarp::cli {
namespace {
struct ImportArguments {
  std::string input;
  std::string output;
  VolumeWriteOptions write;
  MeshImportOptions mesh;
  bool quiet = false;
};

void run_volume_import(const ImportArguments& arguments) {
  check_kind(arguments.input, FileKind::nifti,
             "usage: tetwarp import FILE -o VOLUME, with a NIfTI image or a mesh named .msh, .vtu "
             "or .vtk");
  if (arguments.mesh.displacement) {
    throw IoError(arguments.input, "", "is not a mesh; leave out --displacement");
  }
  const Volume volume = read_nifti(arguments.input);
  write_volumes(arguments.output, {&volume}, arguments.write);
  if (arguments.quiet) return;
  fmt::print("{} x {} x {} voxels of {}: {}\n", volume.grid.dims[0], volume.grid.dims[1],
             volume.grid.dims[2], name_of(volume.type), arguments.output);
}

void run_mesh_import(const ImportArguments& arguments) {
  const ImportedMesh mesh = import_mesh(arguments.input, arguments.mesh);
  write_mesh(arguments.output, mesh.mesh, mesh.displacements, mesh.times);
  if (arguments.quiet) return;
  std::string skipped;
  for (const auto& [kind, count] : mesh.skipped) {
    skipped += fmt::format("{}{} {}", skipped.empty() ? ", left out: " : ", ", count, kind);
  }
  fmt::print("{} nodes, {} tetrahedra, {} hexahedra, {} steps of displacement{}: {}\n",
             mesh.mesh.rest_positions.size(), mesh.mesh.tets.size(), mesh.mesh.hexes.size(),
             mesh.displacements.size(), skipped, arguments.output);
}

int run_import(const ImportArguments& arguments) {
  check_hdf_name(arguments.output);
  check_output_file(arguments.output, {arguments.input});
  if (has_mesh_extension(arguments.input)) {
    run_mesh_import(arguments);
  } else {
    run_volume_import(arguments);
  }
  return 0;
}
}  // namespace

void add_import_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command = add_subcommand(
      app, "import", "Turn a NIfTI image into a VTKHDF volume, a foreign mesh into a VTKHDF mesh",
      "FILE -o OUT [options]",
      "  tetwarp import brain.nii.gz -o brain.vtkhdf\n"
      "  tetwarp import skull.msh -o skull.vtkhdf --displacement u\n");
  command
      ->add_option(
          "FILE", arguments->input,
          "NIfTI image, .nii or .nii.gz; or mesh of tetrahedra and hexahedra: Gmsh's .msh 2 and 4, "
          "VTK's .vtu and .vtk")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", arguments->output, "volume or mesh to write")
      ->required()
      ->type_name("OUT");
  command->add_option("--compress", arguments->write.compress, "deflate level, 0 for none [0]")
      ->check(between(0, 9))
      ->type_name("L");
  command
      ->add_option("--displacement", arguments->mesh.displacement,
                   "of a mesh: point array (Gmsh: node data) of three components to keep as "
                   "displacement [displacement]")
      ->type_name("NAME");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_import(*arguments); }; });
}

}  // namespace tetwarp::cli
