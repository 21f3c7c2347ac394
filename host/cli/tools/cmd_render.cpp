/// @file cmd_render.cpp
/// The subcommand render.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/make.hpp>
#include <vector>

#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/tools/read_array.hpp"
#include "io/files/extension.hpp"

namespace tetwarp::cli {
namespace {
struct RenderArguments {
  std::string volume;
  std::string beside;
  std::string output;
  std::string array;
  std::string series;
  std::optional<std::int64_t> step;
  RenderOptions render;
  bool quiet = false;
};

int run_render(const RenderArguments& arguments) {
  std::vector<std::string> inputs{arguments.volume};
  if (!arguments.beside.empty()) inputs.push_back(arguments.beside);
  for (const std::string& input : inputs) {
    check_volume(input, "usage: tetwarp render VOLUME -o FILE.png");
  }
  if (!has_extension(arguments.output, ".png")) {
    throw IoError(arguments.output, "", "the name of a picture ends in .png");
  }
  check_output_file(arguments.output, inputs);
  check_series(arguments.series, inputs);
  VolumeReadOptions read;
  read.series = arguments.series;
  std::vector<Volume> volumes;
  volumes.reserve(inputs.size());
  for (const std::string& input : inputs) {
    volumes.push_back(read_array(input, arguments.array, arguments.step, read));
  }
  std::vector<const Volume*> rows;
  rows.reserve(volumes.size());
  for (const Volume& volume : volumes) rows.push_back(&volume);
  const Image image = render(rows, arguments.render);
  write_png(arguments.output, image);
  if (arguments.quiet) return 0;
  fmt::print("{} x {} pixels: {}\n", image.width, image.height, arguments.output);
  return 0;
}
}  // namespace

void add_render_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command =
      add_subcommand(app, "render", "Draw middle slices and a maximum-intensity projection",
                     "VOLUME -o FILE.png [options]",
                     "  tetwarp render ct.nii.gz --beside warped.nii.gz -o compare.png\n");
  command->add_option("VOLUME", arguments->volume, "volume, VTKHDF or NIfTI")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", arguments->output, "picture to write")
      ->required()
      ->type_name("FILE.png");
  command->add_option("--beside", arguments->beside, "second volume, drawn with the same window")
      ->type_name("VOLUME");
  command->add_option("--array", arguments->array, "array to draw [active scalars]")
      ->type_name("NAME");
  add_series(*command, arguments->series);
  command->add_option("--step", arguments->step, "step of volume files with several steps [0]")
      ->check(at_least(0))
      ->type_name("N");
  command->add_option("--low", arguments->render.low, "value drawn black [1st percentile]")
      ->check(finite_number())
      ->type_name("V");
  command->add_option("--high", arguments->render.high, "value drawn white [99.5th percentile]")
      ->check(finite_number())
      ->type_name("V");
  command->add_option("--height", arguments->render.height, "height of a panel, in pixels [360]")
      ->check(between(16, 4096))
      ->type_name("N");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, &run] { run = [arguments] { return run_render(*arguments); }; });
}

}  // namespace tetwarp::cli
