/// @file cubic_ccd.hpp
/// The usual coplanarity test, as a mutant: four points are coplanar at the roots of a cubic, and
/// meet there if coordinates are within a tolerance. It misses meetings in one plane.
#pragma once
#include "tests/collide/constructed_hits.hpp"

namespace tetwarp::test {

/// @returns the first time at which the features meet, or 2
double cubic_time(const MovingPair& pair, bool edges, double tolerance);

}  // namespace tetwarp::test
