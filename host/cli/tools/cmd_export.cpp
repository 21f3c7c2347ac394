/// @file cmd_export.cpp
/// The subcommand export.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <tetwarp/io.hpp>
#include <vector>

#include "host/cli/common/axes_option.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/warnings.hpp"
#include "host/cli/tools/read_array.hpp"

namespace tetwarp::cli {
namespace {
struct ExportArguments {
  std::string input;
  std::string output;
  std::string array;
  std::string series;
  std::optional<std::int64_t> step;
  bool temporal = false;
  std::optional<Axes> axes;
  bool quiet = false;
};

/// " with 3 components along LPS axes"; nothing for scalars.
std::string axes_text(const ArrayHeader& array) {
  if (array.components == 1) return {};
  if (!array.nifti) return fmt::format(" with {} components", array.components);
  if (array.is_itk_field) return ", a displacement field for ITK in mm";
  return fmt::format(" with {} components along {} axes", array.components,
                     array.nifti->component_axes == Axes::lps ? "LPS" : "RAS");
}

int run_export(const ExportArguments& arguments) {
  check_volume(arguments.input, "usage: tetwarp export VOLUME -o FILE.nii.gz");
  if (!holds_one_array(arguments.output) && !has_vtk_image_name(arguments.output)) {
    throw IoError(
        arguments.output, "",
        "the name of an image to export ends in .nii, .nii.gz, .nrrd, .mha, .mhd, .mgh, .mgz or "
        ".vti");
  }
  if (arguments.axes && has_vtk_image_name(arguments.output)) {
    throw IoError(arguments.output, "",
                  "holds components along the axes of the volume; leave out --axes, or write .nii, "
                  ".nrrd or .mha");
  }
  check_output_file(arguments.output, {arguments.input});
  check_series(arguments.series, {arguments.input});
  VolumeReadOptions read;
  read.series = arguments.series;
  const std::vector<double> times = read_volume_header(arguments.input, read).times;
  const std::optional<std::int64_t> first =
      arguments.temporal ? std::optional<std::int64_t>(0) : arguments.step;
  const Volume volume = read_array(arguments.input, arguments.array, first, read);
  ArrayHeader array = VolumeReader(arguments.input, volume.name, first.value_or(0), read).array();
  if (!has_vtk_image_name(arguments.output)) array = nifti_array(array, arguments.axes);
  if (array.is_itk_field && itk_components(volume.grid) == 2) {
    fmt::print(stderr, "tetwarp: {}: {}\n", arguments.output, itk_slice_note);
  }
  const bool is_series = arguments.temporal && times.size() > 1;
  BlockVolumeWriter writer(arguments.output, volume.grid, {array}, {}, is_series, ChunkShape::rows);
  const Region whole{{0, 0, 0}, volume.grid.dims};
  if (is_series) {
    if (const std::string warning = times_warning(arguments.output, times); !warning.empty()) {
      print_warnings({warning}, "");
    }
    writer.begin_step(times.front());
  }
  writer.write(0, whole, volume.data.data());
  for (std::size_t step = 1; is_series && step < times.size(); ++step) {
    writer.begin_step(times[step]);
    const Volume next =
        read_volume(arguments.input, volume.name, static_cast<std::int64_t>(step), read);
    writer.write(0, whole, next.data.data());
  }
  writer.finish();
  if (arguments.quiet) return 0;
  fmt::print("{} of {}{}{}: {}\n", volume.name, name_of(volume.type), axes_text(array),
             is_series ? fmt::format(", {} steps", times.size()) : "", arguments.output);
  return 0;
}
}  // namespace

void add_export_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = add_subcommand(app, "export", "Turn one array of a volume into a NIfTI image",
                                     "VOLUME -o FILE [options]",
                                     "  tetwarp export warped.vtkhdf -o warped.nii.gz\n"
                                     "  tetwarp export series.vtkhdf --temporal -o series.nii.gz\n"
                                     "  tetwarp export warped.vtkhdf --array tetwarp_displacement "
                                     "-o field.nii.gz\n");
  command->add_option("VOLUME", arguments->input, "volume, VTKHDF or NIfTI")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", arguments->output,
                   "image to write, .nii, .nii.gz, .nrrd, .mha, .mhd, .mgz or .vti")
      ->required()
      ->type_name("FILE");
  command->add_option("--array", arguments->array, "array to write [active scalars]")
      ->type_name("NAME");
  command->add_option("--step", arguments->step, "step of a volume file with several steps [0]")
      ->check(at_least(0))
      ->type_name("N");
  add_series(*command, arguments->series);
  command->add_flag("--temporal", arguments->temporal, "write all steps as one series (4D)")
      ->excludes("--step");
  add_axes(*command, arguments->axes,
           "axes of vectors and tensors in the image; its header is RAS in any case [lps for "
           "tetwarp_displacement and tetwarp_forward, which ITK and ANTs read; else as imported; "
           "else ras]");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_export(*arguments); }; });
}

}  // namespace tetwarp::cli
