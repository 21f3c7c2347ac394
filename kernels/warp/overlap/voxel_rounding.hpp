/// @file voxel_rounding.hpp
/// Stage "raster" of a warp that keeps totals: rounds to integers, and sums up what that changes.
#pragma once
#include <cstdint>

#include "kernels/base/any_number.hpp"
#include "kernels/base/atomic_add.hpp"
#include "kernels/base/stochastic_rounding.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// Stores the values of an output. Integers are rounded by stochastically_rounded() with the index
/// of the number in the whole output grid, so that a region has the numbers of the grid.
struct VoxelRounding {
  OutputFrame frame;
  std::int64_t dims[2];  ///< voxels of the output grid along i and j
  int components;
  NumberView volume;  ///< [k][j][i][component]
  /// In and out, [cell][component]; size 0: the numbers are floating point.
  View<RoundingChange> changes;

  /// @param voxel   position in `volume`
  /// @param x       the same voxel [frame]
  /// @param values  one per component
  TETWARP_HD_RARE void store(std::int64_t voxel, const int* x, const double* values) const {
    const std::int64_t slice = (frame.origin[2] + x[2]) * dims[1] + frame.origin[1] + x[1];
    const std::int64_t first = (slice * dims[0] + frame.origin[0] + x[0]) * components;
    const std::int64_t cell = frame.cell_of_voxel(x) * components;
    for (int c = 0; c < components; ++c) {
      const std::int64_t at = voxel * components + c;
      if (changes.size == 0) {
        volume.set(at, values[c]);
        continue;
      }
      const double whole = stochastically_rounded(values[c], static_cast<std::uint64_t>(first + c));
      volume.set(at, whole);
      add(changes[cell + c], whole - values[c], volume.at(at) - whole);
    }
  }

 private:
  TETWARP_HD static void add(RoundingChange& change, double rounding, double clipping) {
    constexpr double limit = 0x1p52;  // 512 voxels of a cell fit in 64 bits
    const double quanta = rint(rounding / RoundingChange::quantum);
    if (quanta != 0) atomic_add(&change.rounding, static_cast<std::int64_t>(quanta));
    if (clipping == 0) return;
    const double bounded = max_of(min_of(clipping, limit), -limit);
    atomic_add(&change.clipping, static_cast<std::int64_t>(bounded));
    atomic_add(&change.clipped, 1);
  }
};

/// One index = one cell; any order. Clears the changes of cells that are written again.
struct RoundingClearOp {
  View<const std::int64_t> cell_work;  ///< only keep_cell is used; size 0: no cell is kept
  int components;
  View<RoundingChange> changes;  ///< [cell][component]

  TETWARP_HD void operator()(std::int64_t cell) const {
    if (cell_work.size > 0 && cell_work[cell] == keep_cell) return;
    for (int c = 0; c < components; ++c) changes[cell * components + c] = {0, 0, 0};
  }
};

/// One index = 1024 cells; any order. Sums their changes.
struct RoundingSumOp {
  static constexpr std::int64_t cells = 1024;
  View<const RoundingChange> changes;  ///< [cell][component]
  int components;
  View<RoundingChange> sums;  ///< one per component

  TETWARP_HD void operator()(std::int64_t part) const {
    const std::int64_t end = min_of((part + 1) * cells, changes.size / components);
    for (int c = 0; c < components; ++c) {
      RoundingChange sum = {0, 0, 0};
      for (std::int64_t cell = part * cells; cell < end; ++cell) {
        const RoundingChange& change = changes[cell * components + c];
        sum.rounding += change.rounding;
        sum.clipping += change.clipping;
        sum.clipped += change.clipped;
      }
      atomic_add(&sums[c].rounding, sum.rounding);
      atomic_add(&sums[c].clipping, sum.clipping);
      atomic_add(&sums[c].clipped, sum.clipped);
    }
  }
};

}  // namespace tetwarp
