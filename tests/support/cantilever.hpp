/// @file cantilever.hpp
/// A beam of 1 x 0.1 x 0.1 m clamped at one end and bent by its own weight, and Timoshenko's.
#pragma once
#include <cmath>
#include <vector>

#include "tests/support/body_scenes.hpp"

namespace tetwarp::test {

struct Cantilever {
  static constexpr double length = 1, edge = 0.1, youngs_modulus = 1e6, density = 1000;
  std::int64_t across = 1;  ///< cells along the short edges; ten times as many along the beam
  double poissons_ratio = 0;
  double gravity = 1e-6;   ///< so small that the beam is linear
  double time_step = 1e4;  ///< so long that one step is static

  Scene scene() const {
    Scene scene = scene_of(time_step, 1, {0, 0, -gravity});
    scene.bodies = {elastic_box("beam", {length / 2, edge / 2, edge / 2},
                                {10 * across, across, across},
                                {youngs_modulus, poissons_ratio, density})};
    scene.bodies[0].fixed = {HalfSpaceSelection{{-1, 0, 0}, length / 2 - 1e-6}};
    return scene;
  }

  /// Mean height of the nodes of the free end.
  static double tip_height(const std::vector<Point3>& rest, const std::vector<Point3>& now) {
    double sum = 0, count = 0;
    for (std::size_t n = 0; n < rest.size(); ++n) {
      if (rest[n][0] < length / 2 - 1e-6) continue;
      sum += now[n][2];
      count += 1;
    }
    return sum / count;
  }

  /// Deflection of the tip of Timoshenko's beam with Cowper's shear coefficient.
  double beam_tip() const {
    const double area = edge * edge, second_moment = area * area / 12;
    const double line_load = density * gravity * area;
    const double shear_modulus = youngs_modulus / (2 * (1 + poissons_ratio));
    const double coefficient = 10 * (1 + poissons_ratio) / (12 + 11 * poissons_ratio);
    return line_load * std::pow(length, 4) / (8 * youngs_modulus * second_moment) +
           line_load * length * length / (2 * coefficient * shear_modulus * area);
  }
};

}  // namespace tetwarp::test
