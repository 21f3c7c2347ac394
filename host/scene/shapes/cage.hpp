/// @file cage.hpp
/// Harmonic coordinates in a box: a coarse lattice whose outer nodes are moved moves the points in
/// it.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {

/// The vertices of a cage, and their weights at points inside it.
struct CageWeights {
  std::vector<Point3> vertices;  ///< outer nodes of the coarse lattice, first axis fastest
  std::vector<double> weight;    ///< [point][vertex]; not negative, of each point of sum 1
};

/// Weights that are harmonic within the cage and bilinear on its faces: they solve Laplace's
/// equation by linear elements on the five tetrahedra per box of a lattice that divides the boxes
/// of the cage. Its boxes are so near to cubes that no dihedral angle is obtuse; therefore weights
/// are not negative. Linear functions of the vertices are reproduced up to rounding.
/// @param place   of the body, for messages
/// @param bounds  the cage's box; points outside are taken at the nearest point inside
/// @param cells   of the cage along each axis; 1, 2 and 3 each make 8, 26 and 56 vertices
/// @param parts   division of the shortest edge of the cage's boxes, 3 at least
/// @throws std::invalid_argument  the lattice or the weights are too many
CageWeights make_cage_weights(const std::string& place,
                              const Bounds& bounds,
                              const std::array<std::int64_t, 3>& cells,
                              std::int64_t parts,
                              const std::vector<Point3>& points);

/// Where the points are when the vertices are at `vertices`.
std::vector<Point3> caged_points(const CageWeights& cage, const std::vector<Point3>& vertices);

}  // namespace tetwarp
