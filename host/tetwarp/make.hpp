/// @file make.hpp
/// Input for warps, and pictures of results: lattice meshes, procedural deformations, a phantom
/// volume, pictures of volumes and of surfaces.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/camera.hpp>
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
/// foreground (half a voxel beyond its outermost centers). Cells without a foreground voxel are
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

/// Samples of make_orange_phantom() on the surface of the fruit.
inline constexpr double orange_phantom_threshold = 0.05;

/// An orange: an ellipsoid that fills 95 % of the grid along each axis, float32 from 0 to 1. With r
/// from 0 at the center to 1 on the surface, flesh (r^2 <= 0.85) is 1 - r^2, darker in the walls
/// between its ten segments and brighter in its seeds, always at least 0.15; rind falls from 0.14
/// to 0.05 at r = 1 and, outside, on to 0. So the isosurface at orange_phantom_threshold is the
/// ellipsoid.
/// @param dims     voxels
/// @param spacing  of voxels; the first one is centered at the origin
/// @throws std::invalid_argument as check_grid()
TETWARP_EXPORT Volume make_orange_phantom(const std::array<std::int64_t, 3>& dims,
                                          const Point3& spacing);

/// Half of the lowest level of make_fish_phantom().
inline constexpr double fish_phantom_threshold = 45;

/// A fish along k with its head at k = 0, its back towards +j and its sides towards +-i: uint8,
/// fins 90, flesh 128, spine and ribs 220, 0 outside; edges are soft. Tail and fins reach the
/// margins, 2 % of the grid along each axis.
/// @param dims     voxels
/// @param spacing  of voxels; the first one is centered at the origin
/// @throws std::invalid_argument as check_grid()
TETWARP_EXPORT Volume make_fish_phantom(const std::array<std::int64_t, 3>& dims,
                                        const Point3& spacing);

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

// ---- pictures of surfaces -------------------------------------------------------

/// A triangle mesh to draw; both sides of its triangles are seen.
struct DrawnSurface {
  std::span<const Point3> points;                          ///< [world]
  std::span<const std::array<std::int32_t, 3>> triangles;  ///< indices into points
  std::array<double, 3> color{0.5, 0.5, 0.5};              ///< red, green, blue in sRGB, 0 to 1
};

/// An unbounded plane to draw as a checker board that fades out in the distance; seen from the side
/// to which the normal points.
struct DrawnPlane {
  Point3 point{0, 0, 0};
  Point3 normal{0, 0, 1};  ///< of any length above 0
};

/// A view from the front, the right and above in which all points are seen.
/// @param points  [world]; without any: a box of edge 2 around the origin
/// @param aspect  width over height of the picture
/// @throws std::invalid_argument when a number is not finite or `aspect` is not above 0
TETWARP_EXPORT Camera camera_of(std::span<const Point3> points, double aspect);

/// Choices of render_surfaces().
struct SurfaceRenderOptions {
  Camera camera;
  int width = 960;   ///< [pixel]
  int height = 640;  ///< [pixel]
};

/// Draws surfaces in perspective with hidden parts removed: smooth normals except across creases of
/// more than 40 degrees, a light from above and the left of the camera with shadows, four samples
/// per pixel. Triangles that reach behind the eye are left out. Equal arguments give equal
/// pictures.
/// @throws std::invalid_argument when an index, a position, the camera or the size is invalid
TETWARP_EXPORT Image render_surfaces(std::span<const DrawnSurface> surfaces,
                                     std::span<const DrawnPlane> planes,
                                     const SurfaceRenderOptions& options = {});

}  // namespace tetwarp
