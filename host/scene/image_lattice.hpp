/// @file image_lattice.hpp
/// Lattices of five tetrahedra a cell around the foreground of an image.
#pragma once
#include <string>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {

struct ImageLattice {
  TetMesh mesh;
  Point3 cells_across{0, 0, 0};  ///< extent of the foreground over the edges of cells
  bool has_small_cells = false;  ///< an edge of cells is shorter than 16 voxels
};

/// The box of the voxels that are foreground. @param place  of the volume, for messages
/// @throws std::invalid_argument  there is none
Region foreground_box(const std::string& place, const ImageGeometry& image);

/// Cells along the axes of the grid that cover the box of the foreground, half a voxel beyond its
/// outermost centers. Kept are the tetrahedra that own a voxel of the foreground, or of small
/// cells those that share the box of one: so every voxel of the foreground has an owner, or is
/// covered whole.
/// @param body_place  of the body, for messages
/// @throws std::invalid_argument  no foreground, too many tetrahedra
ImageLattice make_image_lattice(const std::string& body_place,
                                const ImageGeometry& image,
                                const Lattice& choice);

}  // namespace tetwarp
