/// @file fastest_body.cpp
/// Compares the velocities of nodes and rigid bodies.
#include "host/simulate/run/fastest_body.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/simulate/surfaces/round_shape.hpp"

namespace tetwarp {

std::string fastest_body(const SimulatedScene& scene, const BodyStepper& stepper) {
  const Model& model = scene.model;
  std::vector<Point3> velocity;
  stepper.get_velocities(velocity);
  std::int32_t body = 0;
  double largest = -1;
  const auto compare = [&](std::int32_t of, std::int64_t block) {
    double speed = norm(velocity[index_of(block)]);
    if (!std::isfinite(speed)) speed = std::numeric_limits<double>::infinity();
    if (!(speed > largest)) return;
    largest = speed;
    body = of;
  };
  for (std::int32_t b = 0; b + 1 < std::ssize(model.body_node); ++b) {
    for (std::int32_t n = at(model.body_node, b); n < at(model.body_node, b + 1); ++n) {
      compare(b, n);
    }
  }
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    const std::int64_t block = model.node_count + 2 * std::int64_t{r};
    compare(at(model.rigid.body, r), block);
    if (!is_finite(velocity[index_of(block + 1)])) compare(at(model.rigid.body, r), block + 1);
  }
  const std::string speed = std::isinf(largest) ? "not finite" : number_text(largest) + " m/s";
  return place_of_body(scene.scene, body) + " (the fastest, " + speed + ")";
}

}  // namespace tetwarp
