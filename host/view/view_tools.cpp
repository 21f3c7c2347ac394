/// @file view_tools.cpp
/// Balls at the places of the options.
#include "host/view/view_tools.hpp"

#include <utility>

namespace tetwarp::view {
namespace {
Body ball_of(const char* name, BodyKind kind, const Point3& center, double radius) {
  Body ball{.name = name, .kind = kind};
  ball.geometry = Shape{EllipsoidShape{{radius, radius, radius}}};
  ball.pose.position = center;
  return ball;
}
}  // namespace

void add_tools(const ViewOptions& options, Scene& scene) {
  if (options.ball) {
    const auto& [x, y, z, radius] = *options.ball;
    scene.bodies.push_back(ball_of("ball", BodyKind::scripted, {x, y, z}, radius));
  }
  if (options.fingers) {
    const auto& [ox, oy, oz, ix, iy, iz, radius] = *options.fingers;
    Body outer = ball_of(outer_finger, BodyKind::scripted, {ox, oy, oz}, radius);
    outer.collide = false;
    scene.bodies.push_back(std::move(outer));
    scene.bodies.push_back(ball_of(inner_finger, BodyKind::rigid, {ix, iy, iz}, radius));
  }
}

}  // namespace tetwarp::view
