/// @file packed_source.hpp
/// Stage "raster" of the warp on a device: a copy of the source in which the samples that linear
/// interpolation reads together lie together, so that a voxel needs four or two loads, not eight.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {

/// Rows of a PackedSample: two of types of up to two bytes.
template <class T>
constexpr int packed_rows = sizeof(T) <= 2 ? 2 : 1;

/// A sample and the next one along i, with small types also those of the next row. Behind the last
/// sample of an axis it stands again.
template <class T>
struct alignas(2 * packed_rows<T> * sizeof(T)) PackedSample {
  T at[packed_rows<T>][2];  ///< [j][i]
};

/// One index = one voxel of the source, which has one component; any order.
template <class T>
struct PackSourceOp {
  SourceView<T> source;
  View<PackedSample<T>> packed;  ///< out, in the order of the source

  TETWARP_HD void operator()(std::int64_t voxel) const {
    const std::int64_t width = source.dims[0], row = voxel / width;
    const int right = voxel - row * width < width - 1 ? 1 : 0;
    const std::int64_t up = row % source.dims[1] < source.dims[1] - 1 ? width : 0;
    PackedSample<T> sample;
    for (int y = 0; y < packed_rows<T>; ++y) {
      const T* const at = source.data + (voxel + y * up);
      sample.at[y][0] = at[0];
      sample.at[y][1] = at[right];
    }
    packed[voxel] = sample;
  }
};

/// Packs a source. Cost: three to five times its bytes, once per source. Same bits everywhere.
template <class Exec, class T>
void pack_source(Exec& exec, const PackSourceOp<T>& op) {
  exec.for_each("warp/upload", op.packed.size, op);
}

}  // namespace tetwarp
