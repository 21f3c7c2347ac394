/// @file row_vector-inl.hpp
/// Samples of a row as vectors: float32 arithmetic, one component. Included once per vector
/// instruction set (the name and the toggled guard are Highway's convention).
///
/// A 64-bit lane holds the two neighbours along x of one voxel, fetched together; the blends along
/// y and z work on both at once, in the order of volume_sample.hpp: equal bits.
#if defined(TETWARP_ROW_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_VECTOR_INL
#undef TETWARP_ROW_VECTOR_INL
#else
#define TETWARP_ROW_VECTOR_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cstdint>
#include <type_traits>

#include "host/row_source-inl.hpp"
#include "kernels/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Positions of some voxels of a row.
struct RowTaps {
  hn::Vec<RowIntTag> offset;   ///< of the lower neighbours [sample]
  hn::Vec<RowIntTag> step[2];  ///< from there to the upper neighbour along y and z [sample]
  hn::Vec<RowTag> fraction[3];
  hn::Mask<RowTag> inside;  ///< of the source
};

/// Positions of the vector of row (j, k) that starts at `lane` under one source. Without Rim, all
/// lie between the source's outermost centres.
template <bool Rim, class T>
inline RowTaps row_taps(const SourceView<T>& view,
                        bool nearest,
                        const RowSource<T>& source,
                        std::size_t lane,
                        int j,
                        int k) {
  const RowTag d;
  const RowIntTag di;
  RowTaps taps;
  taps.inside = hn::Eq(hn::Zero(d), hn::Zero(d));
  hn::Vec<RowIntTag> voxel[3];
  const int stride[3] = {1, view.dims[0], view.dims[0] * view.dims[1]};
  for (int axis = 0; axis < 3; ++axis) {
    const int whole = source.map().whole[axis];
    const auto x = source.position(axis, lane, j, k);
    const auto near = nearest ? hn::Add(x, hn::Set(d, 0.5f)) : x;
    const auto floor = hn::Floor(near);
    taps.fraction[axis] = hn::Sub(near, floor);
    voxel[axis] = hn::Add(hn::ConvertTo(di, floor), hn::Set(di, whole));
    if constexpr (Rim) {
      const int last = view.dims[axis] - 1;
      const auto low = hn::Set(d, -0.5f - static_cast<float>(whole) - rim_slack);
      const auto high = hn::Set(d, static_cast<float>(last - whole) + 0.5f + rim_slack);
      taps.inside = hn::And(taps.inside, hn::And(hn::Ge(x, low), hn::Le(x, high)));
      const auto blends =
          hn::And(hn::Gt(voxel[axis], hn::Set(di, -1)), hn::Lt(voxel[axis], hn::Set(di, last)));
      taps.fraction[axis] = hn::IfThenElseZero(hn::RebindMask(d, blends), taps.fraction[axis]);
      voxel[axis] = hn::Min(hn::Max(voxel[axis], hn::Zero(di)), hn::Set(di, last));
      if (axis > 0) taps.step[axis - 1] = hn::IfThenElseZero(blends, hn::Set(di, stride[axis]));
    } else if (axis > 0) {
      taps.step[axis - 1] = hn::Set(di, stride[axis]);
    }
  }
  const auto row = hn::Add(hn::Mul(voxel[2], hn::Set(di, view.dims[1])), voxel[1]);
  taps.offset = hn::Add(hn::Mul(row, hn::Set(di, view.dims[0])), voxel[0]);
  return taps;
}

/// x-pairs of samples at offsets, as float32, two per 64-bit lane.
template <class T>
inline hn::Vec<PairFloatTag> read_pairs(const T* samples,
                                        hn::Vec<hn::Rebind<std::int32_t, PairTag>> offset) {
  const PairFloatTag df;
  if constexpr (std::is_same_v<T, float>) {
    const PairIntTag di;
    const auto bytes = hn::ShiftLeft<2>(hn::PromoteTo(di, offset));
    const auto* words = reinterpret_cast<const std::int64_t*>(samples);
    return hn::BitCast(df, hn::GatherOffset(di, words, bytes));
  } else {
    // 32 bits at the lower neighbour hold both; spread them to 16-bit halves, then widen.
    const hn::Rebind<std::int32_t, PairTag> dhi;
    const hn::RebindToUnsigned<decltype(dhi)> dhu;
    const hn::RebindToSigned<PairFloatTag> di;
    const auto* words = reinterpret_cast<const std::int32_t*>(samples);
    auto word = hn::GatherOffset(dhi, words, hn::ShiftLeft < sizeof(T) == 2 ? 1 : 0 > (offset));
    if constexpr (sizeof(T) == 1) {
      const auto low = hn::And(word, hn::Set(dhi, 0xff));
      const auto high = hn::ShiftLeft<8>(hn::And(word, hn::Set(dhi, 0xff00)));
      word = hn::Or(low, high);
      if constexpr (std::is_signed_v<T>) {
        const hn::Repartition<std::int16_t, decltype(dhi)> d16;
        word = hn::BitCast(dhi, hn::ShiftRight<8>(hn::ShiftLeft<8>(hn::BitCast(d16, word))));
      }
    }
    using Half = std::conditional_t<std::is_signed_v<T>, std::int16_t, std::uint16_t>;
    const hn::Repartition<Half, decltype(dhu)> d16;
    return hn::ConvertTo(df, hn::PromoteTo(di, hn::BitCast(d16, word)));
  }
}

/// a + f (b - a), and a alone where f is zero.
inline hn::Vec<PairFloatTag> lerp_pairs(hn::Vec<PairFloatTag> f,
                                        hn::Vec<PairFloatTag> a,
                                        hn::Vec<PairFloatTag> b) {
  const auto between = hn::Add(a, hn::Mul(f, hn::Sub(b, a)));
  return hn::IfThenElse(hn::Gt(f, hn::Zero(PairFloatTag())), between, a);
}

/// Each float of one part of a row twice, for both samples of a pair.
inline hn::Vec<PairFloatTag> both(const float* from) {
  const PairTag d;
  const hn::Rebind<float, PairTag> df;
  const auto one = hn::PromoteTo(d, hn::BitCast(PairHalfTag(), hn::Load(df, from)));
  return hn::BitCast(PairFloatTag(), hn::Or(one, hn::ShiftLeft<32>(one)));
}

/// Blends pairs along x into one value per 64-bit lane and stores the values densely.
inline void store_blended(hn::Vec<PairFloatTag> pairs,
                          hn::Vec<PairFloatTag> fraction,
                          float* values) {
  const PairTag d;
  const auto right = hn::BitCast(PairFloatTag(), hn::ShiftRight<32>(hn::BitCast(d, pairs)));
  const auto value = hn::BitCast(d, lerp_pairs(fraction, pairs, right));
  const auto low = hn::And(value, hn::Set(d, 0xffffffffu));
  hn::Store(hn::TruncateTo(PairHalfTag(), low), PairHalfTag(),
            reinterpret_cast<std::uint32_t*>(values));
}

/// Eight samples of row (j, k) from sources that are RowKind::inner, or with Rim inner or rim.
/// @returns the voxels that lie inside the source
template <bool Rim, class T>
inline unsigned sample_row(const RasterJob<T>& job,
                           const RowSource<T>* sources,
                           const RowRuns& runs,
                           int j,
                           int k,
                           float* values) {
  const RowTag d;
  const RowIntTag di;
  const PairTag dp;
  const hn::Rebind<std::int32_t, PairTag> dhi;
  const SourceView<T>& view = job.source;
  const bool nearest = job.filter == Interpolation::nearest;
  unsigned inside = 0;
  alignas(64) std::int32_t offset[4][cell_edge];  ///< of lines (y, z), (y+1, z), (y, z+1), both
  alignas(64) float fraction[3][cell_edge];
  for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
    // Voxels that no run describes follow the first one: readable, their values are not used.
    RowTaps taps = row_taps<Rim>(view, nearest, sources[runs.run[0].source], lane, j, k);
    for (int r = 1; r < runs.count; ++r) {
      const auto mine = lanes_of(runs.run[r].bits, lane);
      const auto mine_int = hn::RebindMask(di, mine);
      const RowTaps more = row_taps<Rim>(view, nearest, sources[runs.run[r].source], lane, j, k);
      taps.offset = hn::IfThenElse(mine_int, more.offset, taps.offset);
      for (int axis = 0; axis < 3; ++axis) {
        taps.fraction[axis] = hn::IfThenElse(mine, more.fraction[axis], taps.fraction[axis]);
      }
      if constexpr (Rim) {
        for (int axis = 0; axis < 2; ++axis) {
          taps.step[axis] = hn::IfThenElse(mine_int, more.step[axis], taps.step[axis]);
        }
        taps.inside = hn::Or(hn::And(mine, more.inside), hn::AndNot(mine, taps.inside));
      }
    }
    inside |= Rim ? bits_of(taps.inside, lane) : 0xffu;
    const auto above = hn::Add(taps.offset, taps.step[1]);
    hn::Store(taps.offset, di, offset[0] + lane);
    hn::Store(hn::Add(taps.offset, taps.step[0]), di, offset[1] + lane);
    hn::Store(above, di, offset[2] + lane);
    hn::Store(hn::Add(above, taps.step[0]), di, offset[3] + lane);
    for (int axis = 0; axis < 3; ++axis) hn::Store(taps.fraction[axis], d, fraction[axis] + lane);
  }
  // What this row of the next cell will need: rows jump too much for the hardware to guess.
  hwy::Prefetch(view.data + offset[0][0] + sources[runs.run[0].source].ahead());
  hwy::Prefetch(view.data + offset[0][7] + sources[runs.run[0].source].ahead());
  for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(dp)) {
    const auto pairs = [&](int line) {
      return read_pairs(view.data, hn::Load(dhi, offset[line] + lane));
    };
    if (nearest) {
      store_blended(pairs(0), hn::Zero(PairFloatTag()), values + lane);
      continue;
    }
    const auto fy = both(fraction[1] + lane);
    const auto near = lerp_pairs(fy, pairs(0), pairs(1));
    const auto far = lerp_pairs(fy, pairs(2), pairs(3));
    store_blended(lerp_pairs(both(fraction[2] + lane), near, far), both(fraction[0] + lane),
                  values + lane);
  }
  return inside;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
