/// @file brute_force_pairs.hpp
/// All pairs of features of a scene, tested one by one.
#pragma once
#include <vector>

#include "tests/collide/collide_scenes.hpp"

namespace tetwarp::test {

/// What Detector::detect() has to return.
std::vector<TouchingPair> detected_by_force(const CollideScene& scene);
/// What Detector::check() has to return.
std::vector<TouchingPair> checked_by_force(const CollideScene& scene);
/// What Detector::closest() has to return for the start of the motion.
ClosestPair closest_by_force(const CollideScene& scene, double cap);

}  // namespace tetwarp::test
