#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <tetwarp/io.hpp>

#include "host/cli/commands.hpp"
#include "host/cli/declare.hpp"
#include "host/cli/file_checks.hpp"
#include "host/cli/read_array.hpp"

namespace tetwarp::cli {
namespace {
struct ExportArguments {
  std::string input;
  std::string output;
  std::string array;
  std::int64_t step = 0;
  std::optional<NiftiVectors> vectors;
  bool quiet = false;
};

/// --vectors, or without it LPS for displacement fields of the warp, which ITK and ANTs read.
NiftiVectors vectors_of(const ExportArguments& arguments, const Volume& volume) {
  const bool is_field = volume.name == "tetwarp_displacement" || volume.name == "tetwarp_forward";
  return arguments.vectors.value_or(is_field ? NiftiVectors::lps : NiftiVectors::world);
}

int run_export(const ExportArguments& arguments) {
  check_kind(arguments.input, FileKind::volume, "usage: tetwarp export VOLUME -o FILE.nii.gz");
  if (!arguments.output.ends_with(".nii") && !arguments.output.ends_with(".nii.gz")) {
    throw IoError(arguments.output, "", "the name of a NIfTI image ends in .nii or .nii.gz");
  }
  check_output_file(arguments.output, {arguments.input});
  const Volume volume = read_array(arguments.input, arguments.array, arguments.step);
  const NiftiVectors vectors = vectors_of(arguments, volume);
  write_nifti(arguments.output, volume, vectors);
  if (arguments.quiet) return 0;
  fmt::print("{} of {}{}: {}\n", volume.name, name_of(volume.type),
             vectors == NiftiVectors::lps ? " as LPS displacements" : "", arguments.output);
  return 0;
}
}  // namespace

void add_export_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = add_subcommand(app, "export", "Turn one array of a volume into a NIfTI image",
                                     "VOLUME -o FILE [options]",
                                     "  tetwarp export warped.vtkhdf -o warped.nii.gz\n"
                                     "  tetwarp export warped.vtkhdf --array tetwarp_displacement "
                                     "-o field.nii.gz\n");
  command->add_option("VOLUME", arguments->input, "VTKHDF image")->required()->type_name("");
  command->add_option("-o,--output", arguments->output, "image to write, .nii or .nii.gz")
      ->required()
      ->type_name("FILE");
  command->add_option("--array", arguments->array, "array to write [active scalars]")
      ->type_name("NAME");
  command->add_option("--step", arguments->step, "step of a volume file with several steps [0]")
      ->check(at_least(0))
      ->type_name("N");
  command
      ->add_option_function<std::string>(
          "--vectors",
          [arguments](const std::string& word) {
            arguments->vectors = meaning_of("--vectors", word, choices_of<NiftiVectors>());
          },
          "axes of vectors: the file's, or those of ITK and ANTs, x and y negated [lps for "
          "tetwarp_displacement and tetwarp_forward, else world]")
      ->type_name("world|lps");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_export(*arguments); }; });
}

}  // namespace tetwarp::cli
