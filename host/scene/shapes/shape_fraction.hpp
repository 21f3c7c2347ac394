/// @file shape_fraction.hpp
/// The parts of tetrahedra that are inside a shape.
#pragma once
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {

/// Per tetrahedron the volume inside over its own volume: 0 exactly where it is certainly outside,
/// 1 exactly where it is certainly inside. Tetrahedra that the surface may cross are divided in
/// eight until their edges are at most about `resolution` (12 times at most); in these the level of
/// the shape is interpolated linearly, corrected for its mean curvature.
std::vector<double> fractions_inside(const Shape& shape, const TetMesh& mesh, double resolution);

}  // namespace tetwarp
