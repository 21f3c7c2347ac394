/// @file cmd_import.cpp
/// The subcommand import.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/itk_space.hpp>
#include <tetwarp/mesh_import.hpp>

#include "host/cli/common/axes_option.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/job/warnings.hpp"

namespace tetwarp::cli {
namespace {
struct ImportArguments {
  std::string input;
  std::string output;
  VolumeWriteOptions write;
  bool has_compress = false;  ///< --compress is given
  MeshImportOptions mesh;
  std::optional<Axes> axes;
  std::string series;
  bool quiet = false;
};

/// ", 3 components along RAS axes"; nothing for scalars.
std::string components_text(const ArrayHeader& array, const ImportArguments& arguments) {
  if (array.components == 1) return {};
  const bool is_assumed = !arguments.axes && array.components == 3;
  return fmt::format(", {} components along {} axes{}", array.components,
                     arguments.axes == Axes::lps ? "LPS" : "RAS",
                     is_assumed ? " (--axes lps for vectors that ITK or ANTs wrote)" : "");
}

void run_volume_import(const ImportArguments& arguments) {
  if (kind_of(arguments.input) != FileKind::image) {
    check_kind(arguments.input, FileKind::nifti,
               "usage: tetwarp import FILE -o VOLUME, with a NIfTI, NRRD, MetaImage or .vti file, "
               "a folder of DICOM images, or a mesh named .msh, .vtu or .vtk");
  }
  if (arguments.axes && !has_component_axes(arguments.input)) {
    throw IoError(arguments.input, "",
                  "keeps its components as they are; leave out --axes, which is for NIfTI, NRRD, "
                  "MetaImage and meshes");
  }
  if (arguments.mesh.displacement) {
    throw IoError(arguments.input, "", "is not a mesh; leave out --displacement");
  }
  check_series(arguments.series, {arguments.input});
  VolumeReadOptions read{arguments.axes.value_or(Axes::ras), arguments.output};
  read.series = arguments.series;
  const VolumeHeader header = read_volume_header(arguments.input, read);
  const Grid& grid = header.grid;
  const std::size_t steps = std::max<std::size_t>(1, header.times.size());
  VolumeWriteOptions write = arguments.write;
  write.scalars = header.active;
  BlockVolumeWriter writer(arguments.output, grid, header.arrays, write, steps > 1,
                           ChunkShape::rows);
  for (std::size_t step = 0; step < steps; ++step) {
    if (steps > 1) writer.begin_step(header.times[step]);
    for (std::size_t a = 0; a < header.arrays.size(); ++a) {
      const Volume volume = read_volume(arguments.input, header.arrays[a].name,
                                        static_cast<std::int64_t>(step), read);
      writer.write(a, {{0, 0, 0}, grid.dims}, volume.data.data());
    }
  }
  writer.finish();
  print_notes(arguments.input, header.notes);
  print_left_out(arguments.input, header.left_out);
  print_left_out(arguments.input, header.not_read);
  if (arguments.quiet) return;
  const ArrayHeader& array = header.arrays.front();
  fmt::print("{} x {} x {} voxels of {}{}{}{}: {}\n", grid.dims[0], grid.dims[1], grid.dims[2],
             name_of(array.type), components_text(array, arguments),
             header.arrays.size() > 1 ? fmt::format(", {} arrays", header.arrays.size()) : "",
             steps > 1 ? fmt::format(", {} steps", steps) : "", arguments.output);
}

void run_mesh_import(const ImportArguments& arguments) {
  if (!arguments.series.empty() || arguments.has_compress) {
    throw IoError(arguments.input, "",
                  std::string("is a mesh; leave out ") +
                      (arguments.has_compress ? "--compress" : "--series") +
                      ", which is for images");
  }
  MeshImportOptions options = arguments.mesh;
  options.axes = arguments.axes.value_or(Axes::ras);
  options.keeps_curved = true;
  const ImportedMesh mesh = import_mesh(arguments.input, options);
  write_mesh(arguments.output, CurvedMesh{mesh.mesh, mesh.mid_nodes}, mesh.displacements,
             mesh.times, mesh.arrays);
  print_merged(arguments.input, mesh.merged);
  print_left_out(arguments.input, mesh.left_out);
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
          "image, .nii, .nii.gz, .hdr, .nrrd, .nhdr, .mha, .mhd or .vti, or a folder of DICOM "
          "images; or mesh of tetrahedra and hexahedra: "
          "Gmsh's .msh 2 and 4, "
          "VTK's .vtu, .vtk, .vtm, .pvd and .series, Exodus' .e and .exo; '*' in a name for "
          "numbered files")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", arguments->output, "volume or mesh to write")
      ->required()
      ->type_name("OUT");
  command
      ->add_option("--compress", arguments->write.compress,
                   "of an image: deflate level, 0 for none [0]")
      ->check(between(0, 9))
      ->type_name("L");
  command
      ->add_option("--displacement", arguments->mesh.displacement,
                   "of a mesh: point array (Gmsh: node data) of three components to keep as "
                   "displacement [displacement]")
      ->type_name("NAME");
  add_axes(*command, arguments->axes,
           "axes of the file's vectors and tensors, of a mesh also of its nodes; lps is turned to "
           "ras, in which NIfTI headers place voxels [ras: NIfTI's; meshes have none and stay as "
           "they are]");
  add_series(*command, arguments->series);
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, command, &run] {
    arguments->has_compress = command->get_option("--compress")->count() > 0;
    run = [arguments] { return run_import(*arguments); };
  });
}

}  // namespace tetwarp::cli
