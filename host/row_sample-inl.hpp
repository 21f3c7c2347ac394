/// @file row_sample-inl.hpp
/// What the covered voxels of a row get. Included once per vector instruction set (the name and the
/// toggled guard are Highway's convention).
#if defined(TETWARP_ROW_SAMPLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_SAMPLE_INL
#undef TETWARP_ROW_SAMPLE_INL
#else
#define TETWARP_ROW_SAMPLE_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "host/row_source-inl.hpp"
#include "host/row_vector-inl.hpp"
#include "kernels/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Rounds eight values to T and stores those of `bits`.
template <class T>
inline void store_values(const float* values, unsigned bits, T* out) {
  const RowTag d;
  alignas(64) T rounded[cell_edge];
  if constexpr (std::is_same_v<T, float>) {
    if (bits != 0xff) {
      for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
        hn::BlendedStore(hn::Load(d, values + lane), lanes_of(bits, lane), d, out + lane);
      }
      return;
    }
    std::copy_n(values, cell_edge, out);
  } else {
    const auto low = hn::Set(d, static_cast<float>(std::numeric_limits<T>::min()));
    const auto high = hn::Set(d, static_cast<float>(std::numeric_limits<T>::max()));
    const hn::Rebind<T, RowTag> dt;
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      const auto value = hn::Min(hn::Max(hn::Round(hn::Load(d, values + lane)), low), high);
      hn::Store(hn::DemoteTo(dt, hn::ConvertTo(RowIntTag(), value)), dt, rounded + lane);
    }
    if (bits == 0xff) {
      std::copy_n(rounded, cell_edge, out);
      return;
    }
    for (; bits != 0; bits &= bits - 1) {
      out[std::countr_zero(bits)] = rounded[std::countr_zero(bits)];
    }
  }
}

/// The voxels `bits` of a row moved by whole voxels: copied where the source has them.
template <class T>
inline void copy_run(const RasterJob<T>& job,
                     const RowSource<T>& source,
                     unsigned bits,
                     int j,
                     int k,
                     std::int64_t row) {
  const SourceView<T>& view = job.source;
  const int* whole = source.map().whole;
  const int y = whole[1] + j, z = whole[2] + k;
  const bool has_row = y >= 0 && y < view.dims[1] && z >= 0 && z < view.dims[2];
  const std::int64_t from = (std::int64_t{z} * view.dims[1] + y) * view.dims[0] + whole[0];
  for (; bits != 0; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    const int x = whole[0] + i;
    T* out = job.volume + (row + i) * view.components;
    if (has_row && x >= 0 && x < view.dims[0]) {
      std::copy_n(view.data + (from + i) * view.components, view.components, out);
    } else {
      std::fill_n(out, view.components, job.background);
    }
  }
}

/// The voxels `bits` of a row one by one, in the pixel type's own arithmetic where the map allows.
template <class T>
inline void sample_alone(const RasterJob<T>& job,
                         const RowSource<T>& source,
                         unsigned bits,
                         int j,
                         int k,
                         std::int64_t row) {
  const int* corner = source.corner();
  for (; bits != 0; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    if (sizeof(ArithmeticOf<T>) == 4 && source.setup().kind == MapKind::affine) {
      store_sample(job, job.filter, source.map(), i, j, k, row + i);
    } else {
      store_owned<T, double>(job, source.setup(), corner[0], corner[1], corner[2], i, j, k,
                             row + i);
    }
  }
}

/// Writes the covered voxels of row (j, k) of a cell; its voxel 0 is at `row` of the output.
template <class T>
inline void write_row(const RasterJob<T>& job,
                      const RowSource<T>* sources,
                      const RowRuns& runs,
                      int j,
                      int k,
                      std::int64_t row) {
  RowRuns vectored;
  unsigned bits_vectored = 0;
  bool meets_rim = false;
  for (int r = 0; r < runs.count; ++r) {
    const RowSource<T>& source = sources[runs.run[r].source];
    unsigned bits = runs.run[r].bits;
    if (source.kind() != RowKind::alone) {
      vectored.run[vectored.count++] = runs.run[r];
      bits_vectored |= bits;
      meets_rim = meets_rim || source.kind() == RowKind::rim;
    } else if (is_copied(job, source.setup())) {
      copy_run(job, source, bits, j, k, row);
    } else {
      sample_alone(job, source, bits, j, k, row);
    }
  }
  if constexpr (sizeof(ArithmeticOf<T>) == 4) {
    if (vectored.count == 0) return;
    alignas(64) float values[cell_edge];
    unsigned inside = bits_vectored;
    if (meets_rim) {
      inside &= sample_row<true>(job, sources, vectored, j, k, values);
    } else {
      sample_row<false>(job, sources, vectored, j, k, values);
    }
    store_values(values, inside, job.volume + row);
    for (unsigned bits = bits_vectored & ~inside; bits != 0; bits &= bits - 1) {
      job.volume[row + std::countr_zero(bits)] = job.background;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
