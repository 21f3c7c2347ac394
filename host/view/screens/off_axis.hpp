/// @file off_axis.hpp
/// The view of an eye through a screen: a frustum whose edges are those of the screen.
#pragma once
#include <array>
#include <optional>

#include "host/view/screens/room.hpp"

namespace tetwarp::view {

/// A camera that looks along minus the normal of a screen, wherever the eye is.
struct OffAxisView {
  Point3 eye{}, target{};  ///< the foot of the eye on the plane of the screen
  Point3 up{};             ///< unit
  double distance = 0;     ///< of the eye from the plane, > 0
  /// Edges of the screen from the foot, in distances: left, right, bottom, top.
  std::array<double, 4> tangents{};
};

/// @param screen  corners in the frame of the eye
/// @returns nothing if the eye is not in front of the screen
std::optional<OffAxisView> off_axis_view(const Screen& screen, const Point3& eye);

/// Row-major matrix from the camera's frame (looking along -z) to clip coordinates from -1 to 1, as
/// OpenGL has it.
/// @param nearest, farthest  0 < nearest < farthest
std::array<double, 16> projection_of(const OffAxisView& view, double nearest, double farthest);

}  // namespace tetwarp::view
