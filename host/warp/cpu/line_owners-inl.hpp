/// @file line_owners-inl.hpp
/// The owners of the voxels of a line of cells along x: the part of its raster that does not depend
/// on the pixel type. Included once per vector instruction set.
#if defined(TETWARP_LINE_OWNERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_LINE_OWNERS_INL
#undef TETWARP_LINE_OWNERS_INL
#else
#define TETWARP_LINE_OWNERS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "host/warp/cpu/cell_owners-inl.hpp"
#include "host/warp/cpu/rows/row_hex-inl.hpp"
#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Successive cells of a line with voxels that are not sampled.
struct FlatCells {
  int first, past;
  bool is_whole;      ///< all voxels of the cells; else the voxels `bits` of one cell
  std::int64_t from;  ///< source voxel whose value they have; -1: they have no owner
  CellBits bits;
};

/// Finds the owners of successive cells of a line. Reuses its memory from line to line.
class LineOwners {
 public:
  /// @param source   of the job
  /// @param longest  largest number of cells of a line
  /// @param counts   numbers of voxels and tests are added
  LineOwners(const RasterGeometry& job,
             const SourceShape& source,
             int longest,
             RasterCounts& counts)
      : job_(job),
        source_(source),
        counts_(counts),
        lists_open_(job.outside.use_source || job.mask != nullptr || job.tet != nullptr),
        runs_(std::make_unique_for_overwrite<RowRun[]>(
            static_cast<std::size_t>(longest * cell_edge * cell_edge * cell_edge))),
        row_capacity_(longest * cell_edge) {}

  /// Finds the owners in cells [ci_begin, ci_end) of line (cj, ck). Writes mask and owners of the
  /// cells whose covered voxels all have one value, and the numbers of covered voxels.
  void find(int ci_begin, int ci_end, int cj, int ck);

  bool has_open() const { return has_open_; }  ///< there are voxels without an owner
  const std::vector<FlatCells>& flat() const { return flat_; }  ///< ascending
  const RowSource* sources() const { return sources_.data(); }
  const LineHexes& hexes() const { return hexes_; }  ///< of the sources of RowKind::curved

  /// Runs of row (j, k), sorted by cell.
  RowRun* runs(int j, int k) const {
    return runs_.get() + static_cast<std::ptrdiff_t>(cell_edge * k + j) * row_capacity_;
  }
  int run_count(int j, int k) const { return run_counts_[k][j]; }

  /// Writes mask and owners for the runs of row (j, k).
  /// @param row  of the line's voxel (0, j, k) in the output
  void write_covered(int j, int k, std::int64_t row) const;

  /// Writes mask and owners of voxels [begin, end) of a row, which have no owner.
  void write_uncovered(int begin, int end, std::int64_t row) const;

 private:
  void find_cell(const CellBox& box, const CellRange& range, std::int64_t cell_index);
  void add_flat(const CellBox& box, int cell, const CellBits& bits, std::int64_t from);
  bool has_one_value(std::int64_t from, std::int64_t other) const;
  void add_runs(const CellBits& bits, int cell);
  void write_cell(const CellBox& box, const CellBits& bits, int tet) const;
  void write_bits(unsigned bits, std::int64_t row, int tet) const;

  const RasterGeometry& job_;
  const SourceShape& source_;
  RasterCounts& counts_;
  std::vector<RowSource> sources_;  ///< one per pair that owns voxels of this line
  LineHexes hexes_;
  std::vector<FlatCells> flat_;
  bool lists_open_;  ///< voxels without an owner are added to `flat_`
  bool has_open_ = false;
  std::unique_ptr<RowRun[]> runs_;  ///< [k][j][run]
  int row_capacity_;
  int run_counts_[cell_edge][cell_edge] = {};
  int first_ = 0;  ///< first cell of the line
};

inline HWY_NOINLINE void LineOwners::find(int ci_begin, int ci_end, int cj, int ck) {
  sources_.clear();
  hexes_.clear();
  flat_.clear();
  has_open_ = false;
  for (auto& slice : run_counts_) std::fill_n(slice, cell_edge, 0);
  first_ = ci_begin;
  for (int ci = ci_begin; ci < ci_end; ++ci) {
    const std::int64_t cell = job_.frame.cell_index(ci, cj, ck);
    find_cell(make_cell_box(job_.frame, ci, cj, ck), job_.ranges[cell], cell);
  }
}

/// Finds the owners of one cell, their runs, and the voxels that are not sampled.
inline void LineOwners::find_cell(const CellBox& box,
                                  const CellRange& range,
                                  std::int64_t cell_index) {
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
    if (work >= 0) return write_cell(box, bits, t);
    RowSource& source = sources_.emplace_back(job_, source_, job_.setups[t], box.corner, t);
    if (source.kind() == RowKind::curved) source.set_hex_part(hexes_.add(job_, t));
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
    add_flat(box, cell, covered, work);
  }
  has_open_ = has_open_ || any_of(open);
  if (lists_open_) add_flat(box, cell, open, -1);
}

/// Adds voxels of a cell to `flat_`.
/// @param from  see FlatCells
inline void LineOwners::add_flat(const CellBox& box,
                                 int cell,
                                 const CellBits& bits,
                                 std::int64_t from) {
  const int voxels = count_of(bits);
  if (voxels == 0) return;
  const bool is_whole = voxels == (box.end[0] - box.begin[0]) * (box.end[1] - box.begin[1]) *
                                      (box.end[2] - box.begin[2]) &&
                        box.end[0] - box.begin[0] == cell_edge;
  if (is_whole && !flat_.empty()) {
    FlatCells& before = flat_.back();
    if (before.is_whole && before.past == cell && has_one_value(before.from, from)) {
      ++before.past;
      return;
    }
  }
  flat_.push_back({cell, cell + 1, is_whole, from, bits});
}

/// Whether the values of two FlatCells are known to be equal.
inline bool LineOwners::has_one_value(std::int64_t from, std::int64_t other) const {
  if (from < 0 || other < 0) return from == other;
  const std::ptrdiff_t bytes = source_.constant_bytes * source_.components;
  return std::memcmp(source_.constants + from * bytes, source_.constants + other * bytes,
                     static_cast<std::size_t>(bytes)) == 0;
}

/// Adds the runs of the last element of sources_ in a cell.
inline void LineOwners::add_runs(const CellBits& bits, int cell) {
  const auto source = static_cast<std::int32_t>(sources_.size() - 1);
  const RowKind kind = sources_.back().kind();
  const auto* rows = reinterpret_cast<const std::uint8_t*>(bits.slice);
  for (std::uint64_t left = rows_of(bits); left != 0; left &= left - 1) {
    const int row = std::countr_zero(left), j = row % cell_edge, k = row / cell_edge;
    runs(j, k)[run_counts_[k][j]++] = {source, static_cast<std::uint16_t>(cell), rows[row], kind};
  }
}

inline HWY_NOINLINE void LineOwners::write_covered(int j, int k, std::int64_t row) const {
  if (job_.mask == nullptr && job_.tet == nullptr) return;
  const RowRun* run = runs(j, k);
  for (int r = 0; r < run_count(j, k); ++r, ++run) {
    const int tet = sources_[static_cast<std::size_t>(run->source)].tet();
    write_bits(run->bits, row + cell_edge * run->cell, tet);
  }
}

inline HWY_NOINLINE void LineOwners::write_uncovered(int begin, int end, std::int64_t row) const {
  if (job_.mask != nullptr) std::fill_n(job_.mask + row + begin, end - begin, std::uint8_t{0});
  if (job_.tet != nullptr) std::fill_n(job_.tet + row + begin, end - begin, -1);
}

/// Writes mask and owners for the voxels of a cell that `tet` owns.
inline void LineOwners::write_cell(const CellBox& box, const CellBits& bits, int tet) const {
  if (job_.mask == nullptr && job_.tet == nullptr) return;
  const auto* rows = reinterpret_cast<const std::uint8_t*>(bits.slice);
  for (std::uint64_t left = rows_of(bits); left != 0; left &= left - 1) {
    const int row = std::countr_zero(left), j = row % cell_edge, k = row / cell_edge;
    write_bits(unsigned{rows[row]},
               job_.frame.offset_of(box.corner[0], box.corner[1] + j, box.corner[2] + k), tet);
  }
}

/// Writes mask and owners for the voxels `bits` of a row that `tet` owns.
inline void LineOwners::write_bits(unsigned bits, std::int64_t row, int tet) const {
  for (; bits != 0; bits &= bits - 1) {
    const std::int64_t voxel = row + std::countr_zero(bits);
    if (job_.mask != nullptr) job_.mask[voxel] = 1;
    if (job_.tet != nullptr) job_.tet[voxel] = tet;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
