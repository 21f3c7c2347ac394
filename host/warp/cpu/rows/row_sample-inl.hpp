/// @file row_sample-inl.hpp
/// Samples of the covered voxels of a row. Included once per vector instruction set.
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
#include <utility>

#include "host/warp/cpu/rows/row_components-inl.hpp"
#include "host/warp/cpu/rows/row_hex-inl.hpp"
#include "host/warp/cpu/rows/row_label-inl.hpp"
#include "host/warp/cpu/rows/row_scalar.hpp"
#include "host/warp/cpu/rows/row_store-inl.hpp"
#include "host/warp/cpu/rows/row_transform-inl.hpp"
#include "host/warp/cpu/rows/row_vector-inl.hpp"
#include "host/warp/cpu/rows/row_wide-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Writes the sampled voxels of rows of a line of cells. The job's volume is the row to be written,
/// from voxel 0 of the line's cell 0 on.
template <class T>
class RowSampler {
 public:
  /// @param shape  of the job's source
  RowSampler(const RasterJob<T>& job, const SourceShape& shape)
      : job_(job), shape_(shape), nearest_(job.filter == Filter::nearest) {}

  /// Writes the covered voxels of row (j, k).
  /// @param hexes  those of the sources
  /// @param runs   sorted by cell; their order within a cell is changed
  void write(
      const RowSource* sources, const LineHexes& hexes, RowRun* runs, int count, int j, int k) {
    if (job_.transforms.size > 0) count = write_transformed(sources, runs, count, j, k);
    if (is_wide(job_.filter)) return write_filtered(sources, runs, count, j, k);
    for (int r = 0; r < count;) {
      int past = r + 1;
      RowKind kind = runs[r].kind;
      for (; past < count && runs[past].cell == runs[r].cell; ++past) {
        kind = std::max(kind, runs[past].kind);
      }
      if (kind >= RowKind::alone) {
        write_mixed(sources, hexes, runs + r, past - r, j, k);
      } else {
        add(kind, sources, runs + r, past - r, j, k);
      }
      r = past;
    }
    flush(inner_);
    flush(rim_);
    copier_.flush();
  }

 private:
  /// Writes the runs that have a transform; moves the others to the front. @returns their number
  int write_transformed(const RowSource* sources, RowRun* runs, int count, int j, int k) {
    write_transform_row(pixel_type_of<T>(), job_, shape_, sources, runs, count, j, k);
    const auto is_transformed = [&](const RowRun& run) {
      return has_transform(job_, sources[run.source].tet());
    };
    return static_cast<int>(std::remove_if(runs, runs + count, is_transformed) - runs);
  }

  /// Writes a cell's row of which some runs are copied or written voxel by voxel.
  HWY_NOINLINE void write_mixed(
      const RowSource* sources, const LineHexes& hexes, RowRun* runs, int count, int j, int k) {
    const RowRun* curved[cell_edge];
    int curved_count = 0;
    for (int r = 0; r < count; ++r) {
      if (runs[r].kind == RowKind::curved) curved[curved_count++] = runs + r;
    }
    if (curved_count > 0) write_curved(sources, hexes, curved, curved_count, j, k);
    if (curved_count == count) return;
    int vectored_count = 0;  // runs to write in vectors; they are moved to the front
    RowKind kind = RowKind::inner;
    for (int r = 0; r < count; ++r) {
      const RowSource& source = sources[runs[r].source];
      const int cell_row = cell_edge * runs[r].cell;
      if (source.kind() == RowKind::alone) {
        sample_alone(job_, shape_, source, runs[r].bits, j, k, cell_row);
      } else if (source.kind() == RowKind::copied) {
        unsigned bits = runs[r].bits;  // with those of following runs of the same shift
        for (; r + 1 < count && moves_alike(source, sources[runs[r + 1].source]); ++r) {
          bits |= runs[r + 1].bits;
        }
        copy_run(job_, source, bits, j, k, job_.volume + cell_row * job_.source.components,
                 copier_);
      } else if (source.kind() != RowKind::curved) {
        kind = std::max(kind, source.kind());
        std::swap(runs[vectored_count++], runs[r]);
      }
    }
    if (vectored_count > 0) add(kind, sources, runs, vectored_count, j, k);
  }

  /// Writes runs of RowKind::curved of a cell's row, those of one hexahedron together.
  /// @param runs  their order is changed
  void write_curved(const RowSource* sources,
                    const LineHexes& hexes,
                    const RowRun** runs,
                    int count,
                    int j,
                    int k) {
    const auto shape_of = [&](const RowRun* run) {
      return hexes.part(sources[run->source].hex_part()).shape;
    };
    for (const RowRun** const end = runs + count; runs < end;) {
      const int shape = shape_of(*runs);
      const RowRun** const past =
          std::partition(runs, end, [&](const RowRun* run) { return shape_of(run) == shape; });
      add_curved(sources, hexes, runs, static_cast<int>(past - runs), j, k);
      runs = past;
    }
  }

  /// Adds runs of one hexahedron in a cell's row.
  void add_curved(const RowSource* sources,
                  const LineHexes& hexes,
                  const RowRun* const* runs,
                  int count,
                  int j,
                  int k) {
    HexRow row = {};
    set_hex_row(hexes, sources, runs, count, shape_.origin, j, k, row);
    unsigned bits = 0;
    for (int r = 0; r < count; ++r) bits |= runs[r]->bits;
    const RowSource& first = sources[runs[0]->source];
    const HexReach reach = reach_of_row(shape_, row, bits);
    if (reach == HexReach::end) {
      for (int r = 0; r < count; ++r) {
        write_scalar_run(pixel_type_of<T>(), job_, sources[runs[r]->source].map(), runs[r]->bits, j,
                         k, cell_edge * runs[r]->cell);
      }
    } else if constexpr (sizeof(ArithmeticOf<T>) == 4) {
      if (reach == HexReach::inner) {
        add_hex_unit(shape_, nearest_, row, first, runs[0]->cell, bits, inner_);
        if (inner_.count == inner_.row_units) flush(inner_);
      } else {
        add_hex_unit(shape_, nearest_, row, first, runs[0]->cell, bits, rim_);
        if (rim_.count == rim_.row_units) flush(rim_);
      }
    }
  }

  void write_filtered(const RowSource* sources, RowRun* runs, int count, int j, int k) {
    int label_count = 0;  // runs to write by write_label_row(); they are moved to the front
    for (int r = 0; r < count; ++r) {
      const RowSource& source = sources[runs[r].source];
      const int cell_row = cell_edge * runs[r].cell;
      if (source.kind() == RowKind::copied) {
        copy_run(job_, source, runs[r].bits, j, k, job_.volume + cell_row * job_.source.components,
                 copier_);
      } else if (job_.filter == Filter::labels) {
        runs[label_count++] = runs[r];
      } else {
        write_scalar_run(pixel_type_of<T>(), job_, source.map(), runs[r].bits, j, k, cell_row);
      }
    }
    copier_.flush();
    if (label_count > 0)
      write_label_row(pixel_type_of<T>(), job_, shape_, sources, runs, label_count, j, k);
  }

  static bool moves_alike(const RowSource& a, const RowSource& b) {
    return b.kind() == RowKind::copied && std::equal(a.whole, a.whole + 3, b.whole);
  }

  void add(RowKind kind, const RowSource* sources, const RowRun* runs, int count, int j, int k) {
    if constexpr (sizeof(ArithmeticOf<T>) == 4) {
      if (kind == RowKind::inner) {
        add_unit(shape_, nearest_, sources, runs, count, j, k, inner_);
        if (inner_.count == inner_.row_units) flush(inner_);
      } else {
        add_unit(shape_, nearest_, sources, runs, count, j, k, rim_);
        if (rim_.count == rim_.row_units) flush(rim_);
      }
    }
  }

  /// Writes the units of `taps`. Out of line: inlined at each call, it takes long to compile.
  template <bool is_rim>
  HWY_NOINLINE void flush(RowTaps<is_rim>& taps) {
    if constexpr (sizeof(ArithmeticOf<T>) == 4) {
      if (taps.count == 0) return;
      const int components = job_.source.components;
      if (components == 1 && gathers_) {
        sample_units<true>(job_.source, nearest_, taps, values_);
      } else if (components == 1) {
        sample_units<false>(job_.source, nearest_, taps, values_);
      } else {
        sample_components(job_.source, nearest_, taps, values_);
      }
      for (int u = 0; u < taps.count; ++u) {
        const RowUnit& unit = taps.unit[u];
        const float* values = values_ + cell_edge * components * u;
        T* out = job_.volume + cell_edge * unit.cell * components;
        if (components == 1) {
          store_values(values, unit.inside, out);
        } else {
          store_components(values, unit.inside, components, out);
        }
        if constexpr (is_rim) {
          for (unsigned bits = unit.bits & ~unsigned{unit.inside}; bits != 0; bits &= bits - 1) {
            std::fill_n(out + std::countr_zero(bits) * components, components, job_.background);
          }
        }
      }
      taps.count = 0;
    }
  }

  const RasterJob<T>& job_;
  const SourceShape& shape_;
  bool nearest_;
  bool gathers_ = has_fast_gathers();
  RunCopier<T> copier_;
  RowTaps<false> inner_;
  RowTaps<true> rim_;
  alignas(64) float values_[cell_edge * RowTaps<false>::row_units * max_components + 4];
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
