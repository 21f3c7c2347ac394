#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <tetwarp/io.hpp>

#include "host/cli/axes_option.hpp"
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
  std::optional<Axes> axes;
  bool quiet = false;
};

bool is_displacement(const Volume& volume) {
  return volume.name == "tetwarp_displacement" || volume.name == "tetwarp_forward";
}

/// --axes, or without it LPS for displacement fields of the warp, which ITK and ANTs read; for
/// other arrays the axes of the file that was imported.
Axes axes_of(const ExportArguments& arguments, const Volume& volume, const NiftiFacts& facts) {
  if (arguments.axes) return *arguments.axes;
  return is_displacement(volume) ? Axes::lps : facts.component_axes;
}

/// " with 3 components along LPS axes"; nothing for scalars.
std::string axes_text(const Volume& volume, Axes axes) {
  if (volume.components == 1) return {};
  return fmt::format(" with {} components along {} axes", volume.components,
                     axes == Axes::lps ? "LPS" : "RAS");
}

int run_export(const ExportArguments& arguments) {
  check_kind(arguments.input, FileKind::volume, "usage: tetwarp export VOLUME -o FILE.nii.gz");
  if (!arguments.output.ends_with(".nii") && !arguments.output.ends_with(".nii.gz")) {
    throw IoError(arguments.output, "", "the name of a NIfTI image ends in .nii or .nii.gz");
  }
  check_output_file(arguments.output, {arguments.input});
  const Volume volume = read_array(arguments.input, arguments.array, arguments.step);
  NiftiFacts facts = VolumeReader(arguments.input, volume.name, arguments.step)
                         .array()
                         .nifti.value_or(default_nifti_facts(volume.components));
  const Axes axes = axes_of(arguments, volume, facts);
  // ITK turns displacements of this intent from RAS to LPS when it reads them.
  if (is_displacement(volume) && axes == Axes::ras) facts.intent_code = nifti_displacement_intent;
  write_nifti(arguments.output, volume, axes, facts);
  if (arguments.quiet) return 0;
  fmt::print("{} of {}{}: {}\n", volume.name, name_of(volume.type), axes_text(volume, axes),
             arguments.output);
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
  add_axes(*command, arguments->axes,
           "axes of vectors and tensors in the image; its header is RAS in any case [lps for "
           "tetwarp_displacement and tetwarp_forward, which ITK and ANTs read; else as imported; "
           "else ras]");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_export(*arguments); }; });
}

}  // namespace tetwarp::cli
