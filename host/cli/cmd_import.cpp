/// @file cmd_import.cpp
#include <fmt/format.h>

#include <memory>
#include <string>
#include <tetwarp/io.hpp>

#include "host/cli/commands.hpp"
#include "host/cli/declare.hpp"
#include "host/cli/file_checks.hpp"

namespace tetwarp::cli {

namespace {

struct ImportArguments {
  std::string input;
  std::string output;
  VolumeWriteOptions write;
};

int run_import(const ImportArguments& arguments) {
  check_kind(arguments.input, FileKind::nifti, "usage: tetwarp import FILE.nii.gz -o VOLUME");
  check_hdf_name(arguments.output);
  check_output_file(arguments.output, {arguments.input});
  const Volume volume = read_nifti(arguments.input);
  write_volumes(arguments.output, {&volume}, arguments.write);
  fmt::print("{} x {} x {} voxels of {}: {}\n", volume.grid.dims[0], volume.grid.dims[1],
             volume.grid.dims[2], name_of(volume.type), arguments.output);
  return 0;
}

}  // namespace

void add_import_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command =
      add_subcommand(app, "import", "Turn a NIfTI image into a VTKHDF volume",
                     "FILE -o VOLUME [options]", "  tetwarp import brain.nii.gz -o brain.vtkhdf\n");
  command->add_option("FILE", arguments->input, "NIfTI image, .nii or .nii.gz")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", arguments->output, "volume to write")
      ->required()
      ->type_name("VOLUME");
  command->add_option("--compress", arguments->write.compress, "deflate level, 0 is none [0]")
      ->check(between(0, 9))
      ->type_name("L");
  command->callback([arguments, &run] { run = [arguments] { return run_import(*arguments); }; });
}

}  // namespace tetwarp::cli
