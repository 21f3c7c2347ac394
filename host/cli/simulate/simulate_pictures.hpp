/// @file simulate_pictures.hpp
/// Pictures and films of the bodies of a simulation.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/film.hpp>
#include <tetwarp/make.hpp>
#include <tetwarp/simulate.hpp>

#include "host/cli/simulate/simulate_arguments.hpp"

namespace tetwarp::cli {

/// Draws the surfaces of all bodies and obstacles: scene_0000.png and so on, and a film of them.
class ScenePictures {
 public:
  /// Chooses the camera from the state of the simulator, unless it is given. Writes nothing.
  /// @throws std::invalid_argument  on a camera that shows nothing
  /// @throws IoError                where this build cannot write films
  ScenePictures(const Simulator& simulator, const SimulateArguments& arguments);

  /// Begins the film.
  void begin();

  /// Draws the state of the simulator.
  /// @param seconds  for which a film shows it
  void draw_frame(std::int64_t frame, double seconds);

  /// Ends the film. Throws IoError.
  void finish();

  /// Files written so far.
  const std::vector<std::string>& paths() const { return paths_; }
  double seconds() const { return seconds_; }

 private:
  const Simulator& simulator_;
  const SimulateArguments& arguments_;
  SurfaceRenderOptions options_;
  std::optional<FilmWriter> film_;
  std::vector<std::string> paths_;
  double seconds_ = 0;
};

}  // namespace tetwarp::cli
