/// @file cell_owners.cuh
/// The owners of a cell's voxels, found by the block of threads that then stores their samples.
///
/// 128 threads in two layers of 64 (i fastest, so that a row of 8 voxels is one 32-byte sector of
/// float32), four voxels along k per thread. Planes, extents and maps of `raster_chunk` tetrahedra
/// at a time are computed by the first threads into shared memory, from which all threads read.
#pragma once
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/pair_record.hpp"

namespace tetwarp {

constexpr int raster_threads = 128;
constexpr int raster_chunk = 16;
constexpr int raster_depth = 4;  ///< voxels per thread, two apart along k

/// One bit for each of a thread's voxels (i, j, k_first + 2 d), k_first 0 or 1: bit 8 d.
using VoxelBits = std::uint32_t;

/// Data of up to `raster_chunk` tetrahedra in shared memory, one slot each.
template <class Real>
struct RasterChunk {
  CellPlanes planes[raster_chunk];
  SourceMap<Real> maps[raster_chunk];
  int tet[raster_chunk];
  std::uint8_t rows[raster_chunk];    ///< extent of the box in the cell: bits j
  VoxelBits layers[raster_chunk][2];  ///< and along k, for the threads of either k_first
  bool accepted[raster_chunk];
  bool copied[raster_chunk];
  bool own_map[raster_chunk];  ///< steep or trilinear: sampled by store_owned() instead of `maps`
};

/// Fills the chunk with the tetrahedra of pairs [first, first + count).
template <class T>
__device__ __forceinline__ void load_chunk(const RasterJob<T>& job,
                                           std::uint32_t first,
                                           int count,
                                           const int* corner,
                                           RasterChunk<ArithmeticOf<T>>& chunk) {
  const int thread = static_cast<int>(threadIdx.x);
  if (thread < 4 * count) {
    const CellPair pair = job.pairs[first + static_cast<unsigned>(thread / 4)];
    const CellPlane plane = cell_plane(job.setups[tet_of(pair)], thread % 4, corner);
    set_cell_plane(plane, thread % 4, chunk.planes[thread / 4]);
  } else if (thread >= 4 * raster_chunk && thread - 4 * raster_chunk < count) {
    const int slot = thread - 4 * raster_chunk;
    const CellPair pair = job.pairs[first + static_cast<unsigned>(slot)];
    const TetSetup& tet = job.setups[tet_of(pair)];
    double start[3], linear[3][3];
    map_start(tet, corner, start, linear);
    chunk.maps[slot] = make_source_map<ArithmeticOf<T>>(job.source, start, linear);
    chunk.tet[slot] = tet_of(pair);
    chunk.rows[slot] = static_cast<std::uint8_t>(bits_within(tet.begin[1], tet.end[1], corner[1]));
    const unsigned layers = bits_within(tet.begin[2], tet.end[2], corner[2]);
    for (int k_first = 0; k_first < 2; ++k_first) {
      chunk.layers[slot][k_first] = 0;
      for (int d = 0; d < raster_depth; ++d) {
        chunk.layers[slot][k_first] |= (layers >> (k_first + 2 * d) & 1u) << 8 * d;
      }
    }
    chunk.accepted[slot] = is_accepted(pair);
    chunk.copied[slot] = is_copied(job, tet);
    chunk.own_map[slot] = tet.kind == MapKind::trilinear ||
                          (sizeof(ArithmeticOf<T>) == 4 && tet.kind == MapKind::steep);
  }
}

/// Exact tests of some of the voxels (i, j, k_first + 2 d) of the frame in one tetrahedron. One
/// copy of the code serves all kernels: it is rarely needed and takes many registers.
/// @returns  those inside
TETWARP_HD_RARE VoxelBits inside_exact(
    View<const Node> nodes, const std::int32_t* tet, int i, int j, int k_first, VoxelBits voxels) {
  const TetNodes exact = tet_nodes(nodes, tet);
  VoxelBits inside = 0;
  for (int d = 0; d < raster_depth; ++d) {
    const VoxelBits bit = 1u << 8 * d;
    if ((voxels & bit) != 0 && is_inside_exact(exact, i, j, k_first + 2 * d)) inside |= bit;
  }
  return inside;
}

/// What one thread adds to the counters of the raster.
struct ThreadCounts {
  int covered, inside_tests, exact_tests, copied;
};

/// Those of a thread's voxels that are inside a tetrahedron. All four are tested at once: most of
/// the tetrahedron's data is the same for all.
/// @param tested  the voxels in question; others are left out
template <class T>
__device__ __forceinline__ VoxelBits inside_of(const RasterJob<T>& job,
                                               const CellPlanes& planes,
                                               int tet,
                                               const int* corner,
                                               int i,
                                               int j,
                                               int k_first,
                                               VoxelBits tested,
                                               ThreadCounts& mine) {
  float column[4], least[raster_depth];
  set_column(planes, i, j, column);
  VoxelBits inside = 0;
  for (int d = 0; d < raster_depth; ++d) {
    least[d] = least_plane(planes, column, k_first + 2 * d);
    if (least[d] > 1.0f) inside |= 1u << 8 * d;
  }
  inside &= tested;
  mine.inside_tests += __popc(tested);
  const float closest = smaller_of(smaller_of(fabsf(least[0]), fabsf(least[1])),
                                   smaller_of(fabsf(least[2]), fabsf(least[3])));
  if (closest > 1.0f) return inside;
  VoxelBits unsure = 0;
  for (int d = 0; d < raster_depth; ++d) {
    if (!(fabsf(least[d]) > 1.0f)) unsure |= 1u << 8 * d;
  }
  unsure &= tested;
  mine.exact_tests += __popc(unsure);
  return inside | inside_exact(job.nodes, job.tets.data + std::int64_t{4} * tet, corner[0] + i,
                               corner[1] + j, corner[2] + k_first, unsure);
}

/// Finds the owners of this thread's voxels among the chunk's tetrahedra.
/// @param open  voxels without an owner yet; in and out
/// @returns     byte d: the slot of voxel d's owner, if it was open and no longer is; else zero
template <class T>
__device__ __forceinline__ std::uint32_t find_owners(const RasterJob<T>& job,
                                                     const RasterChunk<ArithmeticOf<T>>& chunk,
                                                     int count,
                                                     const int* corner,
                                                     int i,
                                                     int j,
                                                     int k_first,
                                                     VoxelBits& open,
                                                     ThreadCounts& mine) {
  std::uint32_t slots = 0;
  for (int slot = 0; slot < count && open != 0; ++slot) {
    VoxelBits inside = open;
    if (!chunk.accepted[slot]) {
      const VoxelBits tested =
          (chunk.rows[slot] >> j & 1) != 0 ? chunk.layers[slot][k_first] & open : 0;
      if (tested == 0) continue;
      inside =
          inside_of(job, chunk.planes[slot], chunk.tet[slot], corner, i, j, k_first, tested, mine);
    }
    slots |= inside * static_cast<unsigned>(slot);  // the slot into the byte of each voxel
    open &= ~inside;
  }
  return slots;
}

/// A voxel's slot in what find_owners() returns.
__device__ __forceinline__ int slot_of(std::uint32_t slots, int d) {
  return static_cast<int>(slots >> 8 * d & 0xff);
}

__device__ __forceinline__ bool has_voxel(VoxelBits voxels, int d) {
  return (voxels >> 8 * d & 1) != 0;
}

}  // namespace tetwarp
