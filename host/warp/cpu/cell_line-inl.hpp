/// @file cell_line-inl.hpp
/// Raster of a line of cells along x: first the owners of its voxels, then the samples, row by row
/// over the whole line, so that the source is read in long runs. Included once per vector
/// instruction set.
#if defined(TETWARP_CELL_LINE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_CELL_LINE_INL
#undef TETWARP_CELL_LINE_INL
#else
#define TETWARP_CELL_LINE_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <vector>

#include "host/warp/cpu/cell_owners-inl.hpp"
#include "host/warp/cpu/row_sample-inl.hpp"
#include "host/warp/cpu/row_stream-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Rasters lines of cells of one job. Reuses its scratch memory from line to line.
template <class T>
class CellLine {
 public:
  CellLine(const RasterJob<T>& job, int longest, RasterCounts& counts)
      : job_(job),
        counts_(counts),
        row_job_(job),
        sampler_(row_job_),
        bounds_(job),
        stream_(std::ptrdiff_t{longest} * cell_edge * job.source.components,
                std::ptrdiff_t{cell_edge} * job.source.components),
        lists_open_(job.outside.use_source || job.mask != nullptr || job.tet != nullptr),
        runs_(std::make_unique_for_overwrite<RowRun[]>(
            static_cast<std::size_t>(longest * cell_edge * cell_edge * cell_edge))),
        row_capacity_(longest * cell_edge) {}

  /// Rasters cells [ci_begin, ci_end) of line (cj, ck), except those that are kept.
  void raster(int ci_begin, int ci_end, int cj, int ck) {
    const auto is_kept = [&](int ci) {
      return work_of(job_, job_.frame.cell_index(ci, cj, ck)) == keep_cell;
    };
    for (int ci = ci_begin; ci < ci_end;) {
      int past = ci;
      while (past < ci_end && !is_kept(past)) ++past;
      if (ci < past) raster_stretch(ci, past, cj, ck);
      ci = past + 1;
    }
  }

 private:
  /// Successive cells of the line with voxels that are not sampled.
  struct FlatCells {
    int first, past;
    bool is_whole;   ///< all voxels of the cells; else the voxels `bits` of one cell
    const T* value;  ///< their value, one per component; null: voxels without an owner
    CellBits bits;
  };

  /// Rasters cells [ci_begin, ci_end) of line (cj, ck), none of them kept.
  void raster_stretch(int ci_begin, int ci_end, int cj, int ck) {
    sources_.clear();
    flat_.clear();
    constants_.clear();
    has_open_ = false;
    for (auto& slice : run_counts_) std::fill_n(slice, cell_edge, 0);
    first_ = ci_begin;
    for (int ci = ci_begin; ci < ci_end; ++ci) {
      const std::int64_t cell = job_.frame.cell_index(ci, cj, ck);
      find(make_cell_box(job_.frame, ci, cj, ck), job_.ranges[cell], cell);
    }
    const int components = job_.source.components;
    const CellBox first = make_cell_box(job_.frame, ci_begin, cj, ck);
    const int begin = first.begin[0];
    const int end = std::min(job_.frame.end[0], cell_edge * ci_end) - first.corner[0];
    for (int k = first.begin[2]; k < first.end[2]; ++k) {
      for (int j = first.begin[1]; j < first.end[1]; ++j) {
        const std::int64_t row =
            job_.frame.offset_of(first.corner[0], first.corner[1] + j, first.corner[2] + k);
        RowRun* runs = row_runs(j, k);
        const int count = run_counts_[k][j];
        row_job_.volume =
            stream_.begin_row(job_.volume + (row + begin) * components) - begin * components;
        if (has_open_) {
          std::fill_n(row_job_.volume + begin * components, (end - begin) * components,
                      job_.background);
        }
        write_flat(first, j, k, row);
        write_extra(runs, count, row);
        if (count > 0) sampler_.write(sources_.data(), runs, count, j, k);
        stream_.end_row(std::ptrdiff_t{end - begin} * components);
      }
    }
    stream_.flush();
  }

  RowRun* row_runs(int j, int k) {
    return runs_.get() + static_cast<std::ptrdiff_t>(cell_edge * k + j) * row_capacity_;
  }

  /// Finds the owners of one cell, their runs, and the voxels that are not sampled.
  void find(const CellBox& box, const CellRange& range, std::int64_t cell_index) {
    const int cell = box.corner[0] / cell_edge - first_;
    const std::int64_t work = work_of(job_, cell_index);
    const std::int64_t covered_before = counts_.covered;
    const SliceBits whole =
        rows_between(box.begin[1], box.end[1], (1u << box.end[0]) - (1u << box.begin[0]));
    CellBits open = {};
    for (int k = box.begin[2]; k < box.end[2]; ++k) open.slice[k] = whole;
    find_owners(job_, box, range, open, counts_, [&](std::uint32_t p, const CellBits& bits) {
      const int t = tet_of(job_.pairs[p]);
      const int voxels = count_of(bits);
      counts_.covered += voxels;
      if (is_copied(job_, job_.setups[t]) && !has_transform(job_, t)) counts_.copied += voxels;
      if (work >= 0) return write_extra(box, bits, t);
      sources_.emplace_back(job_, bounds_, job_.setups[t], box.corner, t);
      add_runs(bits, cell);
    });
    if (job_.cell_covered.size > 0) {
      job_.cell_covered[cell_index] = static_cast<std::uint16_t>(counts_.covered - covered_before);
    }
    if (work >= 0) {
      CellBits covered;
      for (int k = 0; k < cell_edge; ++k) {
        const bool is_in = k >= box.begin[2] && k < box.end[2];
        covered.slice[k] = is_in ? whole & ~open.slice[k] : 0;
      }
      add_flat(box, cell, covered, constant_at(work));
    }
    has_open_ = has_open_ || any_of(open);
    if (lists_open_) add_flat(box, cell, open, nullptr);
  }

  /// The value of cells that are constant around a voxel of the source; valid for this stretch.
  const T* constant_at(std::int64_t voxel) {
    const int components = job_.source.components;
    if (job_.source.coefficients == nullptr) return job_.source.data + voxel * components;
    auto& values = constants_.emplace_back();
    for (int c = 0; c < components; ++c) {
      values[static_cast<std::size_t>(c)] = constant_value(job_.source, voxel, c);
    }
    return values.data();
  }

  /// Adds voxels of a cell to `flat_`.
  /// @param value  see FlatCells
  void add_flat(const CellBox& box, int cell, const CellBits& bits, const T* value) {
    const int voxels = count_of(bits);
    if (voxels == 0) return;
    const bool is_whole = voxels == (box.end[0] - box.begin[0]) * (box.end[1] - box.begin[1]) *
                                        (box.end[2] - box.begin[2]) &&
                          box.end[0] - box.begin[0] == cell_edge;
    if (is_whole && !flat_.empty()) {
      FlatCells& before = flat_.back();
      if (before.is_whole && before.past == cell && is_equal(before.value, value)) {
        ++before.past;
        return;
      }
    }
    flat_.push_back({cell, cell + 1, is_whole, value, bits});
  }

  bool is_equal(const T* a, const T* b) const {
    if (a == nullptr || b == nullptr) return a == b;
    return std::memcmp(a, b, sizeof(T) * static_cast<std::size_t>(job_.source.components)) == 0;
  }

  /// Adds the runs of the last element of sources_ in a cell.
  void add_runs(const CellBits& bits, int cell) {
    const auto source = static_cast<std::int32_t>(sources_.size() - 1);
    const auto* rows = reinterpret_cast<const std::uint8_t*>(bits.slice);
    for (std::uint64_t left = rows_of(bits); left != 0; left &= left - 1) {
      const int row = std::countr_zero(left);
      RowRun* runs = row_runs(row % cell_edge, row / cell_edge);
      int& count = run_counts_[row / cell_edge][row % cell_edge];
      runs[count++] = {source, static_cast<std::uint16_t>(cell), rows[row]};
    }
  }

  /// Calls with(bits, first voxel of the row) for the rows of a cell that have any of `bits`.
  template <class With>
  void for_rows(const CellBox& box, const CellBits& bits, With&& with) const {
    const auto* rows = reinterpret_cast<const std::uint8_t*>(bits.slice);
    for (std::uint64_t left = rows_of(bits); left != 0; left &= left - 1) {
      const int row = std::countr_zero(left), j = row % cell_edge, k = row / cell_edge;
      with(unsigned{rows[row]},
           job_.frame.offset_of(box.corner[0], box.corner[1] + j, box.corner[2] + k));
    }
  }

  /// Writes the flat voxels of row (j, k), run by run.
  void write_flat(const CellBox& first, int j, int k, std::int64_t row) {
    for (const FlatCells& cells : flat_) {
      const int at = cell_edge * cells.first;
      if (cells.is_whole) {
        write_run(at, cell_edge * cells.past, cells.value, first, j, k, row);
        continue;
      }
      unsigned bits = cells.bits.slice[k] >> (cell_edge * j) & 0xff;
      while (bits != 0) {
        const int from = std::countr_zero(bits), past = from + std::countr_one(bits >> from);
        write_run(at + from, at + past, cells.value, first, j, k, row);
        bits &= ~0u << past;
      }
    }
  }

  /// Writes flat voxels [begin, end) of the line's row (j, k).
  /// @param value  see FlatCells
  void write_run(
      int begin, int end, const T* value, const CellBox& first, int j, int k, std::int64_t row) {
    const int components = job_.source.components;
    T* out = row_job_.volume + begin * components;
    if (value == nullptr) {
      write_outside(begin, end, first, j, k, row);
    } else if (components == 1) {
      std::fill_n(out, end - begin, *value);
    } else {
      for (int voxel = begin; voxel < end; ++voxel, out += components) {
        std::copy_n(value, components, out);
      }
    }
  }

  /// Writes voxels without an owner, [begin, end) of the line's row (j, k). Their samples are the
  /// background already.
  void write_outside(int begin, int end, const CellBox& first, int j, int k, std::int64_t row) {
    if (job_.mask != nullptr) std::fill_n(job_.mask + row + begin, end - begin, std::uint8_t{0});
    if (job_.tet != nullptr) std::fill_n(job_.tet + row + begin, end - begin, -1);
    if (!job_.outside.use_source) return;
    for (int voxel = begin; voxel < end; ++voxel) {
      const int cell = voxel / cell_edge * cell_edge;
      const int corner[3] = {first.corner[0] + cell, first.corner[1], first.corner[2]};
      if (has_outside_transform(row_job_)) {
        ScalarRows<T>::write_outside(row_job_, corner, voxel - cell, j, k, voxel);
      } else {
        store_outside<true>(row_job_, {corner, voxel - cell, j, k, voxel});
      }
    }
  }

  /// Writes mask and owners for the runs of a row.
  void write_extra(const RowRun* runs, int count, std::int64_t row) {
    if (job_.mask == nullptr && job_.tet == nullptr) return;
    for (int r = 0; r < count; ++r) {
      const int tet = sources_[static_cast<std::size_t>(runs[r].source)].tet();
      write_extra(runs[r].bits, row + cell_edge * runs[r].cell, tet);
    }
  }

  /// Writes mask and owners for the voxels of a cell that `tet` owns.
  void write_extra(const CellBox& box, const CellBits& bits, int tet) {
    if (job_.mask == nullptr && job_.tet == nullptr) return;
    for_rows(box, bits, [&](unsigned row, std::int64_t voxel) { write_extra(row, voxel, tet); });
  }

  /// Writes mask and owners for the voxels `bits` of a row that `tet` owns.
  void write_extra(unsigned bits, std::int64_t row, int tet) {
    for (; bits != 0; bits &= bits - 1) {
      const std::int64_t voxel = row + std::countr_zero(bits);
      if (job_.mask != nullptr) job_.mask[voxel] = 1;
      if (job_.tet != nullptr) job_.tet[voxel] = tet;
    }
  }

  const RasterJob<T>& job_;
  RasterCounts& counts_;
  RasterJob<T> row_job_;  ///< job_ with the current row as its volume
  RowSampler<T> sampler_;
  SourceBounds bounds_;
  RowStream<T> stream_;
  std::vector<RowSource> sources_;  ///< one per pair that owns voxels of this line
  std::vector<FlatCells> flat_;     ///< ascending
  std::deque<std::array<T, max_components>> constants_;  ///< values computed from coefficients
  bool lists_open_;                 ///< voxels without an owner are added to `flat_`
  bool has_open_ = false;           ///< the line has voxels without an owner
  std::unique_ptr<RowRun[]> runs_;  ///< [k][j][run]
  int row_capacity_;
  int run_counts_[cell_edge][cell_edge] = {};
  int first_ = 0;  ///< first cell of the line
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
