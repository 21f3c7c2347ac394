#include <algorithm>

#include "tests/support/rigid_scene.hpp"

namespace tetwarp::scenes {

ContactProblem tray(const Tray& choice) {
  constexpr double gravity = 9.81, radius = 0.01, mass = 0.03;
  const auto width = static_cast<double>(choice.edge) * 2 * radius;
  const auto count = choice.edge * choice.edge;
  const double tray_mass = 0.01 * static_cast<double>(count) + 1;
  RigidScene scene;
  scene.add_body(tray_mass, tray_mass * width * width / 12,
                 {0, 0, -tray_mass * gravity * choice.time_step});
  for (std::int64_t s = 0; s < count; ++s) {
    scene.add_body(
        mass, 0.4 * mass * radius * radius,
        {0.1 * mass * gravity * choice.time_step, 0, -mass * gravity * choice.time_step});
  }
  for (const double x : {-width / 2, width / 2}) {
    for (const double y : {-width / 2, width / 2}) {
      scene.add_contact(0, {x, y, 0}, -1, {}, {0, 0, 1}, 0, choice.friction);
    }
  }
  for (std::int64_t j = 0; j < choice.edge; ++j) {
    for (std::int64_t i = 0; i < choice.edge; ++i) {
      const std::int64_t sphere = 1 + i + choice.edge * j;
      const Point3 foot = {radius * static_cast<double>(2 * i + 1) - width / 2,
                           radius * static_cast<double>(2 * j + 1) - width / 2, 0};
      scene.add_contact(sphere, {0, 0, -radius}, 0, foot, {0, 0, 1}, 0, choice.friction);
      if (i > 0) {
        scene.add_contact(sphere, {-radius, 0, 0}, sphere - 1, {radius, 0, 0}, {1, 0, 0}, 0,
                          choice.friction);
      }
      if (j > 0) {
        scene.add_contact(sphere, {0, -radius, 0}, sphere - choice.edge, {0, radius, 0}, {0, 1, 0},
                          0, choice.friction);
      }
    }
  }
  return scene.take();
}

}  // namespace tetwarp::scenes
