/// @file make.hpp
/// Input for warps, and pictures of results: lattice meshes, procedural deformations, a phantom
/// volume, rendering.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Choices of make_lattice_mesh().
struct LatticeOptions {
  int cells = 8;  ///< cubic cells along the longest side of the foreground's box, >= 1
  /// Voxels with any component above it are foreground; without a value all voxels are.
  std::optional<double> threshold = {};
  bool hexahedra = false;  ///< true: one hexahedron per cell; false: five tetrahedra
};

/// A mesh of cubic cells, along the axes of the grid, that covers the bounding box of the
/// foreground (half a voxel beyond its outermost centres). Cells without a foreground voxel are
/// left out. Each cell is divided into five tetrahedra of positive volume, mirrored from cell to
/// cell so that the triangles of shared faces match.
/// @throws std::invalid_argument when there is no foreground or `cells` is less than 1
TETWARP_EXPORT Mesh make_lattice_mesh(const Volume& volume, const LatticeOptions& options = {});

/// Kinds of procedural deformation. The box is that of the rest positions.
enum class Deformation {
  twist,     ///< the ends of the axis turn in opposite directions, by half the angle each
  bend,      ///< the axis becomes an arc
  swim,      ///< a wave travels along the axis; cross-sections shift sideways
  random,    ///< a smooth sum of sine waves that does not invert anything at amount 1
  rotate,    ///< a rigid turn about the axis through the middle of the box
  translate  ///< a rigid shift by DeformOptions::offset
};

/// Choices of deform_positions().
struct DeformOptions {
  Deformation kind = Deformation::twist;
  /// Strength: quarter turns for twist, bend and rotate; relative to the box for swim and random;
  /// not used by translate.
  double amount = 1.0;
  int axis = 2;            ///< of twist, bend, swim and rotate: 0 x, 1 y, 2 z [world]
  std::uint64_t seed = 1;  ///< for random
  Point3 offset{0, 0, 0};  ///< for translate, at time 1 [world]
};

/// Node positions of a smooth deformation. Equal arguments give equal positions.
/// @param time  0 to 1: at 0 the rest positions, at 1 the full amount
/// @throws std::invalid_argument when the mesh, an option or the time is invalid
TETWARP_EXPORT std::vector<Point3> deform_positions(const Mesh& mesh,
                                                    const DeformOptions& options,
                                                    double time);

/// A torso with ribs, spine, lungs, heart and vessels, made of analytic shapes: float32 from 0 to
/// 1, the same for the same dims. x points to the left of the body, y to its back, z to its head;
/// the grid covers 384 x 240 x 366 mm around the origin for any dims.
/// @param dims  voxels
TETWARP_EXPORT Volume make_phantom(const std::array<std::int64_t, 3>& dims = {256, 160, 122});

/// An 8-bit RGB picture, rows from top to bottom.
struct Image {
  int width = 0;                  ///< [pixel]
  int height = 0;                 ///< [pixel]
  std::vector<std::uint8_t> rgb;  ///< width * height * 3
};

/// Choices of render().
struct RenderOptions {
  std::optional<double> low = {};   ///< value shown black; without one the 1st percentile
  std::optional<double> high = {};  ///< value shown white; without one the 99.5th percentile
  int height = 360;                 ///< of each panel [pixel]
};

/// Draws three orthogonal middle slices and a maximum-intensity projection of each volume side by
/// side, one row per volume; of a volume of a single slice that slice alone. Panels have the
/// proportions of the volume in the world; all rows share the gray window of the first volume.
/// @param volumes  on any grids; for several components their Euclidean norm is drawn
/// @throws std::invalid_argument when there is no volume, or an option is out of range
TETWARP_EXPORT Image render(std::span<const Volume* const> volumes,
                            const RenderOptions& options = {});

}  // namespace tetwarp
