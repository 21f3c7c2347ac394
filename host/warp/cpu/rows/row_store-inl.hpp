/// @file row_store-inl.hpp
/// Stores values in a row of the output: samples rounded to the pixel type, and copies. Included
/// once per vector instruction set.
#if defined(TETWARP_ROW_STORE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_STORE_INL
#undef TETWARP_ROW_STORE_INL
#else
#define TETWARP_ROW_STORE_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "host/warp/cpu/rows/row_taps-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

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
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      hn::StoreU(hn::Load(d, values + lane), d, out + lane);
    }
  } else {
    const auto low = hn::Set(d, static_cast<float>(std::numeric_limits<T>::min()));
    const auto high = hn::Set(d, static_cast<float>(std::numeric_limits<T>::max()));
    const hn::Rebind<T, RowTag> dt;
    T* to = bits == 0xff ? out : rounded;
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      const auto value = hn::Min(hn::Max(hn::Round(hn::Load(d, values + lane)), low), high);
      hn::StoreU(hn::DemoteTo(dt, hn::ConvertTo(RowIntTag(), value)), dt, to + lane);
    }
    if (bits == 0xff) return;
    for (; bits != 0; bits &= bits - 1) {
      out[std::countr_zero(bits)] = rounded[std::countr_zero(bits)];
    }
  }
}

/// Copies entries; merges copies whose source and destination both follow the previous ones.
template <class T>
class RunCopier {
 public:
  void add(const T* from, T* to, std::int64_t count) {
    if (from != from_ + count_ || to != to_ + count_) {
      flush();
      from_ = from;
      to_ = to;
    }
    count_ += count;
  }
  void flush() {
    std::copy_n(from_, count_, to_);
    count_ = 0;
  }

 private:
  const T* from_ = nullptr;
  T* to_ = nullptr;
  std::int64_t count_ = 0;
};

/// Writes the voxels `bits` of a row that moved by whole voxels: copies, outside of the source
/// background.
template <class T>
HWY_NOINLINE void copy_run(const RasterJob<T>& job,
                           const RowSource& source,
                           unsigned bits,
                           int j,
                           int k,
                           T* out,
                           RunCopier<T>& copier) {
  const SourceView<T>& view = job.source;
  const int components = view.components;
  const std::int64_t x = source.whole[0], y = source.whole[1] + j, z = source.whole[2] + k;
  const bool has_row = y >= 0 && y < view.dims[1] && z >= 0 && z < view.dims[2];
  const std::int64_t from = source.origin() + (std::int64_t{k} * view.dims[1] + j) * view.dims[0];
  while (bits != 0) {
    int i = std::countr_zero(bits);
    const int past = i + std::countr_one(bits >> i);
    bits &= ~0u << past;
    while (i < past) {
      const bool is_inside = has_row && x + i >= 0 && x + i < view.dims[0];
      const std::int64_t edge = x + i < 0 ? -x : is_inside ? view.dims[0] - x : past;
      const int end = static_cast<int>(std::min<std::int64_t>(past, edge));
      T* to = out + i * components;
      if (is_inside) {
        copier.add(view.data + (from + i) * components, to, std::int64_t{end - i} * components);
      } else {
        std::fill_n(to, (end - i) * components, job.background);
      }
      i = end;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
