/// @file camera.hpp
/// From where a picture shows a scene.
#pragma once
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// A perspective view. The eye and the target differ, and `up` is not along their line.
struct Camera {
  Point3 eye{0, -1, 0};
  Point3 target{0, 0, 0};  ///< shown in the middle
  Point3 up{0, 0, 1};      ///< shown upwards
  double angle = 0.5;      ///< of view from the bottom to the top of the picture, 0 to pi [rad]
};

}  // namespace tetwarp
