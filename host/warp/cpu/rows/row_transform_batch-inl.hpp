/// @file row_transform_batch-inl.hpp
/// Transformed samples of the voxels of a row, in passes over many voxels: positions, samples, then
/// per tetrahedron mean, matrix and scale. Included once per vector instruction set.
#if defined(TETWARP_ROW_TRANSFORM_BATCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_TRANSFORM_BATCH_INL
#undef TETWARP_ROW_TRANSFORM_BATCH_INL
#else
#define TETWARP_ROW_TRANSFORM_BATCH_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "host/warp/cpu/rows/row_principal-inl.hpp"
#include "host/warp/cpu/rows/row_reorient-inl.hpp"
#include "host/warp/cpu/rows/row_wide_taps-inl.hpp"
#include "host/warp/cpu/rows/row_wide_values-inl.hpp"
#include "kernels/warp/voxel_transform.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Rounds up to four components of a voxel and stores them.
template <class T>
HWY_INLINE void store_block(const double* values, double scale, int count, T* out) {
  if constexpr (std::is_same_v<T, float>) {
    const BlockTag d;
    const hn::Rebind<float, BlockTag> df;
    alignas(16) float rounded[block_size];
    for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
      const auto scaled = hn::Mul(hn::LoadU(d, values + lane), hn::Set(d, scale));
      hn::Store(hn::DemoteTo(df, scaled), df, rounded + lane);
    }
    for (int c = 0; c < count; ++c) out[c] = rounded[c];
  } else {
    for (int c = 0; c < count; ++c) out[c] = rounded_to<T>(values[c] * scale);
  }
}

/// Voxels of one row whose tetrahedra have a transform. Uses no memory of the heap.
template <class T>
class TransformBatch {
 public:
  /// @param job    as in write_transform_row()
  /// @param shape  of the job's source
  TransformBatch(const RasterJob<T>& job, const SourceShape& shape)
      : job_(job), shape_(shape), nearest_(job.filter == Filter::nearest) {}

  /// Adds a run of row (j, k). May write voxels added before.
  void add(const RowSource& source, const RowRun& run, int j, int k) {
    if (values_.count + cell_edge > WideValues::voxels) flush();
    const VoxelTransform& transform = job_.transforms[source.tet()];
    const WideMap map(shape_, source, j, k);
    const int first = values_.count;
    for (unsigned bits = run.bits; bits != 0; bits &= bits - 1) {
      add_voxel(cell_edge * run.cell + std::countr_zero(bits));
    }
    groups_[group_count_++] = {&transform, first, values_.count};
    if (is_averaging(transform)) {
      add_means(source, transform, map, run.bits, first);
    } else {
      add_center_samples(source, map, run.bits, first);
    }
  }

  /// Writes all voxels that were added.
  void flush() {
    read();
    for (int g = 0; g < group_count_; ++g) take_means(groups_[g]);
    if (job_.reorientation == Quantity::principal_tensor) find_axes(values_, axes_);
    for (int g = 0; g < group_count_; ++g) finish(groups_[g]);
    group_count_ = 0;
    values_.count = 0;
  }

 private:
  /// Voxels [begin, end) of `values_`, of one tetrahedron.
  struct Group {
    const VoxelTransform* transform;
    int begin, end;
  };

  /// @param place  of the voxel in the row
  void add_voxel(int place) {
    const int voxel = values_.count++;
    place_[voxel] = place;
    values_.samples[voxel] = 0;
    if (job_.source.components == 1) {
      values_.sum[0][voxel] = 0;
      return;
    }
    for (int c = 0; c < job_.source.components; c += block_size) {
      std::fill_n(values_.sum[c / block_size] + block_size * voxel, block_size, 0.0);
    }
  }

  /// Samples at the centers of the voxels `bits`, from number `voxel` of `values_` on.
  void add_center_samples(const RowSource& source, const WideMap& map, unsigned bits, int voxel) {
    if (taps_.count + cell_edge > WideTaps::capacity) read();
    while (bits != 0) {
      const int begin = std::countr_zero(bits), end = begin + std::countr_one(bits >> begin);
      bits &= ~0u << end;
      for (int i = begin; i < end; ++i) {
        runs_[run_count_++] = {voxel++, taps_.count + i - begin, 1};
      }
      add_centers(shape_, map, nearest_, begin, end, taps_);
      fetch_ahead(source, taps_.count - 1);
    }
  }

  /// Samples at the middles of the parts of the voxels `bits`.
  void add_means(const RowSource& source,
                 const VoxelTransform& transform,
                 const WideMap& map,
                 unsigned bits,
                 int first) {
    const int all = transform.parts[0] * transform.parts[1] * transform.parts[2];
    for (int begin = 0; begin < all; begin += PartOffsets::capacity) {
      const PartOffsets offsets(source.setup(), transform.parts, begin,
                                std::min(all - begin, PartOffsets::capacity));
      int voxel = first;
      for (unsigned left = bits; left != 0; left &= left - 1, ++voxel) {
        if (taps_.count + offsets.count > WideTaps::capacity) read();
        runs_[run_count_++] = {voxel, taps_.count, offsets.count};
        add_parts(shape_, map, nearest_, std::countr_zero(left), offsets, taps_);
        fetch_ahead(source, taps_.count - 1);
      }
    }
  }

  /// Prefetches what the next rows read near a sample of `taps_`.
  void fetch_ahead(const RowSource& source, int sample) const {
    fetch_next_rows(source,
                    job_.source.data + std::int64_t{taps_.offset[sample]} * shape_.components);
  }

  /// Reads the samples of `taps_`.
  void read() {
    add_samples(job_.source, taps_, runs_, run_count_, values_);
    run_count_ = 0;
  }

  /// Number of a component's sum in WideValues::sum[component / 4].
  int index_of(int voxel, int component) const {
    return job_.source.components == 1 ? voxel : block_size * voxel + component % block_size;
  }

  /// Makes means of sums, and limits them to the range of the samples.
  void take_means(const Group& group) {
    const ArithmeticOf<T>* const range = job_.source.range;
    if (!is_averaging(*group.transform) && range == nullptr) return;
    for (int voxel = group.begin; voxel < group.end; ++voxel) {
      for (int c = 0; c < job_.source.components; ++c) {
        double& value = values_.sum[c / block_size][index_of(voxel, c)];
        value /= max_of(values_.samples[voxel], 1);
        if (range == nullptr) continue;
        const double low = range[2 * c], high = range[2 * c + 1];
        value = value < low ? low : value > high ? high : value;
      }
    }
  }

  /// Reorients, scales and stores values.
  void finish(const Group& group) {
    const Matrix3& matrix = group.transform->matrix;
    switch (job_.reorientation) {
      case Quantity::components:
        return store(group, values_);
      case Quantity::principal_tensor:
        preserve_principals(matrix, axes_, values_, group.begin, group.end, turned_);
        break;
      case Quantity::vector:
      case Quantity::covariant_vector:
      case Quantity::contravariant_vector:
      case Quantity::tensor:
        reorient_voxels(matrix, job_.source.components, values_, group.begin, group.end, turned_);
        break;
    }
    store(group, turned_);
  }

  void store(const Group& group, const WideValues& values) const {
    const int components = job_.source.components;
    const double scale = group.transform->scale;
    for (int voxel = group.begin; voxel < group.end; ++voxel) {
      T* out = job_.volume + std::int64_t{place_[voxel]} * components;
      if (values_.samples[voxel] == 0) {
        std::fill_n(out, components, job_.background);
      } else if (components == 1) {
        *out = rounded_to<T>(values.sum[0][voxel] * scale);
      } else {
        for (int c = 0; c < components; c += block_size) {
          store_block(values.sum[c / block_size] + block_size * voxel, scale,
                      std::min(components - c, block_size), out + c);
        }
      }
    }
  }

  const RasterJob<T>& job_;
  const SourceShape& shape_;
  bool nearest_;
  WideTaps taps_;
  WideRun runs_[WideTaps::capacity];
  int run_count_ = 0;
  WideValues values_;
  WideValues turned_;
  PrincipalAxes axes_;
  int place_[WideValues::voxels];
  Group groups_[WideValues::voxels];
  int group_count_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
