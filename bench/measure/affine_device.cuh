/// @file affine_device.cuh
/// The sampling floor on a device: a whole output volume through one affine map, no tetrahedra.
///
/// One block samples a tile of 8 x 8 x 16 voxels or 32 x 4 x 8, one thread eight voxels along k, of
/// which four are in flight, with the arithmetic of the warp: float32 relative to the tile's
/// corner. Tiles that lie in the output and whose positions lie in the source have no clamps.
#pragma once
#include <cstdint>

#include "bench/measure/affine_source.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp::bench {

constexpr int floor_threads = 128;
constexpr int floor_flight = 4;  ///< voxels of a thread whose samples are loaded together
constexpr int floor_depth = 8;   ///< voxels of a thread

/// The tile of a block: its extents [voxel].
template <int tile_width, int tile_height>
struct Tile {
  static constexpr int width = tile_width, height = tile_height;
  static constexpr int layers = floor_threads / (width * height);  ///< that the threads fill
  static constexpr int depth = layers * floor_depth;
};

/// Everything the floor reads and writes.
template <class T, class Source>
struct AffineDeviceJob {
  Source source;
  int source_dims[3];
  int output_dims[3];
  double rows[3][4];  ///< source index = rows * (i, j, k, 1)
  T* output;
};

/// Blocks of a launch: one per tile.
template <class Tile, class T, class Source>
dim3 tiles_of(const AffineDeviceJob<T, Source>& job) {
  const auto tiles = [&](int axis, int extent) {
    return static_cast<unsigned>((job.output_dims[axis] + extent - 1) / extent);
  };
  return dim3(tiles(0, Tile::width), tiles(1, Tile::height), tiles(2, Tile::depth));
}

/// One sample, or zero outside the source.
template <bool blends, class T, class Source>
__device__ T sample_at(const AffineDeviceJob<T, Source>& job, const int* whole, const float* x) {
  int low[3], high[3];
  float fraction[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int last = job.source_dims[axis] - 1;
    const float position = blends ? x[axis] : x[axis] + 0.5f;
    const float lower = floorf(position);
    const int voxel = whole[axis] + static_cast<int>(lower);
    const float rim = x[axis] + static_cast<float>(whole[axis]);
    if (rim < -0.5f || rim > static_cast<float>(last) + 0.5f) return T(0);
    fraction[axis] = position - lower;
    low[axis] = min_of(max_of(voxel, 0), last);
    high[axis] = min_of(max_of(voxel + 1, 0), last);
  }
  if (!blends) return job.source.at(low[0], low[1], low[2]);
  return blended(cube_between<T>(job.source, low, high), fraction);
}

/// What the threads of a block share.
struct TilePlan {
  SourceMap<float> map;
  bool is_interior;  ///< the tile is within the output, its positions and neighbors in the source
};

template <class Tile, class T, class Source>
__device__ TilePlan plan_of(const AffineDeviceJob<T, Source>& job, const int* corner) {
  constexpr int extent[3] = {Tile::width, Tile::height, Tile::depth};
  constexpr double slack = 0.01;  // far more than the rounding of a position
  TilePlan plan;
  plan.is_interior = true;
  double start[3], linear[3][3];
  for (int row = 0; row < 3; ++row) {
    start[row] = job.rows[row][3];
    double low = -slack, high = slack;
    for (int axis = 0; axis < 3; ++axis) {
      linear[row][axis] = job.rows[row][axis];
      start[row] += job.rows[row][axis] * corner[axis];
      const double span = linear[row][axis] * (extent[axis] - 1);
      low += min_of(span, 0.0);
      high += max_of(span, 0.0);
      plan.is_interior = plan.is_interior && corner[axis] + extent[axis] <= job.output_dims[axis];
    }
    plan.is_interior =
        plan.is_interior && start[row] + low >= 0 && start[row] + high <= job.source_dims[row] - 1;
  }
  plan.map = make_source_map<float>(start, linear);
  return plan;
}

/// Blocks: one per tile. Threads: floor_threads. Shared: the tile's plan.
template <class Tile, bool blends, class T, class Source>
__global__ void __launch_bounds__(floor_threads, 8)
    affine_kernel(const AffineDeviceJob<T, Source> job) {
  __shared__ TilePlan plan;
  const int thread = static_cast<int>(threadIdx.x);
  const int corner[3] = {static_cast<int>(blockIdx.x) * Tile::width,
                         static_cast<int>(blockIdx.y) * Tile::height,
                         static_cast<int>(blockIdx.z) * Tile::depth};
  if (thread == 0) plan = plan_of<Tile>(job, corner);
  __syncthreads();
  const SourceMap<float> map = plan.map;
  const int i = thread % Tile::width, j = thread / Tile::width % Tile::height;
  const int first = thread / (Tile::width * Tile::height);
  const std::int64_t slice = std::int64_t{job.output_dims[0]} * job.output_dims[1];
  T* out = job.output +
           (slice * corner[2] + std::int64_t{job.output_dims[0]} * (corner[1] + j) + corner[0] + i);
  if (blends && plan.is_interior) {
    const auto sampler = job.source.sampler(map.whole, thread);
    float line[3];
    for (int row = 0; row < 3; ++row) {
      line[row] = mul_add(map.axis[0][row], static_cast<float>(i),
                          mul_add(map.axis[1][row], static_cast<float>(j), map.base[row]));
    }
    auto k = static_cast<float>(first);
    int places[floor_flight];  // of the voxels in flight, from the first slice of the group [voxel]
    for (int v = 0; v < floor_flight; ++v) {
      places[v] = (first + v * Tile::layers) * static_cast<int>(slice);
    }
    const std::int64_t group = floor_flight * Tile::layers * slice;
#if defined(__CUDACC__)
#pragma unroll 1
#endif
    for (; k < static_cast<float>(Tile::depth); k += floor_flight * Tile::layers) {
      InteriorTap taps[floor_flight];
      SampleCube<T> cubes[floor_flight];
      float at[3];
      for (int row = 0; row < 3; ++row) at[row] = mul_add(map.axis[2][row], k, line[row]);
      for (int v = 0; v < floor_flight; ++v) {
        float x[3];
        for (int row = 0; row < 3; ++row) {
          x[row] = v == 0
                       ? at[row]
                       : mul_add(map.axis[2][row], static_cast<float>(v * Tile::layers), at[row]);
        }
        taps[v] = interior_tap(x);
        cubes[v] = sampler.cube(taps[v]);
      }
      for (int v = 0; v < floor_flight; ++v) {
        out[places[v]] = blended(cubes[v], taps[v].fraction);
      }
      out += group;
    }
    return;
  }
  if (corner[0] + i >= job.output_dims[0] || corner[1] + j >= job.output_dims[1]) return;
  for (int k = first; k < Tile::depth; k += Tile::layers) {
    if (corner[2] + k >= job.output_dims[2]) return;
    float x[3];
    local_position(map, i, j, k, x);
    out[k * slice] = sample_at<blends>(job, map.whole, x);
  }
}

}  // namespace tetwarp::bench
