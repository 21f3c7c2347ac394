/// @file scenes.hpp
/// Seeded synthetic meshes and volumes for tests and benchmarks.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp::scenes {

/// A mesh, its deformed nodes, a source grid and an output grid.
struct Scene {
  std::string name;
  Mesh mesh;
  std::vector<Point3> deformed;
  Grid source_grid;
  Grid output_grid;
};

/// Uniform in [0, 1), from a counter: the same on every machine.
double uniform(std::uint64_t seed, std::uint64_t index);

/// Box of cells[0] x cells[1] x cells[2] cells from low to high, five tetrahedra per cell, mirrored
/// on odd cells.
Mesh lattice(const std::array<int, 3>& cells, const Point3& low, const Point3& high);

/// A grid of n voxels per axis, unit spacing, origin zero.
Grid unit_grid(std::int64_t nx, std::int64_t ny, std::int64_t nz);

/// Grid turned about two axes, anisotropic, away from the origin.
Grid oblique_grid(std::int64_t nx, std::int64_t ny, std::int64_t nz);

/// Smooth waves with noise, different per component, within the pixel type's usual range.
Volume wavy_volume(const Grid& grid, PixelType type, int components = 1);

/// value = a + b i + c j + d k, float32: a linear ramp in index space.
Volume ramp_volume(const Grid& grid, const std::array<double, 4>& coefficients);

/// Points turned by 45 degrees about z, then about x, around a center.
std::vector<Point3> rotated_45_45(const std::vector<Point3>& points, const Point3& center);

/// Points moved by smooth seeded waves of the given amplitude.
std::vector<Point3> waved(const std::vector<Point3>& points, double amplitude, std::uint64_t seed);

/// Everything shifted by an offset.
std::vector<Point3> shifted(const std::vector<Point3>& points, const Point3& offset);

/// The adversarial set on about n^3 voxels: random, aligned (all ties), half-voxel, rotated,
/// far away, slivers, folded, overlapping, tiny tetrahedra, inverted, flat, partly outside,
/// oblique.
std::vector<Scene> adversarial_scenes(std::int64_t n);

/// The scene of that name among them. Throws std::invalid_argument when there is none.
Scene adversarial_scene(std::string_view name, std::int64_t n);

/// Their names, in the order of adversarial_scenes(). Layers of slivers_k and thin_aligned_k are
/// 10^-k voxels thick.
inline constexpr std::array<std::string_view, 20> adversarial_names{
    "identity",  "aligned",        "half_voxel", "waved",          "rotated",   "tiny",
    "outside",   "oblique",        "slivers_1",  "thin_aligned_1", "slivers_3", "thin_aligned_3",
    "slivers_5", "thin_aligned_5", "soup",       "overlapping",    "folded",    "flat",
    "far",       "other_grid"};

}  // namespace tetwarp::scenes
