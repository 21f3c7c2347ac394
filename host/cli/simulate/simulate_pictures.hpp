/// @file simulate_pictures.hpp
/// Pictures and films of the bodies of a simulation.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/cast.hpp>
#include <tetwarp/film.hpp>
#include <tetwarp/make.hpp>
#include <tetwarp/simulate.hpp>

#include "host/cli/simulate/simulate_arguments.hpp"
#include "host/cli/simulate/simulate_warp.hpp"
#include "host/view/look/look_surfaces.hpp"

namespace tetwarp::cli {

/// Draws the surfaces of all bodies and obstacles, with --cast also the volumes of bodies:
/// scene_0000.png and so on, and a film of them.
class ScenePictures {
 public:
  /// Chooses the camera from the state of the simulator, unless it is given. Writes nothing.
  /// @throws std::invalid_argument  on a camera that shows nothing, or is not in the scene
  /// @throws IoError                where this build cannot write films, and as transfer_of()
  ScenePictures(const Simulator& simulator, const SimulateArguments& arguments);

  /// Begins the film.
  void begin();

  /// Draws the state of the simulator.
  /// @param seconds  for which a film shows it
  /// @param warped   volumes of this state; with --cast they are drawn in place of the surfaces of
  ///                 their bodies
  void draw_frame(std::int64_t frame, double seconds, const std::vector<WarpedBody>& warped);

  /// Ends the film. Throws IoError.
  void finish();

  /// Files written so far.
  const std::vector<std::string>& paths() const { return paths_; }
  double seconds() const { return seconds_; }

 private:
  Image draw(const std::vector<WarpedBody>& warped);

  const Simulator& simulator_;
  const SimulateArguments& arguments_;
  view::LookSurfaces looks_;
  SurfaceRenderOptions options_;
  std::map<const Volume*, TransferFunction> colors_;  ///< of sources that are cast
  std::optional<FilmWriter> film_;
  std::vector<std::string> paths_;
  double seconds_ = 0;
};

}  // namespace tetwarp::cli
