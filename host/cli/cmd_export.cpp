/// @file cmd_export.cpp
#include <fmt/format.h>

#include <memory>
#include <string>
#include <tetwarp/io.hpp>

#include "host/cli/commands.hpp"
#include "host/cli/declare.hpp"
#include "host/cli/file_checks.hpp"

namespace tetwarp::cli {

namespace {

struct ExportArguments {
  std::string input;
  std::string output;
  std::string array;
  std::int64_t step = 0;
};

int run_export(const ExportArguments& arguments) {
  check_kind(arguments.input, FileKind::volume, "usage: tetwarp export VOLUME -o FILE.nii.gz");
  if (!arguments.output.ends_with(".nii") && !arguments.output.ends_with(".nii.gz")) {
    throw IoError(arguments.output, "", "the name of a NIfTI image ends in .nii or .nii.gz");
  }
  check_output_file(arguments.output, {arguments.input});
  const Volume volume = read_volume(arguments.input, arguments.array, arguments.step);
  write_nifti(arguments.output, volume);
  fmt::print("{} of {}: {}\n", volume.name, name_of(volume.type), arguments.output);
  return 0;
}

}  // namespace

void add_export_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = add_subcommand(app, "export", "Turn one array of a volume into a NIfTI image",
                                     "VOLUME -o FILE [options]",
                                     "  tetwarp export warped.vtkhdf -o warped.nii.gz\n");
  command->add_option("VOLUME", arguments->input, "VTKHDF image")->required()->type_name("");
  command->add_option("-o,--output", arguments->output, "image to write, .nii or .nii.gz")
      ->required()
      ->type_name("FILE");
  command->add_option("--array", arguments->array, "array to write [first]")->type_name("NAME");
  command->add_option("--step", arguments->step, "of a volume file with several steps [0]")
      ->check(at_least_zero())
      ->type_name("N");
  command->callback([arguments, &run] { run = [arguments] { return run_export(*arguments); }; });
}

}  // namespace tetwarp::cli
