/// @file affine_device.cuh
/// The sampling floor on a device: a whole output volume through one affine map, no tetrahedra.
///
/// One block samples a tile of 8 x 8 x 8 voxels or 32 x 4 x 4, one thread four voxels along k, with
/// the arithmetic of the warp: float32 relative to the tile's corner.
#pragma once
#include <cstdint>

#include "kernels/exec/launch.hpp"
#include "kernels/warp/volume_sample.hpp"

namespace tetwarp::bench {

constexpr int floor_threads = 128;
constexpr int floor_depth = 4;  ///< voxels per thread

/// Voxels of a tile along i and j; its depth follows from threads and voxels per thread.
struct TileShape {
  int width;
  int height;
};

/// Everything the floor reads and writes.
template <class T, class Source>
struct AffineDeviceJob {
  Source source;
  int source_dims[3];
  int output_dims[3];
  double rows[3][4];  ///< source index = rows * (i, j, k, 1)
  bool blends;        ///< linear, else nearest
  TileShape shape;
  T* output;

  TETWARP_HD int tile_depth() const {
    return floor_threads / (shape.width * shape.height) * floor_depth;
  }
  TETWARP_HD int tiles(int axis) const {
    const int extent = axis == 0 ? shape.width : axis == 1 ? shape.height : tile_depth();
    return (output_dims[axis] + extent - 1) / extent;
  }
};

/// Samples in the order of memory: i fastest.
template <class T>
struct LinearSource {
  const T* data;
  int dims[3];

  TETWARP_HD T at(int i, int j, int k) const {
    return data[(std::int64_t{k} * dims[1] + j) * dims[0] + i];
  }
};

/// Samples in bricks of 8 x 4 x 4, so that neighbors along every axis share sectors.
template <class T>
struct BrickedSource {
  const T* data;
  int bricks[3];

  TETWARP_HD static int bricks_of(int extent, int axis) {
    return axis == 0 ? (extent + 7) >> 3 : (extent + 3) >> 2;
  }
  TETWARP_HD std::int64_t count() const {
    return std::int64_t{128} * bricks[0] * bricks[1] * bricks[2];
  }
  TETWARP_HD std::int64_t place(int i, int j, int k) const {
    const std::int64_t brick = (std::int64_t{k >> 2} * bricks[1] + (j >> 2)) * bricks[0] + (i >> 3);
    return brick * 128 + ((k & 3) << 5 | (j & 3) << 3 | (i & 7));
  }
  TETWARP_HD T at(int i, int j, int k) const { return data[place(i, j, k)]; }
};

/// One sample, or zero outside the source.
template <class T, class Source>
__device__ T sample_at(const AffineDeviceJob<T, Source>& job, const int* whole, const float* x) {
  int low[3], high[3];
  float fraction[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int last = job.source_dims[axis] - 1;
    const float position = job.blends ? x[axis] : x[axis] + 0.5f;
    const float lower = floorf(position);
    const int voxel = whole[axis] + static_cast<int>(lower);
    const float rim = x[axis] + static_cast<float>(whole[axis]);
    if (rim < -0.5f || rim > static_cast<float>(last) + 0.5f) return T(0);
    fraction[axis] = position - lower;
    low[axis] = min_of(max_of(voxel, 0), last);
    high[axis] = min_of(max_of(voxel + 1, 0), last);
  }
  if (!job.blends) return job.source.at(low[0], low[1], low[2]);
  float slice[2];
  for (int z = 0; z < 2; ++z) {
    const int k = z == 0 ? low[2] : high[2];
    float line[2];
    for (int y = 0; y < 2; ++y) {
      const int j = y == 0 ? low[1] : high[1];
      const auto a = static_cast<float>(job.source.at(low[0], j, k));
      const auto b = static_cast<float>(job.source.at(high[0], j, k));
      line[y] = a + fraction[0] * (b - a);
    }
    slice[z] = line[0] + fraction[1] * (line[1] - line[0]);
  }
  return rounded_to<T>(slice[0] + fraction[2] * (slice[1] - slice[0]));
}

/// Blocks: one per tile, i fastest. Threads: floor_threads. Shared: the tile's corner.
template <class T, class Source>
__global__ void __launch_bounds__(floor_threads)
    affine_kernel(const AffineDeviceJob<T, Source> job) {
  __shared__ SourceMap<float> map;
  const int width = job.shape.width, height = job.shape.height;
  const int thread = static_cast<int>(threadIdx.x), tile = static_cast<int>(blockIdx.x);
  const int corner[3] = {tile % job.tiles(0) * width, tile / job.tiles(0) % job.tiles(1) * height,
                         tile / job.tiles(0) / job.tiles(1) * job.tile_depth()};
  if (thread == 0) {
    double start[3], linear[3][3];
    for (int row = 0; row < 3; ++row) {
      start[row] = job.rows[row][3];
      for (int axis = 0; axis < 3; ++axis) {
        linear[row][axis] = job.rows[row][axis];
        start[row] += job.rows[row][axis] * corner[axis];
      }
    }
    map = make_source_map<float>(start, linear);
  }
  __syncthreads();
  const int i = thread % width, j = thread / width % height, first = thread / (width * height);
  const int step = floor_threads / (width * height);
  if (corner[0] + i >= job.output_dims[0] || corner[1] + j >= job.output_dims[1]) return;
  for (int d = 0; d < floor_depth; ++d) {
    const int k = first + d * step;
    if (corner[2] + k >= job.output_dims[2]) return;
    float x[3];
    local_position(map, i, j, k, x);
    const std::int64_t row = std::int64_t{corner[2] + k} * job.output_dims[1] + corner[1] + j;
    job.output[row * job.output_dims[0] + corner[0] + i] = sample_at(job, map.whole, x);
  }
}

}  // namespace tetwarp::bench
