/// @file lattice_search.hpp
/// Cells of a lattice from the members of Lattice: numbers of cells, their edge, or the approximate
/// number of tetrahedra.
#pragma once
#include <functional>
#include <string>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {

struct ChosenLattice {
  LatticeFrame frame;
  TetMesh mesh;
};

/// @param place          of the choice, for messages
/// @param bounds         box that cells fill (choice by numbers)
/// @param length         its edges [m]
/// @param volume         what the tetrahedra are to fill, about [m^3]
/// @param frame_of_edge  cubes of an edge [m] that cover the box; offset in edges, 0 to 0.5, moves
///                       them
/// @param mesh_of        the tetrahedra that remain of a frame
/// @throws std::invalid_argument  too many tetrahedra
ChosenLattice choose_lattice(
    const std::string& place,
    const Lattice& choice,
    const Bounds& bounds,
    const Point3& length,
    double volume,
    const std::function<LatticeFrame(double edge, double offset)>& frame_of_edge,
    const std::function<TetMesh(const LatticeFrame&)>& mesh_of);

}  // namespace tetwarp
