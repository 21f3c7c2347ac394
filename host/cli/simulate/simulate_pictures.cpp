/// @file simulate_pictures.cpp
/// Pictures of outputs, and the film of them.
#include "host/cli/simulate/simulate_pictures.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <tetwarp/cast.hpp>
#include <tetwarp/io.hpp>

#include "host/base/stopwatch.hpp"
#include "host/view/look/scene_look.hpp"

namespace tetwarp::cli {

ScenePictures::ScenePictures(const Simulator& simulator, const SimulateArguments& arguments)
    : simulator_(simulator), arguments_(arguments), looks_(simulator) {
  const auto [width, height] = arguments.pictures.size();
  options_.width = width;
  options_.height = height;
  const double aspect = static_cast<double>(options_.width) / options_.height;
  const CameraOption& camera = arguments.pictures.camera;
  options_.camera = view::chosen_camera(simulator, looks_, camera.numbers, camera.name, aspect);
  render_surfaces({}, {}, {options_.camera, 1, 1});  // throws on a camera that shows nothing
  if (!arguments.film.empty()) FilmWriter::check_available(arguments.film);
  if (!arguments.pictures.cast.empty()) transfer_of(arguments.pictures, Grid{{1, 1, 1}}, {0, 1});
}

void ScenePictures::begin() {
  if (!arguments_.film.empty()) film_.emplace(arguments_.film);
}

Image ScenePictures::draw(const std::vector<WarpedBody>& warped) {
  view::SceneDrawing drawn = view::drawing_of(simulator_, looks_);
  if (arguments_.pictures.cast.empty()) {
    return render_surfaces(drawn.surfaces, drawn.planes, options_);
  }
  std::vector<CastVolume> volumes;
  for (const WarpedBody& body : warped) {
    const auto [colors, is_new] = colors_.try_emplace(body.source);
    if (is_new) {
      colors->second =
          transfer_of(arguments_.pictures, body.source->grid, finite_range(*body.source));
    }
    volumes.push_back({&body.volume, colors->second});
    drawn.surfaces[body.body].triangles = {};
  }
  return cast_volumes(volumes, drawn.surfaces, drawn.planes, options_);
}

void ScenePictures::draw_frame(std::int64_t frame,
                               double seconds,
                               const std::vector<WarpedBody>& warped) {
  const Stopwatch watch;
  const Image image = draw(warped);
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
