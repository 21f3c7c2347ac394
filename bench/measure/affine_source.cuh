/// @file affine_source.cuh
/// Layouts of the source of the sampling floor, and linear interpolation of eight samples.
#pragma once
#include <cstdint>

#include "kernels/warp/sample/interior_sample.hpp"

namespace tetwarp::bench {

/// Interpolated along x, then y, then z.
template <class T>
TETWARP_HD T blended(const SampleCube<T>& cube, const float* fraction) {
  float slice[2];
  for (int z = 0; z < 2; ++z) {
    float line[2];
    for (int y = 0; y < 2; ++y) {
      const auto a = static_cast<float>(cube.at[z][y][0]);
      const auto b = static_cast<float>(cube.at[z][y][1]);
      line[y] = a + fraction[0] * (b - a);
    }
    slice[z] = line[0] + fraction[1] * (line[1] - line[0]);
  }
  return rounded_to<T>(slice[0] + fraction[2] * (slice[1] - slice[0]));
}

/// The samples at the corners of the box from voxel `low` to voxel `high`.
template <class T, class Source>
TETWARP_HD SampleCube<T> cube_between(const Source& source, const int* low, const int* high) {
  SampleCube<T> cube;
  for (int z = 0; z < 2; ++z) {
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < 2; ++x) {
        cube.at[z][y][x] =
            source.at(x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]);
      }
    }
  }
  return cube;
}

/// Reads the samples around local positions from voxel `whole` on, point by point.
template <class T, class Source>
struct PointSampler {
  const Source& source;
  int whole[3];

  TETWARP_HD PointSampler(const Source& samples, const int* from)
      : source(samples), whole{from[0], from[1], from[2]} {}

  TETWARP_HD SampleCube<T> cube(const InteriorTap& tap) const {
    int low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = whole[axis] + static_cast<int>(tap.bits[axis] - integer_bits);
      high[axis] = low[axis] + 1;
    }
    return cube_between<T>(source, low, high);
  }
};

/// Samples in the order of memory: i fastest.
template <class T>
struct LinearSource {
  const T* data;
  int dims[3];

  TETWARP_HD std::int64_t place(int i, int j, int k) const {
    return (std::int64_t{k} * dims[1] + j) * dims[0] + i;
  }
  TETWARP_HD T at(int i, int j, int k) const { return data[place(i, j, k)]; }

  TETWARP_HD InteriorSource<T> sampler(const int* whole, int lane) const {
    return {data + place(whole[0], whole[1], whole[2]), dims, lane};
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
  TETWARP_HD PointSampler<T, BrickedSource> sampler(const int* whole, int) const {
    return {*this, whole};
  }
};

}  // namespace tetwarp::bench
