/// @file row_vector-inl.hpp
/// Samples of a row as vectors: float32 arithmetic, one component. Included once per vector
/// instruction set.
///
/// A 64-bit lane holds the two neighbors along x of one voxel, loaded together; the blends along y
/// and z process both, in the order of volume_sample.hpp: equal bits.
#if defined(TETWARP_ROW_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_VECTOR_INL
#undef TETWARP_ROW_VECTOR_INL
#else
#define TETWARP_ROW_VECTOR_INL
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "host/warp/cpu/rows/row_taps-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using PairTag = hn::CappedTag<std::uint64_t, cell_edge>;  ///< one x-pair of samples per lane
using PairFloatTag = hn::Repartition<float, PairTag>;

/// Eight bytes from each of `count` samples on, by loads and shuffles.
template <std::size_t count, class T>
HWY_INLINE hn::Vec<hn::Simd<std::uint64_t, count, 0>> load_words(const T* samples,
                                                                 const std::int32_t* offset) {
  const hn::Simd<std::uint64_t, count, 0> d;
  if constexpr (count == 1) {
    return hn::LoadU(d, reinterpret_cast<const std::uint64_t*>(samples + *offset));
  } else {
    const auto low = load_words<count / 2>(samples, offset);
    return hn::Combine(d, load_words<count / 2>(samples, offset + count / 2), low);
  }
}

/// Whether a gather instruction takes less time than loads and shuffles: where it reads eight
/// pairs, on processors of Intel, with 8 % of a step. Others were not measured.
inline bool has_fast_gathers() {
#if HWY_ARCH_X86
  return hn::MaxLanes(PairTag()) == cell_edge && __builtin_cpu_is("intel") != 0;
#else
  return false;
#endif
}

/// Eight bytes from each of as many samples on as PairTag has lanes.
/// @tparam by_gather  by one instruction instead of load_words(); only with eight lanes
template <bool by_gather, class T>
HWY_INLINE hn::Vec<PairTag> gather_words(const T* samples, const std::int32_t* offset) {
  const PairTag d;
  if constexpr (!by_gather || hn::MaxLanes(d) < cell_edge) {
    return load_words<hn::MaxLanes(PairTag())>(samples, offset);
  } else {
    constexpr int shift = std::countr_zero(sizeof(T));
    const hn::RebindToSigned<PairTag> di;
    const auto voxels = hn::LoadU(hn::Rebind<std::int32_t, PairTag>(), offset);
    const auto bytes = hn::ShiftLeft<shift>(hn::PromoteTo(di, voxels));
    return hn::GatherOffset(d, reinterpret_cast<const std::uint64_t*>(samples), bytes);
  }
}

/// x-pairs of samples at offsets, as float32, two per 64-bit lane.
template <bool by_gather = false, class T>
HWY_INLINE hn::Vec<PairFloatTag> read_pairs(const T* samples, const std::int32_t* offset) {
  const PairFloatTag df;
  const auto words = gather_words<by_gather>(samples, offset);
  if constexpr (std::is_same_v<T, float>) {
    return hn::BitCast(df, words);
  } else {
    // Moves the two samples to the high ends of 32-bit lanes, then shifts them down with their
    // sign.
    const hn::Repartition<std::uint8_t, PairTag> d8;
    using Wide = std::conditional_t<std::is_signed_v<T>, std::int32_t, std::uint32_t>;
    const hn::Repartition<Wide, PairTag> dw;
    const hn::RebindToSigned<decltype(dw)> di;
    constexpr std::uint8_t none = 0x80;
    alignas(16) static constexpr std::uint8_t spread[2][16] = {
        {none, none, none, 0, none, none, none, 1, none, none, none, 8, none, none, none, 9},
        {none, none, 0, 1, none, none, 2, 3, none, none, 8, 9, none, none, 10, 11}};
    const auto order = hn::LoadDup128(d8, spread[sizeof(T) - 1]);
    const auto high = hn::BitCast(dw, hn::TableLookupBytesOr0(hn::BitCast(d8, words), order));
    return hn::ConvertTo(df, hn::BitCast(di, hn::ShiftRight<32 - 8 * sizeof(T)>(high)));
  }
}

/// a + f (b - a), and a alone where f is zero.
template <class V>
HWY_INLINE V lerp_lanes(V f, V a, V b) {
  const auto between = hn::Add(a, hn::Mul(f, hn::Sub(b, a)));
  return hn::IfThenElse(hn::Gt(f, hn::Zero(hn::DFromV<V>())), between, a);
}

/// Successive floats, each twice: once per sample of a pair.
HWY_INLINE hn::Vec<PairFloatTag> both(const float* from) {
  const PairTag d;
  const hn::Rebind<std::uint32_t, PairTag> half;
  const auto one =
      hn::PromoteTo(d, hn::BitCast(half, hn::LoadU(hn::Rebind<float, PairTag>(), from)));
  return hn::DupEven(hn::BitCast(PairFloatTag(), one));
}

/// Pairs of the voxels from `at` on, blended along y and z.
template <bool by_gather, bool is_rim, class T>
HWY_INLINE hn::Vec<PairFloatTag> blended_pairs(const SourceView<T>& view,
                                               const RowTaps<is_rim>& taps,
                                               std::size_t at) {
  const std::ptrdiff_t up = view.dims[0], far = up * view.dims[1];
  const auto pairs = [&](int line, std::ptrdiff_t distance) {
    if constexpr (is_rim) return read_pairs<by_gather>(view.data, taps.offset[line] + at);
    return read_pairs<by_gather>(view.data + distance, taps.offset[0] + at);
  };
  const auto fy = both(taps.fraction[1] + at);
  const auto near = lerp_lanes(fy, pairs(0, 0), pairs(1, up));
  const auto next = lerp_lanes(fy, pairs(2, far), pairs(3, far + up));
  return lerp_lanes(both(taps.fraction[2] + at), near, next);
}

/// Values of all units of `taps`, eight per unit.
template <bool by_gather, bool is_rim, class T>
inline void sample_units(const SourceView<T>& view,
                         bool nearest,
                         const RowTaps<is_rim>& taps,
                         float* values) {
  const PairFloatTag d;
  constexpr std::size_t pairs = hn::MaxLanes(PairTag());
  const std::size_t end = static_cast<std::size_t>(cell_edge * taps.count);
  for (std::size_t at = 0; at < end; at += 2 * pairs) {
    const std::size_t next = at + pairs < end ? at + pairs : at;
    if (nearest) {
      const auto low = read_pairs(view.data, taps.offset[0] + at);
      const auto high = read_pairs(view.data, taps.offset[0] + next);
      hn::Store(hn::ConcatEven(d, high, low), d, values + at);
      continue;
    }
    const auto low = blended_pairs<by_gather>(view, taps, at);
    const auto high = blended_pairs<by_gather>(view, taps, next);
    hn::Store(lerp_lanes(hn::Load(d, taps.fraction[0] + at), hn::ConcatEven(d, high, low),
                         hn::ConcatOdd(d, high, low)),
              d, values + at);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
