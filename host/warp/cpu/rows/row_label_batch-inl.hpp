/// @file row_label_batch-inl.hpp
/// The filter for labels where the neighbors of a voxel differ, one voxel per lane. Included once
/// per vector instruction set.
#if defined(TETWARP_ROW_LABEL_BATCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_LABEL_BATCH_INL
#undef TETWARP_ROW_LABEL_BATCH_INL
#else
#define TETWARP_ROW_LABEL_BATCH_INL
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "kernels/base/view.hpp"
#include "kernels/warp/sample/volume_label.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A label as a number whose order is that of the labels, and back.
template <class T>
std::int64_t key_of(T label) {
  if constexpr (std::is_same_v<T, std::uint64_t>) {
    return static_cast<std::int64_t>(label ^ (std::uint64_t{1} << 63));
  } else {
    return static_cast<std::int64_t>(label);
  }
}
template <class T>
T label_of(std::int64_t key) {
  if constexpr (std::is_same_v<T, std::uint64_t>) {
    return static_cast<std::uint64_t>(key) ^ (std::uint64_t{1} << 63);
  } else {
    return static_cast<T>(key);
  }
}

/// Voxels whose eight neighbors do not all have one label.
struct LabelBatch {
  static constexpr int capacity = 64;

  int count = 0;
  std::int32_t place[capacity];               ///< of the voxel in the row
  alignas(64) std::int64_t key[8][capacity];  ///< of the neighbors, x fastest
  alignas(64) double fraction[3][capacity];   ///< from the lower to the upper neighbors
  alignas(64) std::int64_t winner[capacity];  ///< out
};

using ShareTag = hn::CappedTag<std::int64_t, cell_edge>;
using Share = hn::Vec<ShareTag>;

/// a b of numbers below 2^32.
HWY_INLINE Share short_product(Share a, Share b) {
  const hn::Repartition<std::uint32_t, ShareTag> half;
  return hn::BitCast(ShareTag(), hn::MulEven(hn::BitCast(half, a), hn::BitCast(half, b)));
}

/// Integer weights of the eight neighbors of the voxels from `at` on, see heaviest_label().
HWY_INLINE void find_shares(const LabelBatch& batch, std::size_t at, Share* share) {
  const ShareTag d;
  const hn::Rebind<double, ShareTag> df;
  const hn::Rebind<std::int32_t, ShareTag> di;
  constexpr int bits = 20;
  static_assert(label_steps == double{1 << bits});
  const auto all = hn::Set(d, std::int64_t{1} << bits);
  const auto upper = [&](int axis) {
    const auto steps = hn::Mul(hn::Load(df, batch.fraction[axis] + at), hn::Set(df, label_steps));
    return hn::PromoteTo(d, hn::DemoteTo(di, hn::Round(steps)));
  };
  const Share x = upper(0), y = upper(1), z = upper(2);
  Share xy[4];
  xy[3] = short_product(x, y);
  xy[2] = hn::Sub(hn::ShiftLeft<bits>(y), xy[3]);
  xy[1] = hn::Sub(hn::ShiftLeft<bits>(x), xy[3]);
  xy[0] = hn::Sub(hn::ShiftLeft<bits>(hn::Sub(all, y)), xy[1]);
  for (int n = 0; n < 4; ++n) {
    const auto high = short_product(hn::ShiftRight<bits>(xy[n]), z);
    const auto low = short_product(hn::And(xy[n], hn::Sub(all, hn::Set(d, 1))), z);
    share[4 + n] = hn::Add(hn::ShiftLeft<bits>(high), low);
    share[n] = hn::Sub(hn::ShiftLeft<bits>(xy[n]), share[4 + n]);
  }
}

/// The heavier of two labels per lane.
/// @param share  weights of the neighbors
/// @param key    labels of the neighbors
/// @param winner out; undefined if the call returns false
/// @returns whether no lane has a third label
HWY_INLINE bool heavier_of_two(const Share* share, const Share* key, Share& winner) {
  const ShareTag d;
  const auto first = key[0];
  auto second = first, sum = share[0];
  for (int n = 1; n < 8; ++n) {
    const auto is_first = hn::Eq(key[n], first);
    second = hn::IfThenElse(is_first, second, key[n]);
    sum = hn::Add(sum, hn::IfThenElseZero(is_first, share[n]));
  }
  auto has_third = hn::Ne(first, first);
  for (int n = 1; n < 8; ++n) {
    has_third = hn::Or(has_third, hn::And(hn::Ne(key[n], first), hn::Ne(key[n], second)));
  }
  const auto half = hn::Set(d, std::int64_t{1} << 59);  // of the sum of all weights
  const auto is_tie = hn::And(hn::Eq(sum, half), hn::Lt(first, second));
  winner = hn::IfThenElse(hn::Or(hn::Gt(sum, half), is_tie), first, second);
  return hn::AllFalse(d, has_third);
}

/// The heaviest of any labels per lane; of equal ones the lowest.
HWY_INLINE Share heaviest_of_all(const Share* share, const Share* key) {
  Share sum[8];
  for (int n = 0; n < 8; ++n) sum[n] = share[n];
  for (int n = 0; n < 8; ++n) {
    for (int other = n + 1; other < 8; ++other) {
      const auto is_same = hn::Eq(key[n], key[other]);
      sum[n] = hn::Add(sum[n], hn::IfThenElseZero(is_same, share[other]));
      sum[other] = hn::Add(sum[other], hn::IfThenElseZero(is_same, share[n]));
    }
  }
  auto most = sum[0], winner = key[0];
  for (int n = 1; n < 8; ++n) {
    const auto is_tie = hn::And(hn::Eq(sum[n], most), hn::Lt(key[n], winner));
    const auto wins = hn::Or(hn::Gt(sum[n], most), is_tie);
    most = hn::IfThenElse(wins, sum[n], most);
    winner = hn::IfThenElse(wins, key[n], winner);
  }
  return winner;
}

/// Sets `winner` to the labels of heaviest_label(): sums of integers are exact in any order.
HWY_NOINLINE inline void find_winners(LabelBatch& batch) {
  const ShareTag d;
  for (int n = batch.count; n % cell_edge != 0; ++n) {  // lanes of no voxel
    for (auto& key : batch.key) key[n] = 0;
    for (auto& fraction : batch.fraction) fraction[n] = 0;
  }
  for (std::size_t at = 0; at < static_cast<std::size_t>(batch.count); at += hn::Lanes(d)) {
    Share share[8], key[8], winner;
    find_shares(batch, at, share);
    for (int n = 0; n < 8; ++n) key[n] = hn::Load(d, batch.key[n] + at);
    if (!heavier_of_two(share, key, winner)) winner = heaviest_of_all(share, key);
    hn::Store(winner, d, batch.winner + at);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
