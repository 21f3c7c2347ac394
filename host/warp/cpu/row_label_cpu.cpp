/// @file row_label_cpu.cpp
/// Implementation by Highway, compiled once per vector instruction set, like cell_raster_cpu.cpp.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/warp/cpu/row_label_cpu.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "host/warp/cpu/row_label-inl.hpp"
#include "host/warp/cpu/row_label_batch-inl.hpp"
#include "host/warp/cpu/row_scalar.hpp"
#include "host/warp/cpu/row_taps-inl.hpp"
#include "host/warp/cpu/row_vector-inl.hpp"
#include "host/warp/cpu/row_wide_taps-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Samples of the eight neighbours of a voxel.
template <class T>
struct Neighbours {
  const T* line[4];  ///< at the lower neighbour along x on lines (y, z), (y+1, z), (y, z+1), both
  std::ptrdiff_t x;  ///< to the upper neighbour along x

  T at(int corner) const { return line[corner >> 1][(corner & 1) * x]; }

  bool are_same() const {
    std::uint64_t differ = 0;
    for (int corner = 1; corner < 8; ++corner) {
      differ |= static_cast<std::uint64_t>(at(corner)) ^ static_cast<std::uint64_t>(at(0));
    }
    return differ == 0;
  }
};

/// Writes labels of one row.
template <class T>
class LabelWriter {
 public:
  LabelWriter(const RasterJob<T>& job, const SourceShape& shape)
      : job_(job),
        shape_(shape),
        up_(shape.dims[0]),
        far_(std::ptrdiff_t{shape.dims[0]} * shape.dims[1]) {}

  /// Adds row (j, k) of one cell by float32 positions. @pre RowKind::inner, or with is_rim rim
  template <bool is_rim>
  void add_units(const RowSource* sources,
                 const RowRun* runs,
                 int count,
                 int j,
                 int k,
                 RowTaps<is_rim>& taps) {
    add_unit(shape_, false, sources, runs, count, j, k, taps);
    if (taps.count == taps.row_units) flush(taps);
  }

  template <bool is_rim>
  HWY_NOINLINE void flush(RowTaps<is_rim>& taps) {
    const T* const samples = job_.source.data;
    for (int u = 0; u < taps.count; ++u) {
      const RowUnit& unit = taps.unit[u];
      const int at = cell_edge * u;
      T* const out = job_.volume + cell_edge * unit.cell;
      for (unsigned bits = unit.inside; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits);
        out[i] = samples[taps.offset[0][at + i]];
      }
      unsigned mixed = unit.inside & differing(taps, static_cast<std::size_t>(at));
      for (; mixed != 0; mixed &= mixed - 1) {
        const int i = std::countr_zero(mixed);
        Neighbours<T> near{{}, 1};
        for (int l = 0; l < 4; ++l) {
          near.line[l] = samples + taps.offset[is_rim ? l : 0][at + i];
          if constexpr (!is_rim) near.line[l] += (l % 2) * up_ + (l / 2) * far_;
        }
        add(near, cell_edge * unit.cell + i, taps.fraction, at + i);
      }
      for (unsigned bits = unit.bits & ~unsigned{unit.inside}; bits != 0; bits &= bits - 1) {
        out[std::countr_zero(bits)] = job_.background;
      }
    }
    taps.count = 0;
  }

  /// Writes a run of row (j, k) by float64 positions.
  void write_wide(const RowSource& source, const RowRun& run, int j, int k) {
    const WideMap map(shape_, source, j, k);
    WideTaps taps;
    add_centres(shape_, map, false, 0, cell_edge, taps);
    for (unsigned bits = run.bits; bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits), place = cell_edge * run.cell + i;
      if (taps.is_inside[i] == 0) {
        job_.volume[place] = job_.background;
        continue;
      }
      const std::ptrdiff_t up = taps.fraction[1][i] > 0 ? up_ : 0;
      const std::ptrdiff_t far = taps.fraction[2][i] > 0 ? far_ : 0;
      const T* lower = job_.source.data + taps.offset[i];
      const Neighbours<T> near{{lower, lower + up, lower + far, lower + far + up},
                               taps.fraction[0][i] > 0 ? 1 : 0};
      if (near.are_same()) {
        job_.volume[place] = *lower;
      } else {
        add(near, place, taps.fraction, i);
      }
    }
  }

  /// Writes the voxels whose neighbours differ.
  HWY_NOINLINE void finish() {
    find_winners(batch_);
    for (int n = 0; n < batch_.count; ++n) {
      job_.volume[batch_.place[n]] = label_of<T>(batch_.winner[n]);
    }
    batch_.count = 0;
  }

 private:
  /// Bit v: the samples around voxel `at` + v differ. Those of a pair along x are read together,
  /// also where the upper one has no weight.
  template <bool is_rim>
  HWY_INLINE unsigned differing(const RowTaps<is_rim>& taps, std::size_t at) const {
    const PairTag d;
    constexpr std::uint64_t one = (std::uint64_t{1} << 8 * sizeof(T)) - 1;
    const auto pair = hn::Set(d, one << 8 * sizeof(T) | one);
    unsigned bits = 0;
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      const auto line = [&](int l, std::ptrdiff_t distance) {
        if constexpr (is_rim) distance = 0;
        return load_words<hn::MaxLanes(PairTag())>(job_.source.data + distance,
                                                   taps.offset[is_rim ? l : 0] + at + lane);
      };
      const auto first = line(0, 0);
      const auto differ =
          hn::Or(hn::Xor(first, line(1, up_)),
                 hn::Or(hn::Xor(first, line(2, far_)), hn::Xor(first, line(3, up_ + far_))));
      const auto along =
          hn::And(hn::Xor(first, hn::ShiftRight<8 * sizeof(T)>(first)), hn::Set(d, one));
      const auto any = hn::Or(hn::And(differ, pair), along);
      std::uint8_t part[8] = {};
      hn::StoreMaskBits(d, hn::Ne(any, hn::Zero(d)), part);
      bits |= unsigned{part[0]} << lane;
    }
    return bits;
  }

  /// Keeps a voxel for finish().
  /// @param fraction  of samples, per axis
  template <class Fractions>
  HWY_INLINE void add(const Neighbours<T>& near, int place, const Fractions& fraction, int at) {
    if (batch_.count == LabelBatch::capacity) finish();
    const int n = batch_.count++;
    batch_.place[n] = place;
    for (int corner = 0; corner < 8; ++corner) batch_.key[corner][n] = key_of(near.at(corner));
    for (int axis = 0; axis < 3; ++axis) batch_.fraction[axis][n] = double{fraction[axis][at]};
  }

  const RasterJob<T>& job_;
  const SourceShape& shape_;
  std::ptrdiff_t up_, far_;
  LabelBatch batch_;
};

/// Whether runs are written here by float32 positions, or by float64 ones for wide pixel types.
template <class T>
bool is_vectored(const SourceShape& shape, const RowSource& source) {
  if (source.setup().kind != MapKind::affine) return false;
  const double voxels = static_cast<double>(shape.dims[0]) * shape.dims[1] * shape.dims[2];
  return voxels <= std::numeric_limits<std::int32_t>::max() &&
         (sizeof(ArithmeticOf<T>) == 8 || source.kind() != RowKind::alone);
}

template <class T>
void LabelRows<T>::write(const RasterJob<T>& job,
                         const SourceShape& shape,
                         const RowSource* sources,
                         RowRun* runs,
                         int count,
                         int j,
                         int k) {
  if constexpr (!std::is_floating_point_v<T>) {
    LabelWriter<T> writer(job, shape);
    RowTaps<false> inner;
    RowTaps<true> rim;
    for (RowRun *run = runs, *past = run; run < runs + count; run = past) {
      RowKind kind = RowKind::inner;
      RowRun* unit = run;  // runs of the cell in vectors; they are moved to the front
      for (; past < runs + count && past->cell == run->cell; ++past) {
        const RowSource& source = sources[past->source];
        if (!is_vectored<T>(shape, source)) {
          ScalarRows<T>::write(job, source.map(), past->bits, j, k, cell_edge * past->cell);
        } else if constexpr (sizeof(ArithmeticOf<T>) == 8) {
          writer.write_wide(source, *past, j, k);
        } else {
          kind = std::max(kind, source.kind());
          std::swap(*unit++, *past);
        }
      }
      const int unit_count = static_cast<int>(unit - run);
      if constexpr (sizeof(ArithmeticOf<T>) == 4) {
        if (unit_count == 0) continue;
        if (kind == RowKind::inner) {
          writer.add_units(sources, run, unit_count, j, k, inner);
        } else {
          writer.add_units(sources, run, unit_count, j, k, rim);
        }
      }
    }
    if constexpr (sizeof(ArithmeticOf<T>) == 4) {
      writer.flush(inner);
      writer.flush(rim);
    }
    writer.finish();
  }
}

template struct LabelRows<std::uint8_t>;
template struct LabelRows<std::int8_t>;
template struct LabelRows<std::uint16_t>;
template struct LabelRows<std::int16_t>;
template struct LabelRows<std::uint32_t>;
template struct LabelRows<std::int32_t>;
template struct LabelRows<std::uint64_t>;
template struct LabelRows<std::int64_t>;
template struct LabelRows<float>;
template struct LabelRows<double>;

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();
