/// @file row_components-inl.hpp
/// Samples of a row for several components: float32 arithmetic, four components per vector.
/// Included once per vector instruction set.
#if defined(TETWARP_ROW_COMPONENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_COMPONENTS_INL
#undef TETWARP_ROW_COMPONENTS_INL
#else
#define TETWARP_ROW_COMPONENTS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "host/warp/cpu/rows/row_store-inl.hpp"
#include "host/warp/cpu/rows/row_taps-inl.hpp"
#include "host/warp/cpu/rows/row_vector-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int max_components = 9;  ///< that a volume may have

using ComponentTag = hn::FixedTag<float, 4>;  ///< components of one voxel

/// Four values from `samples` on as float32, also where the voxel has fewer components.
template <class T>
HWY_INLINE hn::Vec<ComponentTag> read_components(const T* samples) {
  const ComponentTag d;
  if constexpr (std::is_same_v<T, float>) {
    return hn::LoadU(d, samples);
  } else {
    const hn::Rebind<std::int32_t, ComponentTag> di;
    return hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(hn::Rebind<T, ComponentTag>(), samples)));
  }
}

/// Values of all units of `taps`. The blends are those of sample(), in its order: equal bits.
/// @param values  out, [voxel][component]; followed by up to three more values
template <bool is_rim, class T>
inline void sample_components(const SourceView<T>& view,
                              bool nearest,
                              const RowTaps<is_rim>& taps,
                              float* values) {
  const ComponentTag d;
  const std::ptrdiff_t components = view.components;
  const std::ptrdiff_t up = components * view.dims[0], far = up * view.dims[1];
  const int voxels = cell_edge * taps.count;
  for (int v = 0; v < voxels; ++v, values += components) {
    const T* line[4];  // (y, z), (y+1, z), (y, z+1), (y+1, z+1)
    for (int l = 0; l < 4; ++l) {
      line[l] = view.data + components * taps.offset[is_rim ? l : 0][v];
      if constexpr (!is_rim) line[l] += (l % 2) * up + (l / 2) * far;
    }
    const auto fx = hn::Set(d, taps.fraction[0][v]);
    const auto fy = hn::Set(d, taps.fraction[1][v]), fz = hn::Set(d, taps.fraction[2][v]);
    for (std::ptrdiff_t c = 0; c < components; c += 4) {
      if (nearest) {
        hn::StoreU(read_components(line[0] + c), d, values + c);
        continue;
      }
      const auto column = [&](std::ptrdiff_t at) {
        const auto near =
            lerp_lanes(fy, read_components(line[0] + at), read_components(line[1] + at));
        const auto next =
            lerp_lanes(fy, read_components(line[2] + at), read_components(line[3] + at));
        return lerp_lanes(fz, near, next);
      };
      hn::StoreU(lerp_lanes(fx, column(c), column(components + c)), d, values + c);
    }
  }
}

/// Rounds the values of one unit to T and stores the voxels `bits`.
template <class T>
inline void store_components(const float* values, unsigned bits, int components, T* out) {
  T rounded[cell_edge * max_components];
  T* to = bits == 0xff ? out : rounded;
  for (int c = 0; c < components; ++c) {
    store_values(values + cell_edge * c, 0xff, to + cell_edge * c);
  }
  if (bits == 0xff) return;
  for (; bits != 0; bits &= bits - 1) {
    const int at = std::countr_zero(bits) * components;
    std::copy_n(rounded + at, components, out + at);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
