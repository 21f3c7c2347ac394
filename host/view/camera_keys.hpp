/// @file camera_keys.hpp
/// What keys do to the camera, as in 3D Slicer and VTK.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/make.hpp>

namespace tetwarp::view {

struct PressedKey {
  std::string name;  ///< of X11
  bool has_shift = false, has_control = false;
};

/// Arrows turn the scene about the target, with Shift they move it; + and - zoom; 1, 3 and 7 of the
/// keypad look from anterior, left and superior of axes RAS, with Shift from the opposite side, and
/// 0 from the nearest of these; r goes back to the start.
/// @param start  camera of the start
/// @returns nothing for other keys
std::optional<Camera> camera_after(const PressedKey& key, const Camera& now, const Camera& start);

}  // namespace tetwarp::view
