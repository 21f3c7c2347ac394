/// @file row_resample_cpu.cpp
/// Implementation by Highway, compiled once per vector instruction set, like cell_raster_cpu.cpp.
#include "host/warp/cpu/rows/row_resample_cpu.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/warp/cpu/rows/row_resample_cpu.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "host/base/pixel_dispatch.hpp"
#include "host/warp/cpu/rows/row_field-inl.hpp"
#include "host/warp/cpu/rows/row_links-inl.hpp"
#include "host/warp/cpu/rows/row_store-inl.hpp"
#include "host/warp/cpu/rows/row_taps-inl.hpp"
#include "host/warp/cpu/rows/row_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class T>
class RowResampler {
 public:
  explicit RowResampler(const RowResampleOp<T>& op)
      : op_(op),
        links_(op.map),
        field_(op.map, op.dims[0]),
        shape_(op.job.source),
        is_nearest_(op.job.filter == Filter::nearest) {
    const SourceView<T>& source = op.job.source;
    voxels_ = std::int64_t{source.dims[0]} * source.dims[1] * source.dims[2];
    for (int row = 0; row < 3; ++row) {
      step_[row] = static_cast<float>(op.map.to_source.linear[row][0]);
      for (int axis = 0; axis < 3; ++axis) {
        from_world_[row][axis] = static_cast<float>(op.map.from_world[row][axis]);
      }
    }
  }

  /// Whether the job is one for vectors.
  bool is_vectored() const {
    return op_.may_use_vectors && shape_.is_vectored && shape_.components == 1 &&
           !is_wide(op_.job.filter) && op_.dims[0] >= cell_edge;
  }

  void run(std::int64_t row) {
    const std::int64_t j = op_.begin[0] + row % op_.dims[1], k = op_.begin[1] + row / op_.dims[1],
                       nx = op_.dims[0];
    if (field_.is_used()) {
      field_.set_row(j, k);
    } else if (links_.are_used()) {
      links_.set_row(j, k);
    }
    for (std::int64_t i = 0; i < nx; i += cell_edge) {
      // The last eight voxels may repeat some of those before them.
      add(std::min(i, nx - cell_edge), j, k, row);
    }
    flush();
  }

 private:
  /// Displacements of a vector of voxels.
  struct Vectors {
    hn::Vec<RowTag> at[3];
  };

  void add(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t row) {
    const auto at = static_cast<std::size_t>(cell_edge * taps_.count);
    unsigned inside = 0;
    if (field_.is_used()) {
      inside = add_moved(i, j, k, field_.vectors(i), at) & field_.inside(i);
    } else if (links_.are_field()) {
      EightVectors vectors;
      const unsigned not_background = links_.vectors(i, vectors);
      inside = not_background & add_direct<true>(i, j, k, at, [&](std::size_t lane, Vectors& to) {
                 for (int axis = 0; axis < 3; ++axis) {
                   to.at[axis] = hn::Load(RowTag(), vectors.at[axis] + lane);
                 }
               });
    } else if (links_.are_used()) {
      inside = add_linked(i, at);
    } else if (op_.map.has_field()) {
      inside = add_moved(i, j, k, op_.map.field.at(i, j, k), at);
    } else {
      inside = add_direct<false>(i, j, k, at, [](std::size_t, Vectors&) {});
    }
    first_[taps_.count] = row * op_.dims[0] + i;
    fetch_ahead(at);
    if (reads_past_end(at)) return store_each(at, inside, first_[taps_.count]);
    taps_.unit[taps_.count++] = {0, 0xff, static_cast<std::uint8_t>(inside)};
    if (taps_.count == RowTaps<true>::row_units) flush();
  }

  /// add_direct() by three numbers for each voxel.
  unsigned add_moved(
      std::int64_t i, std::int64_t j, std::int64_t k, const float* field, std::size_t at) {
    return add_direct<true>(i, j, k, at, [&](std::size_t lane, Vectors& to) {
      hn::LoadInterleaved3(RowTag(), field + 3 * lane, to.at[0], to.at[1], to.at[2]);
    });
  }

  /// Stores the taps of eight voxels by an affine map and their displacements.
  /// @param load  (lane, vectors): sets the displacements of a vector of voxels
  /// @returns the voxels within the source, as bits
  template <bool has_field, class Load>
  unsigned add_direct(
      std::int64_t i, std::int64_t j, std::int64_t k, std::size_t at, const Load& load) {
    const double voxel[3] = {static_cast<double>(i), static_cast<double>(j),
                             static_cast<double>(k)};
    double start[3];
    op_.map.to_source.map(voxel, start);
    float base[3];
    int whole[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = whole_voxel(start[axis]);
      base[axis] = static_cast<float>(start[axis] - lower);
      whole[axis] = static_cast<int>(lower) - op_.job.source.origin[axis];
    }
    unsigned inside = 0;
    const RowTag d;
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      Vectors vectors;
      load(lane, vectors);
      const auto steps = hn::Iota(d, static_cast<float>(lane));
      RowPositions<true> x;
      for (int axis = 0; axis < 3; ++axis) {
        auto local = hn::Add(hn::Set(d, base[axis]), hn::Mul(hn::Set(d, step_[axis]), steps));
        for (int c = 0; c < 3 && has_field; ++c) {
          local = hn::Add(local, hn::Mul(hn::Set(d, from_world_[axis][c]), vectors.at[c]));
        }
        x.local[axis] = hn::Min(hn::Max(local, hn::Set(d, -far)), hn::Set(d, far));
        x.whole[axis] = hn::Set(RowIntTag(), whole[axis]);
      }
      auto in_source = store_taps<true>(shape_, is_nearest_, x, at + lane, taps_);
      for (const auto& vector : vectors.at) {
        if (has_field) in_source = hn::And(in_source, hn::Eq(vector, vector));
      }
      inside |= bits_of(in_source, lane);
    }
    return inside;
  }

  using PositionTag = RowLinks::Tag;

  /// Coordinates of some voxels, split.
  struct Coordinates {
    hn::Vec<hn::Rebind<float, PositionTag>> local;
    hn::Vec<hn::Rebind<std::int32_t, PositionTag>> whole;
  };

  /// @param are_numbers  false in the lanes of those that are none
  template <class Mask>
  static HWY_INLINE Coordinates split(const double* at, Mask& are_numbers) {
    const PositionTag d;
    const auto any = hn::Load(d, at);
    const auto is_number = hn::Eq(any, any);
    are_numbers = hn::And(are_numbers, is_number);
    const auto x = hn::IfThenElseZero(is_number, any);
    const auto near = hn::Min(hn::Max(x, hn::Set(d, -far)), hn::Set(d, far));
    const auto lower = hn::Floor(near);
    return {hn::DemoteTo(hn::Rebind<float, PositionTag>(), hn::Sub(near, lower)),
            hn::DemoteTo(hn::Rebind<std::int32_t, PositionTag>(), lower)};
  }

  /// Both halves of a vector; the first one where that is a whole vector.
  template <class D, class Half>
  static HWY_INLINE hn::Vec<D> joined(D d, Half low, Half high) {
    if constexpr (std::is_same_v<hn::Vec<D>, Half>) {
      return low;
    } else {
      return hn::Combine(d, high, low);
    }
  }

  /// The same by links.
  unsigned add_linked(std::int64_t i, std::size_t at) {
    EightPositions position;
    const unsigned not_background = links_.positions(i, position);
    unsigned inside = 0, numbers = 0;
    const RowTag d;
    const PositionTag dd;
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      const std::size_t upper = lane + hn::Lanes(d) - hn::Lanes(dd);  // `lane` where one is enough
      auto low_numbers = hn::Eq(hn::Zero(dd), hn::Zero(dd)), high_numbers = low_numbers;
      RowPositions<true> x;
      for (int axis = 0; axis < 3; ++axis) {
        const Coordinates low = split(position.at[axis] + lane, low_numbers);
        const Coordinates high = split(position.at[axis] + upper, high_numbers);
        x.local[axis] = joined(d, low.local, high.local);
        x.whole[axis] = hn::Sub(joined(RowIntTag(), low.whole, high.whole),
                                hn::Set(RowIntTag(), op_.job.source.origin[axis]));
      }
      numbers |= RowLinks::bits_of_mask(low_numbers) << lane | RowLinks::bits_of_mask(high_numbers)
                                                                   << upper;
      inside |= bits_of(store_taps<true>(shape_, is_nearest_, x, at + lane, taps_), lane);
    }
    return inside & numbers & not_background;
  }

  /// Prefetches what the next slice of the output reads, if the source is turned little: the
  /// processor does not prefetch across this distance.
  HWY_INLINE void fetch_ahead(std::size_t at) const {
    const std::int64_t slice = std::int64_t{shape_.dims[0]} * shape_.dims[1];
    for (const std::size_t voxel : {0, cell_edge / 2}) {
      hwy::Prefetch(op_.job.source.data + taps_.offset[2][at + voxel] + slice);
    }
  }

  /// A pair of samples is read with eight bytes.
  bool reads_past_end(std::size_t at) const {
    const std::int32_t* const last = taps_.offset[3] + at;
    const std::int64_t farthest = *std::max_element(last, last + cell_edge);
    return farthest + static_cast<std::int64_t>(8 / sizeof(T)) > voxels_;
  }

  /// Stores eight voxels sample by sample: the bits of sample_units().
  /// @param at      place of their taps
  /// @param inside  those within the source, as bits
  void store_each(std::size_t at, unsigned inside, std::int64_t voxel) const {
    for (std::size_t lane = at; lane < at + cell_edge; ++lane, inside >>= 1, ++voxel) {
      T& out = op_.job.volume[voxel];
      if ((inside & 1) == 0) {
        out = op_.job.background;
        continue;
      }
      const std::int32_t lower = taps_.offset[0][lane];
      Tap<float> tap{
          true,
          {{lower, lower}, {0, taps_.offset[1][lane] - lower}, {0, taps_.offset[2][lane] - lower}},
          {}};
      for (int axis = 0; axis < 3; ++axis) tap.fraction[axis] = taps_.fraction[axis][lane];
      if (tap.fraction[0] > 0) ++tap.offset[0][1];
      out = sample(op_.job.source, op_.job.filter, tap, 0);
    }
  }

  void flush() {
    if (taps_.count == 0) return;
    if (has_fast_gathers()) {
      sample_units<true>(op_.job.source, is_nearest_, taps_, values_);
    } else {
      sample_units<false>(op_.job.source, is_nearest_, taps_, values_);
    }
    for (int u = 0; u < taps_.count; ++u) {
      T* const out = op_.job.volume + first_[u];
      const unsigned inside = taps_.unit[u].inside;
      store_values(values_ + cell_edge * u, inside, out);
      for (unsigned bits = ~inside & 0xff; bits != 0; bits &= bits - 1) {
        out[std::countr_zero(bits)] = op_.job.background;
      }
    }
    taps_.count = 0;
  }

  /// Beyond any source, so that whole numbers of it fit; NaN is in no source.
  static constexpr float far = 0x1p24f;

  const RowResampleOp<T>& op_;
  RowLinks links_;
  RowField field_;
  SourceShape shape_;
  bool is_nearest_;
  std::int64_t voxels_;
  float step_[3];  // from voxel to voxel along a row
  float from_world_[3][3];
  RowTaps<true> taps_;
  std::int64_t first_[RowTaps<true>::row_units];  // voxel of the output
  alignas(64) float values_[cell_edge * RowTaps<true>::row_units];
};

/// Calls run(row) for the rows of lines of cells: within a line they read near memory.
template <class Run>
void for_rows(const std::int64_t* dims, std::int64_t begin, std::int64_t end, const Run& run) {
  const std::int64_t across = (dims[1] + cell_edge - 1) / cell_edge;
  for (std::int64_t line = begin; line < end; ++line) {
    const std::int64_t first_j = cell_edge * (line % across), first_k = cell_edge * (line / across);
    for (std::int64_t k = first_k; k < std::min(first_k + cell_edge, dims[2]); ++k) {
      for (std::int64_t j = first_j; j < std::min(first_j + cell_edge, dims[1]); ++j) {
        run(k * dims[1] + j);
      }
    }
  }
}

void write_resampled_lines(PixelType type, const void* body, std::int64_t begin, std::int64_t end) {
  with_pixel_type(type, [&]<class T>(T) {
    const auto& op = *static_cast<const RowResampleOp<T>*>(body);
    if constexpr (sizeof(ArithmeticOf<T>) == 4) {
      RowResampler<T> rows(op);
      if (rows.is_vectored()) {
        for_rows(op.dims, begin, end, [&](std::int64_t row) { rows.run(row); });
        return;
      }
    }
    for_rows(op.dims, begin, end, op);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetwarp {

HWY_EXPORT(write_resampled_lines);

std::int64_t resample_lines(const std::int64_t* dims) {
  const auto cells = [&](int axis) { return (dims[axis] + cell_edge - 1) / cell_edge; };
  return cells(1) * cells(2);
}

void resample_lines(PixelType type, const void* body, std::int64_t begin, std::int64_t end) {
  HWY_DYNAMIC_DISPATCH(write_resampled_lines)(type, body, begin, end);
}

}  // namespace tetwarp
#endif  // HWY_ONCE
