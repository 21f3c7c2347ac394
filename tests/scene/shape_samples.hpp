/// @file shape_samples.hpp
/// One shape of each kind.
#pragma once
#include <string>
#include <tetwarp/scene.hpp>
#include <utility>
#include <vector>

namespace tetwarp::scene_checks {

inline std::vector<std::pair<std::string, Shape>> named_shapes() {
  return {{"box", BoxShape{{0.3, 0.2, 0.1}}},
          {"sphere", EllipsoidShape{{0.5, 0.5, 0.5}}},
          {"ellipsoid", EllipsoidShape{{0.07, 0.02, 0.05}}},
          {"capsule", CapsuleShape{0.2, 0.7}},
          {"round capsule", CapsuleShape{0.2, 0}},
          {"cylinder", CylinderShape{0.3, 0.5}},
          {"torus", TorusShape{0.014, 0.006}},
          {"arc", ArcShape{0.06, 0.014, {0.2, 2.2}}},
          {"long arc", ArcShape{1, 0.1, {-1, 4.5}}},
          {"bent strip", BentStripShape{0.06, 0.012, 0.014, -0.008}},
          {"plate", PlateShape{{0.1, 0.12, 0.012}}}};
}

}  // namespace tetwarp::scene_checks
