/// @file make.hpp
/// Things to warp and to look at: embedding lattices, procedural deformations, a phantom, pictures.
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
  std::optional<double> threshold =
      {};                  ///< foreground: any component > threshold; nothing: every voxel
  bool hexahedra = false;  ///< the cells themselves instead of tetrahedra
};

/// Lattice of cubic cells around the foreground's bounding box (half a voxel beyond its outermost
/// centres), five tetrahedra per cell, mirrored on odd cells so that faces match, all with positive
/// volume; tetrahedra whose cell holds no foreground voxel are dropped, and unused nodes with them.
/// The lattice follows the grid's axes. Throws std::invalid_argument when there is no foreground.
TETWARP_EXPORT Mesh make_lattice_mesh(const Volume& volume, const LatticeOptions& options = {});

/// Kinds of procedural deformation.
enum class Deformation { twist, bend, swim, random, rotate, translate };

/// Choices of deform_positions().
struct DeformOptions {
  Deformation kind = Deformation::twist;
  double amount =
      1.0;       ///< strength: turns/4 for twist, bend, rotate; share of the box for the others
  int axis = 2;  ///< 0, 1, 2: axis of twist, bend, swim and rotate, [world]
  std::uint64_t seed = 1;  ///< of random
  Point3 offset{0, 0, 0};  ///< of translate [world]
};

/// Node positions at phase `time` in [0, 1] of a smooth deformation about the box of the rest
/// positions; time 0 is rest, time 1 the full amount. Deterministic.
TETWARP_EXPORT std::vector<Point3> deform_positions(const Mesh& mesh,
                                                    const DeformOptions& options,
                                                    double time);

/// A torso with ribs, spine, lungs, heart and vessels: analytic, deterministic, float32 in [0, 1].
/// x points to the left of the body, y to its back, z to its head; the box is 384 x 240 x 366 mm
/// about the origin for every dims.
/// @param dims  voxels
TETWARP_EXPORT Volume make_phantom(const std::array<std::int64_t, 3>& dims = {256, 160, 122});

/// An 8-bit RGB picture, rows from top to bottom.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3
};

/// Choices of render().
struct RenderOptions {
  std::optional<double> low = {};   ///< shown black; nothing: 1st percentile
  std::optional<double> high = {};  ///< shown white; nothing: 99.5th percentile
  int height = 360;                 ///< of each panel [pixel]
};

/// Three orthogonal middle slices and a maximum-intensity projection side by side, one row per
/// volume, in true proportions (spacing respected), all with the first volume's window.
/// Throws std::invalid_argument when there is no volume.
TETWARP_EXPORT Image render(std::span<const Volume* const> volumes,
                            const RenderOptions& options = {});

}  // namespace tetwarp
