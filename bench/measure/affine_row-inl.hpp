/// @file affine_row-inl.hpp
/// One output row of the sampling floor. Included once per vector instruction set.
#if defined(TETWARP_AFFINE_ROW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_AFFINE_ROW_INL
#undef TETWARP_AFFINE_ROW_INL
#else
#define TETWARP_AFFINE_ROW_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "bench/measure/floors.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Samples one row in strips: positions by vectors, neighbors by scalar reads, which are faster
/// than gather instructions on many processors, blends by vectors.
template <class T>
class RowSampler {
 public:
  using Number = std::conditional_t<std::is_same_v<T, double>, double, float>;

  /// A row of the output: voxel i lies at base + i step in the source.
  RowSampler(const AffineJob& job, const double* base)
      : job_(job), samples_(static_cast<const T*>(job.source)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      base_[axis] = static_cast<Number>(base[axis]);
      step_[axis] = static_cast<Number>(job.source_from_output[axis][0]);
    }
  }

  /// Writes voxels [begin, end) of the row that starts at `row`.
  void sample(std::int64_t begin, std::int64_t end, T* row) {
    for (std::int64_t i = begin; i < end; i += strip) {
      const std::int64_t count = std::min(strip, end - i);
      locate(i, count);
      if (job_.filter == Filter::nearest) {
        for (std::int64_t s = 0; s < count; ++s) row[i + s] = samples_[offset_[s]];
        continue;
      }
      fetch(count);
      blend(count, row + i);
    }
  }

 private:
  using Tag = hn::ScalableTag<Number>;
  using Vec = hn::Vec<Tag>;
  using OffsetTag = hn::Rebind<std::int32_t, Tag>;
  static constexpr std::int64_t strip = 64;
  static constexpr std::int64_t lanes = hn::MaxLanes(Tag());
  static_assert(strip % lanes == 0);

  /// Offsets of the lower neighbors, and the fractions beyond them.
  HWY_INLINE void locate(std::int64_t begin, std::int64_t count) {
    const Tag d;
    const OffsetTag di;
    for (std::int64_t s = 0; s < count; s += lanes) {
      const Vec i = hn::Iota(d, static_cast<Number>(begin + s));
      hn::Vec<OffsetTag> offset = hn::Zero(di);
      for (std::size_t axis = 3; axis-- > 0;) {
        const auto dims = static_cast<std::int32_t>(job_.source_dims[axis]);
        const Vec last = hn::Set(d, static_cast<Number>(dims - 1));
        const Vec x = hn::MulAdd(i, hn::Set(d, step_[axis]), hn::Set(d, base_[axis]));
        const Vec inside = hn::Min(hn::Max(x, hn::Zero(d)), last);
        Vec low = hn::Floor(hn::Add(inside, hn::Set(d, Number{0.5})));
        if (job_.filter == Filter::linear) {
          low = hn::Min(hn::Floor(inside), hn::Sub(last, hn::Set(d, Number{1})));
          hn::Store(hn::Sub(inside, low), d, fraction_[axis] + s);
        }
        offset = hn::Add(hn::Mul(offset, hn::Set(di, dims)), whole(low));
      }
      hn::Store(offset, di, offset_ + s);
    }
  }

  HWY_INLINE static hn::Vec<OffsetTag> whole(Vec low) {
    if constexpr (sizeof(Number) == 8) {
      return hn::DemoteTo(OffsetTag(), low);
    } else {
      return hn::ConvertTo(OffsetTag(), low);
    }
  }

  /// Reads both neighbors along x on each of the four surrounding lines.
  HWY_INLINE void fetch(std::int64_t count) {
    const std::int64_t row = job_.source_dims[0], slice = row * job_.source_dims[1];
    for (std::int64_t s = 0; s < count; ++s) {
      const T* const low = samples_ + offset_[s];
      std::memcpy(&pairs_[0][2 * s], low, 2 * sizeof(T));
      std::memcpy(&pairs_[1][2 * s], low + row, 2 * sizeof(T));
      std::memcpy(&pairs_[2][2 * s], low + slice, 2 * sizeof(T));
      std::memcpy(&pairs_[3][2 * s], low + slice + row, 2 * sizeof(T));
    }
  }

  HWY_INLINE void blend(std::int64_t count, T* out) const {
    const Tag d;
    for (std::int64_t s = 0; s < count; s += lanes) {
      const Vec fx = hn::Load(d, fraction_[0] + s);
      const Vec fy = hn::Load(d, fraction_[1] + s);
      const Vec fz = hn::Load(d, fraction_[2] + s);
      Vec a[4], b[4];
      for (std::size_t line = 0; line < 4; ++line)
        load_pairs(pairs_[line] + 2 * s, a[line], b[line]);
      const Vec low = lerp(fz, lerp(fy, a[0], a[1]), lerp(fy, a[2], a[3]));
      const Vec high = lerp(fz, lerp(fy, b[0], b[1]), lerp(fy, b[2], b[3]));
      const Vec value = lerp(fx, low, high);
      if (s + lanes <= count) {
        store(value, out + s);
      } else {
        T part[lanes];
        store(value, part);
        std::copy_n(part, count - s, out + s);
      }
    }
  }

  HWY_INLINE static Vec lerp(Vec fraction, Vec a, Vec b) {
    return hn::MulAdd(fraction, hn::Sub(b, a), a);
  }

  /// Lower and upper neighbors of a vector of voxels.
  HWY_INLINE static void load_pairs(const T* pairs, Vec& a, Vec& b) {
    const Tag d;
    if constexpr (std::is_floating_point_v<T>) {
      const Vec first = hn::Load(d, pairs), second = hn::Load(d, pairs + lanes);
      a = hn::ConcatEven(d, second, first);
      b = hn::ConcatOdd(d, second, first);
    } else if constexpr (sizeof(T) == 2) {
      const OffsetTag di;
      const auto both = hn::Load(di, reinterpret_cast<const std::int32_t*>(pairs));
      a = hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(both)));
      b = hn::ConvertTo(d, hn::ShiftRight<16>(both));
    } else {
      const hn::Rebind<std::uint16_t, Tag> half;
      const OffsetTag di;
      const auto both =
          hn::PromoteTo(di, hn::Load(half, reinterpret_cast<const std::uint16_t*>(pairs)));
      a = hn::ConvertTo(d, hn::And(both, hn::Set(di, 0xff)));
      b = hn::ConvertTo(d, hn::ShiftRight<8>(both));
    }
  }

  HWY_INLINE static void store(Vec values, T* out) {
    if constexpr (std::is_floating_point_v<T>) {
      hn::StoreU(values, Tag(), out);
    } else {  // weighted means stay within the type
      const hn::Rebind<T, Tag> narrow;
      hn::StoreU(hn::DemoteTo(narrow, hn::NearestInt(values)), narrow, out);
    }
  }

  const AffineJob& job_;
  const T* samples_;
  Number base_[3];
  Number step_[3];
  alignas(64) std::int32_t offset_[strip];
  alignas(64) Number fraction_[3][strip];
  alignas(64) T pairs_[4][2 * strip];
};

/// The voxels [begin, end) of row (j, k) that fall into the source.
inline void clip_row(const AffineJob& job,
                     const double* base,
                     std::int64_t& begin,
                     std::int64_t& end) {
  double low = 0, high = static_cast<double>(job.output_dims[0] - 1);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step = job.source_from_output[axis][0];
    const double from = -0.5 - base[axis];
    const double to = static_cast<double>(job.source_dims[axis]) - 0.5 - base[axis];
    if (std::abs(step) < 1e-12) {
      if (from > 0 || to < 0) high = -1;
      continue;
    }
    low = std::max(low, std::min(from / step, to / step));
    high = std::min(high, std::max(from / step, to / step));
  }
  begin = static_cast<std::int64_t>(std::ceil(low));
  end = static_cast<std::int64_t>(std::floor(high)) + 1;
  if (low > high || begin >= end) begin = end = 0;
}

/// Writes row (j, k) of the output: background, samples, background.
/// @returns voxels that fall into the source
template <class T>
inline std::int64_t sample_row(const AffineJob& job, std::int64_t j, std::int64_t k) {
  double base[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& row = job.source_from_output[axis];
    base[axis] = row[1] * static_cast<double>(j) + row[2] * static_cast<double>(k) + row[3];
  }
  std::int64_t begin, end;
  clip_row(job, base, begin, end);
  const std::int64_t dims = job.output_dims[0];
  T* const out = static_cast<T*>(job.output) + (k * job.output_dims[1] + j) * dims;
  std::fill(out, out + begin, T{0});
  std::fill(out + end, out + dims, T{0});
  RowSampler<T>(job, base).sample(begin, end, out);
  return end - begin;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp::bench
HWY_AFTER_NAMESPACE();

#endif  // guard
