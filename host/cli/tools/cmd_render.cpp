/// @file cmd_render.cpp
/// The subcommand render.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/cast.hpp>
#include <tetwarp/film.hpp>
#include <tetwarp/io.hpp>
#include <tetwarp/make.hpp>
#include <vector>

#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/cli/common/picture_options.hpp"
#include "host/cli/tools/read_array.hpp"
#include "host/view/look/scene_look.hpp"
#include "io/files/extension.hpp"

namespace tetwarp::cli {
namespace {
struct RenderArguments {
  std::vector<std::string> volumes;  ///< a picture of a film each
  std::string beside;
  std::string output;
  std::string array;
  std::string series;
  std::optional<std::int64_t> step;
  RenderOptions render;
  PictureOptions pictures;
  double seconds = 0.1;  ///< per picture of a film
  bool quiet = false;

  VolumeReadOptions read_options() const {
    VolumeReadOptions options;
    options.series = series;
    return options;
  }
  bool casts() const { return !pictures.cast.empty(); }
  bool is_film() const { return has_extension(output, ".gif"); }
};

/// Draws volumes one after the other, all with the window, colors and camera of the first.
class VolumePictures {
 public:
  explicit VolumePictures(const RenderArguments& arguments) : arguments_(arguments) {
    if (arguments.beside.empty()) return;
    const VolumeHeader header = read_volume_header(arguments.beside, arguments.read_options());
    beside_is_series_ = header.times.size() > 1;
  }

  /// @param step  of the volume; empty: no step is named
  Image draw(const Volume& volume, std::optional<std::int64_t> step) {
    if (!arguments_.casts()) {
      read_beside(step);
      return draw_slices(volume);
    }
    if (!colors_) prepare_rays(volume);
    const CastVolume cast{&volume, *colors_};
    return cast_volumes({&cast, 1}, {}, {}, surfaces_);
  }

 private:
  /// Reads the same step of the second volume; without --step the only one where it has one.
  void read_beside(std::optional<std::int64_t> step) {
    if (arguments_.beside.empty()) return;
    if (!arguments_.step && !beside_is_series_) step.reset();
    if (beside_ && beside_step_ == step) return;
    beside_ = read_array(arguments_.beside, arguments_.array, step, arguments_.read_options());
    beside_step_ = step;
  }

  Image draw_slices(const Volume& volume) {
    if (!window_) window_ = with_window(volume, arguments_.render);
    std::vector<const Volume*> rows{&volume};
    if (beside_) rows.push_back(&*beside_);
    return render(rows, *window_);
  }

  void prepare_rays(const Volume& volume) {
    const std::array<double, 2> found = finite_range(volume);
    const auto &low = arguments_.render.low, &high = arguments_.render.high;
    const std::array range{low.value_or(found[0]), high.value_or(found[1])};
    const bool is_window = low || high;
    if (is_window && !(range[0] < range[1])) {
      throw std::invalid_argument(fmt::format(
          "the colors would reach from {} to {}; give a --low below --high", range[0], range[1]));
    }
    colors_ = transfer_of(arguments_.pictures, volume.grid, range, is_window);
    const auto [width, height] = arguments_.pictures.size();
    surfaces_.width = width;
    surfaces_.height = height;
    if (arguments_.pictures.camera.numbers) {
      surfaces_.camera = view::camera_at(*arguments_.pictures.camera.numbers);
      return;
    }
    std::vector<Point3> corners;
    for (std::size_t c = 0; c < 8; ++c) {
      Point3 index{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto last = static_cast<double>(volume.grid.dims[axis]) - 0.5;
        index[axis] = (c >> axis & 1) != 0 ? last : -0.5;
      }
      corners.push_back(volume.grid.world_of(index));
    }
    surfaces_.camera = camera_of(corners, static_cast<double>(surfaces_.width) / surfaces_.height);
  }

  const RenderArguments& arguments_;
  bool beside_is_series_ = false;
  std::optional<Volume> beside_;
  std::optional<std::int64_t> beside_step_;  ///< as beside_ was read
  std::optional<RenderOptions> window_;
  std::optional<TransferFunction> colors_;
  SurfaceRenderOptions surfaces_;
};

void check_files(const RenderArguments& arguments) {
  std::vector<std::string> inputs = arguments.volumes;
  if (!arguments.beside.empty()) inputs.push_back(arguments.beside);
  for (const std::string& input : inputs) {
    check_volume(input, "usage: tetwarp render VOLUME... -o FILE.png|FILE.gif");
  }
  if (!arguments.is_film() && !has_extension(arguments.output, ".png")) {
    throw IoError(arguments.output, "",
                  "the name of a picture ends in .png, that of a film in .gif");
  }
  if (!arguments.is_film() && arguments.volumes.size() > 1) {
    throw IoError(arguments.output, "",
                  fmt::format("is a picture, of one volume, not of {}; name a film, .gif",
                              arguments.volumes.size()));
  }
  check_series(arguments.series, inputs);
  if (arguments.pictures.casts_by_file()) inputs.push_back(arguments.pictures.cast);
  check_output_file(arguments.output, inputs);
  if (arguments.is_film()) FilmWriter::check_available(arguments.output);
}

/// A picture of every volume and, without --step, of every step.
int make_film(const RenderArguments& arguments) {
  VolumePictures pictures(arguments);
  FilmWriter film(arguments.output);
  std::size_t count = 0;
  std::optional<Image> first;
  for (const std::string& path : arguments.volumes) {
    const auto steps =
        static_cast<std::int64_t>(read_volume_header(path, arguments.read_options()).times.size());
    const std::int64_t last =
        arguments.step ? *arguments.step + 1 : std::max<std::int64_t>(steps, 1);
    for (std::int64_t step = arguments.step.value_or(0); step < last; ++step, ++count) {
      const Image image =
          pictures.draw(read_array(path, arguments.array, step, arguments.read_options()), step);
      if (!first) first = image;
      if (image.width != first->width || image.height != first->height) {
        throw IoError(path, "",
                      fmt::format("its picture has {} x {} pixels, that of the first volume {} x "
                                  "{}; give volumes on one grid, as by --grid",
                                  image.width, image.height, first->width, first->height));
      }
      film.append(image, arguments.seconds);
    }
  }
  film.finish();
  if (!arguments.quiet) {
    fmt::print("{} pictures of {} x {} pixels: {}\n", count, first->width, first->height,
               arguments.output);
  }
  return 0;
}

int run_render(const RenderArguments& arguments) {
  check_files(arguments);
  if (arguments.is_film()) return make_film(arguments);
  VolumePictures pictures(arguments);
  const Image image = pictures.draw(read_array(arguments.volumes.front(), arguments.array,
                                               arguments.step, arguments.read_options()),
                                    arguments.step);
  write_png(arguments.output, image);
  if (arguments.quiet) return 0;
  fmt::print("{} x {} pixels: {}\n", image.width, image.height, arguments.output);
  return 0;
}

void check_options(const RenderArguments& arguments, const CLI::App& command) {
  const auto is_given = [&](const char* option) { return command.get_option(option)->count() > 0; };
  const auto& render = arguments.render;
  if (arguments.pictures.casts_by_file() && (render.low || render.high)) {
    throw CLI::ValidationError(render.low ? "--low" : "--high",
                               "the file of --cast says which values it shows; leave it out");
  }
  if (arguments.casts() && render.low && render.high && !(*render.low < *render.high)) {
    throw CLI::ValidationError("--low", "is not below --high");
  }
  if (arguments.casts() && is_given("--height")) {
    throw CLI::ValidationError("--height", "is of slices; with --cast give --pixels");
  }
  if (!arguments.casts() && arguments.pictures.pixels) {
    throw CLI::ValidationError("--pixels", "needs --cast; --height is of slices");
  }
  if (!arguments.is_film() && is_given("--seconds")) {
    throw CLI::ValidationError("--seconds", "is of a film; name it .gif");
  }
  if (arguments.casts() && !arguments.beside.empty()) {
    throw CLI::ValidationError("--beside", "is of slices; leave out --cast");
  }
  if (!arguments.casts() && arguments.pictures.camera.is_given()) {
    throw CLI::ValidationError("--camera", "needs --cast");
  }
  if (!arguments.pictures.camera.name.empty()) {
    throw CLI::ValidationError("--camera", "only scenes have cameras with names; give six numbers");
  }
}
}  // namespace

void add_render_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command =
      add_subcommand(app, "render",
                     "Draw middle slices and a maximum-intensity projection, or rays through a "
                     "volume; several volumes as a film",
                     "VOLUME... -o FILE.png|FILE.gif [options]",
                     "  tetwarp render ct.nii.gz --beside warped.nii.gz -o compare.png\n"
                     "  tetwarp render ct.nii.gz --cast -o rays.png\n");
  command->add_option("VOLUME", arguments->volumes, "volumes, VTKHDF or NIfTI; of a film several")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", arguments->output, "picture or film to write")
      ->required()
      ->type_name("FILE.png|FILE.gif");
  command->add_option("--beside", arguments->beside, "second volume, drawn with the same window")
      ->type_name("VOLUME");
  command->add_option("--array", arguments->array, "array to draw [active scalars]")
      ->type_name("NAME");
  add_series(*command, arguments->series);
  command
      ->add_option("--step", arguments->step,
                   "step of volume files with several steps [0; of a film all]")
      ->check(at_least(0))
      ->type_name("N");
  command
      ->add_option("--low", arguments->render.low,
                   "value drawn black [1st percentile; with --cast the lowest]")
      ->check(finite_number())
      ->type_name("V");
  command
      ->add_option("--high", arguments->render.high,
                   "value drawn white [99.5th percentile; with --cast the highest]")
      ->check(finite_number())
      ->type_name("V");
  command->add_option("--height", arguments->render.height, "height of a panel, in pixels [360]")
      ->check(between(16, 4096))
      ->type_name("N");
  add_camera(*command, arguments->pictures.camera, "")
      ->description("eye and target [from the front, the right and above]")
      ->type_name("X,Y,Z,TX,TY,TZ");
  declare_picture_options(*command, arguments->pictures,
                          "draw the volume by rays instead of slices");
  command->add_option("--seconds", arguments->seconds, "time of each picture of a film [0.1]")
      ->check(above_zero())
      ->type_name("S");
  add_quiet(*command, arguments->quiet);
  command->callback([arguments, command, &run] {
    check_options(*arguments, *command);
    run = [arguments] { return run_render(*arguments); };
  });
}

}  // namespace tetwarp::cli
