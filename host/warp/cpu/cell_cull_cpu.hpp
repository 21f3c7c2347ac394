/// @file cell_cull_cpu.hpp
/// Stage "cull" on host threads: each cell of a tetrahedron's box against its four faces at once;
/// ranges of cells in one sweep over the pairs.
#pragma once
#include <cstdint>

#include "host/exec/exec_cpu.hpp"
#include "kernels/warp/cell_cull.hpp"
#include "kernels/warp/cell_pairs.hpp"

namespace tetwarp {

/// Rejects, accepts or keeps every candidate pair; no masks are made.
///
/// Along a normal one corner of a cell lies farthest in and one farthest out: these two decide what
/// eight masks do. Corners are those of the voxels that cell, box and output share, so that small
/// tetrahedra lose most of their cells too. As conservative as corner_mask: culling never changes
/// the output.
/// @param exec          threads and clock
/// @param setups        from tet_setup, shape [tet_count]
/// @param pair_offsets  first candidate pair of each tetrahedron, shape [tet_count + 1]
/// @param switches      verdicts that may be given
/// @param frame         the output
/// @param pairs         out, one per candidate pair, `rejected_pair` where no voxel is inside
///
/// Determinism: same bits for any vector width and number of threads. Cost: 8 products, 8 bytes
/// written per pair.
/// Source: ours; Gascon et al. 2013, section 4, mask corners.
void cell_verdicts(CpuExec& exec,
                   View<const TetSetup> setups,
                   View<const std::int64_t>,
                   View<std::uint16_t>,
                   View<const std::int64_t> pair_offsets,
                   CullSwitches switches,
                   const OutputFrame& frame,
                   View<CellPair> pairs);

/// The range of every cell: a stretch of cells needs one search.
void cell_ranges(CpuExec& exec, const CellRangeBody& body);

}  // namespace tetwarp
