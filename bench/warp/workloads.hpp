/// @file workloads.hpp
/// The measured inputs: meshes, deformations and images from formulas and counter-based noise.
///
/// Unit spacing, voxel centers on integers; a mesh is a box of cells, five tetrahedra each; the
/// output grid is the integer bounding box of the deformed mesh.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/volume.hpp>

#include "bench/measure/buffer.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::bench {

/// How the nodes move.
enum class Deformation {
  ties,      ///< by whole voxels, planes of the mesh through voxel centers: all kinds of ties
  shift,     ///< by whole voxels, planes of the mesh between voxel centers
  bend,      ///< twisted about z, bent along x, a wave along z
  rotation,  ///< 45 degrees about z, then 45 degrees about x
  modes,     ///< 18 smooth sine modes, none of them inverts a tetrahedron
  swim       ///< sections of a fish move sideways and turn
};

/// A named input.
struct Workload {
  std::string name;
  std::array<std::int64_t, 3> dims;  ///< of the source volume
  std::array<int, 3> cells;
  Deformation deformation;

  int tet_count() const { return 5 * cells[0] * cells[1] * cells[2]; }
};

/// The inputs by number: W0 ties, W1 torso, W2 a rotated n^3 volume, W3 an n^3 volume in few or
/// many tetrahedra, W4 a long fish, W5 a volume moved by whole voxels, W6 an orange. Sizes and
/// numbers of tetrahedra of torso, fish and orange are those of Gascon et al. 2013, as are those of
/// W2.
Workload ties_128();
Workload torso_700();
/// @param tets  5 k^3; named after them unless there are 1,080
Workload rotated(std::int64_t n, int tets = 1080);
Workload waved(std::int64_t n, int tets);  ///< tets: one of waved_tet_counts
Workload fish_35();
Workload shifted_256();
Workload orange_160();
inline constexpr std::array waved_tet_counts{40, 320, 1080, 5000, 50000, 500000};

/// Mesh, deformed nodes and grids of a workload.
scenes::Scene make_scene(const Workload& workload);

/// Content of a source volume.
enum class Image {
  textured,  ///< waves and noise everywhere: no two neighbors are equal
  in_air     ///< the same within an ellipsoid that fills 41 % of the grid, zero around it
};

/// Width of the values of an image: 1 for floating point, 4000 for 16 bits, 254 for 8.
double range_of(PixelType type);

/// Samples of an image: uint8, int16, float32 or float64; components differ by their noise.
/// @throws std::invalid_argument for other pixel types
Buffer make_image(const Grid& grid, PixelType type, Image image, int components = 1);

/// The nodes, of which a `share`, those nearest to the middle of the mesh, moves by up to half a
/// voxel per axis.
std::vector<Point3> nudged_center(const std::vector<Point3>& nodes, double share);

}  // namespace tetwarp::bench
