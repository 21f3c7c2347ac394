/// @file position_probe.hpp
/// Errors of the positions at which a warp samples the source [voxel]: those of rounding the nodes
/// and those of evaluating the maps, separately.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/brute_force.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {

using Real3 = std::array<long double, 3>;
using TetReals = std::array<Real3, 4>;

/// Triangle wave between -2 and 2 with corners on every fourth voxel. Linear interpolation of it is
/// exact and its slope is 1, so an error e of a sample is an error e of its position; float32 holds
/// it to 2^-24 however far the voxel is from the origin.
inline double wave(long double x) {
  return static_cast<double>(std::abs(x - 8 * std::floor(x / 8) - 4) - 2);
}

/// The wave of the voxel's own coordinate along one axis.
inline Volume wave_volume(const Grid& grid, PixelType type, std::size_t axis) {
  Volume volume = make_volume(grid, type);
  with_pixel_type(type, [&]<class T>(T) {
    T* sample = volume.samples<T>().data();
    std::array<std::int64_t, 3> ijk;
    for (ijk[2] = 0; ijk[2] < grid.dims[2]; ++ijk[2]) {
      for (ijk[1] = 0; ijk[1] < grid.dims[1]; ++ijk[1]) {
        for (ijk[0] = 0; ijk[0] < grid.dims[0]; ++ijk[0]) {
          *sample++ = static_cast<T>(std::abs(ijk[axis] % 8 - 4) - 2);
        }
      }
    }
  });
  return volume;
}

/// A warped wave per axis, and the owners of the voxels.
struct Probed {
  PixelType type;
  std::array<std::int64_t, 3> begin;  ///< first voxel of the output, in the output grid
  std::array<std::int64_t, 3> dims;
  std::array<std::vector<double>, 3> samples;
  std::vector<std::int32_t> owner;
  Counts counts;
};

/// The three waves warped at once, one component each: the path that plain images take.
inline Probed probe(const scenes::Scene& scene,
                    Backend backend,
                    PixelType type,
                    WarpOptions options = {}) {
  options.backend = backend;
  options.output_grid = scene.output_grid;
  std::array<Volume, 3> sources, outputs;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sources[axis] = wave_volume(scene.source_grid, type, axis);
  }
  Warper warper(std::vector<VolumeView>(sources.begin(), sources.end()), scene.mesh, options);
  std::array<void*, 3> targets;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    outputs[axis] = make_volume(warper.output_grid(), type);
    targets[axis] = outputs[axis].data.data();
  }
  Probed probed;
  probed.type = type;
  if (options.region) probed.begin = options.region->begin;
  if (!options.region) probed.begin = {0, 0, 0};
  probed.dims = warper.output_grid().dims;
  probed.owner.resize(static_cast<std::size_t>(warper.output_grid().voxel_count()));
  const WarpTarget target = {.volumes = targets, .owner = probed.owner.data()};
  probed.counts = warper.step(scene.deformed, target).counts;
  for (std::size_t axis = 0; axis < 3; ++axis) probed.samples[axis] = numbers_of(outputs[axis]);
  return probed;
}

/// Calls f(voxel of the output, its i j k in the output grid, owner) for owned voxels.
template <class F>
void for_each_owned(const Probed& probed, F f) {
  std::size_t v = 0;
  for (std::int64_t k = 0; k < probed.dims[2]; ++k) {
    for (std::int64_t j = 0; j < probed.dims[1]; ++j) {
      for (std::int64_t i = 0; i < probed.dims[0]; ++i, ++v) {
        if (probed.owner[v] < 0) continue;
        const auto& b = probed.begin;
        f(v, std::array{b[0] + i, b[1] + j, b[2] + k}, static_cast<std::size_t>(probed.owner[v]));
      }
    }
  }
}

inline Real3 minus(const Real3& a, const Real3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Real3 cross(const Real3& a, const Real3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline long double dot(const Real3& a, const Real3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline long double length(const Real3& a) {
  return std::sqrt(dot(a, a));
}

/// Normal of the face opposite a node; of either sign, as long as twice the face's area.
inline Real3 face_normal(const TetReals& tet, std::size_t face) {
  const Real3& on = tet[face == 0 ? 1 : 0];
  return cross(minus(tet[face <= 1 ? 2 : 1], on), minus(tet[face == 3 ? 2 : 3], on));
}

/// Barycentric coordinate `face` of x: heights over that face of x and of its node.
inline long double barycentric(const TetReals& tet, std::size_t face, const Real3& x) {
  const Real3 normal = face_normal(tet, face);
  const Real3& on = tet[face == 0 ? 1 : 0];
  return dot(normal, minus(x, on)) / dot(normal, minus(tet[face], on));
}

/// Nodes of tetrahedron t in index space, rounded to quanta.
inline TetQuanta rounded_tet(const IndexFromWorld& map,
                             const Mesh& mesh,
                             const std::vector<Point3>& positions,
                             std::size_t t) {
  TetQuanta tet;
  for (std::size_t a = 0; a < 4; ++a) {
    tet[a] = quanta_of(map, positions[static_cast<std::size_t>(mesh.tets[t][a])]);
  }
  return tet;
}

/// The same as given, not rounded.
inline TetReals given_tet(const IndexFromWorld& map,
                          const Mesh& mesh,
                          const std::vector<Point3>& positions,
                          std::size_t t) {
  TetReals tet = {};
  for (std::size_t a = 0; a < 4; ++a) {
    const Point3& world = positions[static_cast<std::size_t>(mesh.tets[t][a])];
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const long double from_origin = static_cast<long double>(world[axis]) - map.origin[axis];
        tet[a][row] += map.linear[row][axis] * from_origin;
      }
    }
  }
  return tet;
}

inline TetReals voxels_of(const TetQuanta& tet) {
  TetReals reals;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      reals[a][axis] = static_cast<long double>(tet[a][axis]) / quanta;
    }
  }
  return reals;
}

/// The point of `rest` with the given barycentric coordinates.
inline Real3 combined(const TetReals& rest, const std::array<long double, 4>& weights) {
  Real3 x = rest[0];
  for (std::size_t a = 1; a < 4; ++a) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      x[axis] += weights[a] * (rest[a][axis] - rest[0][axis]);
    }
  }
  return x;
}

/// Source position of a voxel under the rounded nodes: exact integers, then 64 bits.
inline Real3 rounded_position(const TetQuanta& deformed,
                              const TetQuanta& rest,
                              const std::array<std::int64_t, 3>& ijk) {
  const Quanta x = voxel_center(ijk[0], ijk[1], ijk[2]);
  const auto whole = static_cast<long double>(part6(deformed, 0, deformed[0]));
  std::array<long double, 4> weights;
  for (std::size_t a = 0; a < 4; ++a) {
    weights[a] = static_cast<long double>(part6(deformed, a, x)) / whole;
  }
  return combined(voxels_of(rest), weights);
}

/// The same under the nodes as given.
inline Real3 given_position(const TetReals& deformed,
                            const TetReals& rest,
                            const std::array<std::int64_t, 3>& ijk) {
  const Real3 x = {static_cast<long double>(ijk[0]), static_cast<long double>(ijk[1]),
                   static_cast<long double>(ijk[2])};
  std::array<long double, 4> weights;
  for (std::size_t a = 0; a < 4; ++a) weights[a] = barycentric(deformed, a, x);
  return combined(rest, weights);
}

}  // namespace tetwarp::test
