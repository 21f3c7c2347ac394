/// @file scene_look.hpp
/// How a scene is drawn: the surfaces of its bodies and obstacles, their colors, the camera.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/make.hpp>
#include <tetwarp/simulate.hpp>

#include "host/view/look/look_surfaces.hpp"

namespace tetwarp::view {

using Rgb = std::array<double, 3>;  ///< red, green, blue in sRGB, 0 to 1
inline constexpr Rgb obstacle_color{0.62, 0.63, 0.66};

/// The color of a body; from the eighth on lighter and darker variants.
Rgb color_of(std::size_t body);

/// What is drawn, with the points that the surfaces refer to.
struct SceneDrawing {
  std::vector<std::vector<Point3>> points;
  std::vector<Surface> obstacles;
  std::vector<DrawnSurface> surfaces;
  std::vector<DrawnPlane> planes;
};

/// The state of a simulator, which must outlive the drawing.
/// @param looks  of this simulator
SceneDrawing drawing_of(const Simulator& simulator, const LookSurfaces& looks);

/// The camera of eye and target, or of a name in the scene; without both that of the scene, or one
/// that shows the whole scene, and where it will be if it falls.
/// @param looks    of this simulator
/// @param numbers  eye, target [m]
/// @param name     empty: none
/// @param aspect  width over height of the picture
/// @throws std::invalid_argument  the scene has no camera of this name
Camera chosen_camera(const Simulator& simulator,
                     const LookSurfaces& looks,
                     const std::optional<std::array<double, 6>>& numbers,
                     const std::string& name,
                     double aspect);

/// A camera of an eye and a target, upright.
/// @param numbers  x, y, z of the eye, then of the target
Camera camera_at(const std::array<double, 6>& numbers);

}  // namespace tetwarp::view
