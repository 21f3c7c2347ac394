/// @file row_label_writer-inl.hpp
/// The filter for labels over the voxels of a row: where all neighbors have one label it is
/// copied, the other voxels are collected for row_label_batch-inl.hpp. Included once per vector
/// instruction set.
#if defined(TETWARP_ROW_LABEL_WRITER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_LABEL_WRITER_INL
#undef TETWARP_ROW_LABEL_WRITER_INL
#else
#define TETWARP_ROW_LABEL_WRITER_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "host/warp/cpu/rows/row_label_batch-inl.hpp"
#include "host/warp/cpu/rows/row_taps-inl.hpp"
#include "host/warp/cpu/rows/row_vector-inl.hpp"
#include "host/warp/cpu/rows/row_wide_taps-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Samples of the eight neighbors of a voxel.
template <class T>
struct Neighbors {
  const T* line[4];  ///< at the lower neighbor along x on lines (y, z), (y+1, z), (y, z+1), both
  std::ptrdiff_t x;  ///< to the upper neighbor along x

  T at(int corner) const { return line[corner >> 1][(corner & 1) * x]; }

  bool are_same() const {
    std::uint64_t differ = 0;
    for (int corner = 1; corner < 8; ++corner) {
      differ |= static_cast<std::uint64_t>(at(corner)) ^ static_cast<std::uint64_t>(at(0));
    }
    return differ == 0;
  }
};

/// Samples around eight voxels of a row, on lines (y, z), (y+1, z), (y, z+1), (y+1, z+1).
template <class T>
struct UnitLines {
  struct Line {
    const T* start;
    const std::int32_t* offset;  ///< from `start` to the lower neighbors along x
  };
  Line line[4];

  const T* at(int l, int voxel) const { return line[l].start + line[l].offset[voxel]; }

  /// Bit v: the samples around voxel v differ. Those of a pair along x are read together, also
  /// where the upper one has no weight. @pre T has at most 32 bits
  HWY_INLINE unsigned differing() const {
    const PairTag d;
    constexpr std::uint64_t one = (std::uint64_t{1} << 8 * sizeof(T)) - 1;
    const auto pair = hn::Set(d, one << 8 * sizeof(T) | one);
    unsigned bits = 0;
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      hn::Vec<PairTag> word[4];
      for (int l = 0; l < 4; ++l) {
        word[l] = load_words<hn::MaxLanes(PairTag())>(line[l].start, line[l].offset + lane);
      }
      const auto across = hn::Or(hn::Or(hn::Xor(word[0], word[1]), hn::Xor(word[0], word[2])),
                                 hn::Xor(word[0], word[3]));
      const auto along =
          hn::And(hn::Xor(word[0], hn::ShiftRight<8 * sizeof(T)>(word[0])), hn::Set(d, one));
      const auto differ = hn::Or(hn::And(across, pair), along);
      std::uint8_t part[8] = {};
      hn::StoreMaskBits(d, hn::Ne(differ, hn::Zero(d)), part);
      bits |= unsigned{part[0]} << lane;
    }
    return bits;
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

  /// Writes the units of `taps`.
  template <bool is_rim>
  HWY_NOINLINE void flush(RowTaps<is_rim>& taps) {
    for (int u = 0; u < taps.count; ++u) {
      const RowUnit& unit = taps.unit[u];
      const int at = cell_edge * u;
      int place[cell_edge];
      for (int i = 0; i < cell_edge; ++i) place[i] = cell_edge * unit.cell + i;
      UnitLines<T> lines = lines_at(taps.offset[0] + at);
      if constexpr (is_rim) {
        for (int l = 0; l < 4; ++l) lines.line[l] = {job_.source.data, taps.offset[l] + at};
      }
      write_unit(lines, unit.inside, place, taps.fraction, at);
      write_background(unit.bits & ~unsigned{unit.inside}, place);
    }
    taps.count = 0;
  }

  /// Adds a run of row (j, k) by float64 positions.
  void add_wide(const RowSource& source, const RowRun& run, int j, int k) {
    if (wide_.count + cell_edge > WideTaps::capacity) flush_wide();
    const WideMap map(shape_, source, j, k);
    for (unsigned bits = run.bits; bits != 0;) {
      const int begin = std::countr_zero(bits), end = begin + std::countr_one(bits >> begin);
      bits &= ~0u << end;
      for (int i = begin; i < end; ++i) place_[wide_.count + i - begin] = cell_edge * run.cell + i;
      add_centers(shape_, map, false, begin, end, wide_);
      const T* samples = job_.source.data + wide_.offset[wide_.count - 1];
      fetch_next_rows(source, samples);
    }
  }

  /// Writes the runs of add_wide().
  HWY_NOINLINE void flush_wide() {
    std::fill_n(wide_.offset + wide_.count, cell_edge, 0);
    std::int32_t last = 0;
    for (int s = 0; s < wide_.count; ++s) last = std::max(last, wide_.offset[s]);
    // Of a pair along x both samples are read, also where the upper one has no weight.
    const bool is_end = last + far_ + up_ + 1 >= far_ * shape_.dims[2];
    for (int at = 0; at < wide_.count; at += cell_edge) {
      const int count = std::min(wide_.count - at, cell_edge);
      unsigned inside = 0;
      for (int i = 0; i < count; ++i) {
        inside |= static_cast<unsigned>(wide_.is_inside[at + i]) << i;
      }
      write_background(~(~0u << count) & ~inside, place_ + at);
      if constexpr (sizeof(T) == 4) {
        if (!is_end) {
          write_unit(lines_at(wide_.offset + at), inside, place_ + at, wide_.fraction, at);
          continue;
        }
      }
      write_each(inside, at);
    }
    wide_.count = 0;
  }

  /// Writes the voxels whose neighbors differ.
  HWY_NOINLINE void finish() {
    find_winners(batch_);
    for (int n = 0; n < batch_.count; ++n) {
      job_.volume[batch_.place[n]] = label_of<T>(batch_.winner[n]);
    }
    batch_.count = 0;
  }

 private:
  /// Lines around eight voxels whose neighbors are not clamped.
  /// @param offset  of the lower neighbors
  UnitLines<T> lines_at(const std::int32_t* offset) const {
    UnitLines<T> lines;
    for (int l = 0; l < 4; ++l) {
      lines.line[l] = {job_.source.data + ((l % 2) * up_ + (l / 2) * far_), offset};
    }
    return lines;
  }

  void write_background(unsigned bits, const int* place) const {
    for (; bits != 0; bits &= bits - 1) {
      job_.volume[place[std::countr_zero(bits)]] = job_.background;
    }
  }

  /// Writes the voxels `bits` of a unit.
  /// @param place     of its eight voxels in the row
  /// @param fraction  per axis, of voxel 0 at number `at`
  template <class Fractions>
  HWY_INLINE void write_unit(const UnitLines<T>& lines,
                             unsigned bits,
                             const int* place,
                             const Fractions& fraction,
                             int at) {
    for (unsigned left = bits; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      job_.volume[place[i]] = *lines.at(0, i);
    }
    for (unsigned left = bits & lines.differing(); left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      add({{lines.at(0, i), lines.at(1, i), lines.at(2, i), lines.at(3, i)}, 1}, place[i], fraction,
          at + i);
    }
  }

  /// Writes the voxels `bits` of those from number `at` on of add_wide() one by one, reading only
  /// samples that have a weight.
  void write_each(unsigned bits, int at) {
    for (; bits != 0; bits &= bits - 1) {
      const int s = at + std::countr_zero(bits);
      const std::ptrdiff_t up = wide_.fraction[1][s] > 0 ? up_ : 0;
      const std::ptrdiff_t far = wide_.fraction[2][s] > 0 ? far_ : 0;
      const T* lower = job_.source.data + wide_.offset[s];
      const Neighbors<T> near{{lower, lower + up, lower + far, lower + far + up},
                              wide_.fraction[0][s] > 0 ? 1 : 0};
      if (near.are_same()) {
        job_.volume[place_[s]] = *lower;
      } else {
        add(near, place_[s], wide_.fraction, s);
      }
    }
  }

  /// Keeps a voxel for finish().
  /// @param fraction  of samples, per axis
  template <class Fractions>
  HWY_INLINE void add(const Neighbors<T>& near, int place, const Fractions& fraction, int at) {
    if (batch_.count == LabelBatch::capacity) finish();
    const int n = batch_.count++;
    batch_.place[n] = place;
    for (int corner = 0; corner < 8; ++corner) batch_.key[corner][n] = key_of(near.at(corner));
    for (int axis = 0; axis < 3; ++axis) batch_.fraction[axis][n] = double{fraction[axis][at]};
  }

  const RasterJob<T>& job_;
  const SourceShape& shape_;
  std::ptrdiff_t up_, far_;
  WideTaps wide_;
  int place_[WideTaps::capacity];  ///< of the samples of `wide_` in the row
  LabelBatch batch_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
