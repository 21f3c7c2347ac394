/// @file simulate_pictures.cpp
/// Pictures of outputs, and the film of them.
#include "host/cli/simulate/simulate_pictures.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <tetwarp/io.hpp>

#include "host/base/stopwatch.hpp"
#include "host/view/scene_look.hpp"

namespace tetwarp::cli {

ScenePictures::ScenePictures(const Simulator& simulator, const SimulateArguments& arguments)
    : simulator_(simulator), arguments_(arguments) {
  options_.width = arguments.pixels[0];
  options_.height = arguments.pixels[1];
  const double aspect = static_cast<double>(options_.width) / options_.height;
  options_.camera =
      arguments.camera ? view::camera_at(*arguments.camera) : view::scene_camera(simulator, aspect);
  render_surfaces({}, {}, {options_.camera, 1, 1});  // throws on a camera that shows nothing
  if (!arguments.film.empty()) FilmWriter::check_available(arguments.film);
}

void ScenePictures::begin() {
  if (!arguments_.film.empty()) film_.emplace(arguments_.film);
}

void ScenePictures::draw_frame(std::int64_t frame, double seconds) {
  const Stopwatch watch;
  const view::SceneDrawing drawn = view::drawing_of(simulator_);
  const Image image = render_surfaces(drawn.surfaces, drawn.planes, options_);
  if (arguments_.draws) {
    const std::filesystem::path path =
        std::filesystem::path(arguments_.folder) / fmt::format("scene_{:04}.png", frame);
    write_png(path.string(), image);
    paths_.push_back(path.string());
  }
  if (film_) film_->append(image, seconds);
  seconds_ += watch.seconds();
}

void ScenePictures::finish() {
  if (!film_) return;
  const Stopwatch watch;
  film_->finish();
  paths_.push_back(arguments_.film);
  film_.reset();
  seconds_ += watch.seconds();
}

}  // namespace tetwarp::cli
