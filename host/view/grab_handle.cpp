/// @file grab_handle.cpp
/// Springs for bodies of any size and softness.
#include "host/view/grab_handle.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
// Times the size of a body: what the mouse holds of an elastic body or cloth.
constexpr double grab_share = 0.08;

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}
}  // namespace

PointHandle grab_handle(const Simulator& simulator,
                        const ViewOptions& options,
                        std::size_t body,
                        const Point3& point) {
  const BodyMesh& of = simulator.body(body);
  const Bounds bounds = bounds_of(simulator.surface_positions(body));
  const double size = norm(minus(bounds.high, bounds.low));
  PointHandle handle{.body = simulator.scene().bodies[body].name, .center = point};
  handle.radius = options.grab_radius.value_or(grab_share * size);
  // A free body follows within about 0.1 s. An elastic one is pressed in by about half of the way
  // of the mouse: a disc of radius r meets the stiffness 4 mu r / (1 - nu).
  const double free = 400 * of.mass, pressed = 8 * mean_of(of.shear_modulus) * handle.radius;
  handle.stiffness = options.grab_stiffness.value_or(std::max({free, pressed, 1e-9}));
  handle.damping = 0.2 * std::sqrt(handle.stiffness * of.mass);
  return handle;
}

}  // namespace tetwarp::view
