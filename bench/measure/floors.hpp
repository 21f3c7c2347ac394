/// @file floors.hpp
/// Lower bounds of a warp's time on this machine: copying the bytes, and sampling without a mesh.
#pragma once
#include <array>
#include <cstdint>

#include <tetwarp/volume.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp::bench {

/// Bytes read plus bytes written per second by the faster of memcpy and streaming stores, best of
/// seven copies of 512 MiB.
double copy_bandwidth(int threads);

/// x_source = rows * (x_output, 1), both in voxels.
using AffineRows = std::array<std::array<double, 4>, 3>;

/// The inverse of a turn by `angle` [radian] about z, then about x, that takes the middle of the
/// source to the middle of the output.
AffineRows turned_about_middle(const Grid& source, const Grid& output, double angle);

/// The source position of an output position, both in voxels.
inline Point3 mapped(const AffineRows& rows, const Point3& p) {
  Point3 x;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& row = rows[axis];
    x[axis] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
  }
  return x;
}

/// A whole output volume through one affine map.
struct AffineJob {
  PixelType type;  ///< uint8, int16, float32 or float64
  Filter filter;
  std::array<std::int64_t, 3> source_dims;  ///< at least 2 each, fewer than 2^31 samples
  std::array<std::int64_t, 3> output_dims;
  const void* source;  ///< followed by four readable bytes
  void* output;
  AffineRows source_from_output;
};

/// Rows [begin_j, end_j) x [begin_k, end_k) of an output, the work of one thread at a time.
struct RowBlock {
  std::int64_t begin_j, end_j, begin_k, end_k;
};

/// The order in which the rows of the output are computed.
enum class RowOrder {
  lines,   ///< in the order of memory
  bundles  ///< in bundles of 16 x 16 rows, which share source lines in the cache under rotation
};

/// The sampling floor. Each row is clipped once to the part that falls into the source; that part
/// is sampled with vectors, neighbors clamped at the rim; the rest is zero.
/// @returns voxels that fall into the source
std::int64_t sample_affine(const AffineJob& job, RowOrder order, int threads);

/// Highway's name of the vector instructions that sample_affine() uses.
const char* vector_target();

}  // namespace tetwarp::bench
