/// @file shape_lattice.hpp
/// Lattices of five tetrahedra a cell in shapes, and the parts of tetrahedra inside shapes.
#pragma once
#include <array>
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {

/// A lattice with the share of each tetrahedron that is inside its shape; empty: 1.
struct ShapeLattice {
  TetMesh mesh;
  std::vector<double> fraction;
  Point3 cells_across{0, 0, 0};  ///< extent of the shape over the edges of cells
};

/// Multiplies the fractions strictly between two numbers by one factor, so that the volumes inside
/// add up to a total. None goes beyond 1; what these lack others have more.
void scale_to_total(const TetMesh& mesh,
                    double total,
                    const std::array<double, 2>& between,
                    std::vector<double>& fraction);

/// Cells that fill a box, nearly cubes if their edge or the number of tetrahedra is given.
/// @param place  of the choice, for messages
/// @throws std::invalid_argument  too many tetrahedra
ShapeLattice make_filling_lattice(const std::string& place,
                                  const Bounds& bounds,
                                  const Lattice& choice);

/// Cells fill boxes, plates and (raised as its points are) bent strips exactly. Around other shapes
/// they cover the bounds; tetrahedra without a part inside are dropped.
/// @param place  of the choice, for messages
/// @throws std::invalid_argument  too many tetrahedra
ShapeLattice make_shape_lattice(const std::string& place,
                                const Shape& shape,
                                const Lattice& choice);

}  // namespace tetwarp
