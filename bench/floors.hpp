/// @file floors.hpp
/// What no warp can beat on this machine: copying the bytes, and sampling with no mesh at all.
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

/// How the rows of the output follow each other.
enum class RowOrder {
  lines,   ///< as they lie in memory
  bundles  ///< in bundles of 16 x 16: neighbours of a turned row find the source in the cache
};

/// The sampling floor. Every row is cut once to the part that falls into the source; that part is
/// sampled by vectors, neighbours clamped at the rim; the rest is zero.
/// @returns voxels that fall into the source
std::int64_t sample_affine(const AffineJob& job, RowOrder order, int threads);

/// The vector instructions sample_affine() uses, as Highway names them.
const char* vector_target();

}  // namespace tetwarp::bench
