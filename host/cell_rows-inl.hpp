/// @file cell_rows-inl.hpp
/// One cell: who owns its voxels, then what they get, row by row. Included once per vector
/// instruction set (the name and the toggled guard are Highway's convention).
#if defined(TETWARP_CELL_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_CELL_ROWS_INL
#undef TETWARP_CELL_ROWS_INL
#else
#define TETWARP_CELL_ROWS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "host/cell_owners-inl.hpp"
#include "host/row_sample-inl.hpp"
#include "host/row_source-inl.hpp"
#include "kernels/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Rasters cells of one job. Keeps its scratch from cell to cell.
template <class T>
class CellRows {
 public:
  CellRows(const RasterJob<T>& job, RasterCounts& counts) : job_(job), counts_(counts) {}

  void raster(int ci, int cj, int ck) {
    box_ = make_cell_box(job_.frame, ci, cj, ck);
    whole_row_ = (1u << box_.end[0]) - (1u << box_.begin[0]);
    const SliceBits whole_slice = rows_between(box_.begin[1], box_.end[1], whole_row_);
    for (int k = box_.begin[2]; k < box_.end[2]; ++k) open_[k] = whole_slice;
    sources_.clear();
    last_pair_ = ~std::uint32_t{0};
    const CellRange range = job_.ranges[job_.frame.cell_index(ci, cj, ck)];
    if (range.begin < range.end) {
      for (auto& slice : runs_) {
        for (RowRuns& row : slice) row.count = 0;
      }
      find_owners(job_, box_, range, open_, counts_,
                  [&](std::uint32_t p, int k, SliceBits bits) { own(p, k, bits); });
    }
    for (int k = box_.begin[2]; k < box_.end[2]; ++k) {
      for (int j = box_.begin[1]; j < box_.end[1]; ++j) {
        const unsigned open = static_cast<unsigned>(open_[k] >> (8 * j) & 0xff);
        if (!sources_.empty() && runs_[k][j].count > 0) write_runs(runs_[k][j], j, k);
        if (open != 0) write_outside(open, j, k);
      }
    }
  }

 private:
  /// Notes, row by row, that a pair owns voxels of slice k.
  void own(std::uint32_t p, int k, SliceBits bits) {
    const int t = tet_of(job_.pairs[p]);
    if (p != last_pair_) {
      sources_.emplace_back(job_, job_.setups[t], box_.corner, t);
      last_pair_ = p;
    }
    const int voxels = std::popcount(bits);
    counts_.covered += voxels;
    if (is_copied(job_, job_.setups[t])) counts_.copied += voxels;
    const int source = static_cast<int>(sources_.size()) - 1;
    for (int j = 0; j < cell_edge; ++j) {
      const unsigned row = static_cast<unsigned>(bits >> (8 * j) & 0xff);
      if (row == 0) continue;
      RowRuns& runs = runs_[k][j];
      runs.run[runs.count++] = {source, row};
    }
  }

  void write_runs(const RowRuns& runs, int j, int k) {
    const std::int64_t row = row_offset(j, k);
    write_row(job_, sources_.data(), runs, j, k, row);
    if (job_.mask == nullptr && job_.tet == nullptr) return;
    for (int r = 0; r < runs.count; ++r) {
      const int source = runs.run[r].source;
      write_extra(runs.run[r].bits, row, sources_[static_cast<std::size_t>(source)].tet());
    }
  }

  void write_outside(unsigned bits, int j, int k) {
    const std::int64_t row = row_offset(j, k);
    write_extra(bits, row, -1);
    if (!job_.outside.use_source && bits == whole_row_) {
      const int components = job_.source.components;
      std::fill_n(job_.volume + (row + box_.begin[0]) * components,
                  (box_.end[0] - box_.begin[0]) * components, job_.background);
      return;
    }
    for (; bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits);
      store_outside(job_, box_.corner[0], box_.corner[1], box_.corner[2], i, j, k, row + i);
    }
  }

  void write_extra(unsigned bits, std::int64_t row, int tet) {
    if (job_.mask == nullptr && job_.tet == nullptr) return;
    for (; bits != 0; bits &= bits - 1) {
      const std::int64_t voxel = row + std::countr_zero(bits);
      if (job_.mask != nullptr) job_.mask[voxel] = tet >= 0;
      if (job_.tet != nullptr) job_.tet[voxel] = tet;
    }
  }

  std::int64_t row_offset(int j, int k) const {
    return job_.frame.offset_of(box_.corner[0], box_.corner[1] + j, box_.corner[2] + k);
  }

  const RasterJob<T>& job_;
  RasterCounts& counts_;
  CellBox box_;
  unsigned whole_row_ = 0;
  SliceBits open_[cell_edge] = {};           ///< per slice: voxels without an owner
  std::vector<RowSource<T>> sources_;        ///< of the pairs that own voxels of this cell
  std::uint32_t last_pair_ = 0;              ///< the pair behind the last source
  RowRuns runs_[cell_edge][cell_edge] = {};  ///< [k][j]
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
