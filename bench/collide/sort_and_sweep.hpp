/// @file sort_and_sweep.hpp
/// The plainest broad phase, to compare with: boxes of triangles sorted along x, swept, tested
/// along y and z.
#pragma once
#include <cstdint>

#include "tests/collide/collide_scenes.hpp"

namespace tetwarp::bench {

/// The number of pairs of triangles whose boxes overlap, of bodies that may touch. Boxes are those
/// of the detector's first search in a step.
/// @pre all bodies have unknowns and either all or none touch themselves
std::int64_t sort_and_sweep(const test::CollideScene& scene);

}  // namespace tetwarp::bench
