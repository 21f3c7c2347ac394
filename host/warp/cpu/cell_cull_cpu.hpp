/// @file cell_cull_cpu.hpp
/// Stage "cull" on host threads: tests each cell of a tetrahedron's box against four faces in one
/// vector.
#pragma once
#include <cstdint>

#include "host/exec/exec_cpu.hpp"
#include "kernels/warp/cell_cull.hpp"
#include "kernels/warp/cell_pairs.hpp"

namespace tetwarp {

/// Classifies every candidate pair as rejected, accepted or partial.
///
/// As PlaneVerdict, but compares the intersection of the cell, the tetrahedron's bounding box and
/// the output in place of the cell, so that small tetrahedra are rejected from most of their cells.
/// Conservative: culling never changes the output.
/// @param exec          threads and clock
/// @param setups        from tet_setup, shape [tet_count]
/// @param pair_offsets  first candidate pair of each tetrahedron, shape [tet_count + 1]
/// @param switches      verdicts that are used
/// @param frame         the output
/// @param pairs         out, one per candidate pair, `rejected_pair` where no voxel is inside
///
/// Determinism: same bits for any vector width and number of threads. Cost: 8 products, 8 bytes
/// written per pair.
/// Source: own; Gascon et al. 2013, section 4, use corner masks.
void cell_cull(CpuExec& exec,
               View<const TetSetup> setups,
               const PlaneVerdict&,
               View<const std::int64_t> pair_offsets,
               CullSwitches switches,
               const OutputFrame& frame,
               View<CellPair> pairs);

/// Computes the range of pairs of every cell: one binary search per stretch of cells.
void cell_ranges(CpuExec& exec, const CellRangeOp& op);

}  // namespace tetwarp
