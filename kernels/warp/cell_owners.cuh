/// @file cell_owners.cuh
/// The owners of a cell's voxels, found by the block of threads that then stores their samples.
///
/// 128 threads in two layers of 64 (i fastest, so that a row of 8 voxels is one 32-byte sector of
/// float32), four voxels along k per thread. Planes, extents and maps of `raster_chunk` tetrahedra
/// at a time are computed by the first threads into shared memory, from which all threads read.
#pragma once
#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

constexpr int raster_threads = 128;
constexpr int raster_chunk = 16;
constexpr int raster_depth = 4;  ///< voxels per thread, two apart along k

/// One bit for each of a thread's voxels (i, j, k_first + 2 d), k_first 0 or 1: bit 8 d.
using VoxelBits = std::uint32_t;
constexpr VoxelBits all_voxels = 0x01010101u;

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

/// Bit b for each voxel corner + b, b in 0..7, that lies in [begin, end).
__device__ __forceinline__ unsigned bits_within(int begin, int end, int corner) {
  const int first = min_of(max_of(begin - corner, 0), cell_edge);
  const int past = min_of(max_of(end - corner, 0), cell_edge);
  return ((1u << past) - 1) & ~((1u << first) - 1);
}

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
    set_cell_plane(job.setups[tet_of(pair)], thread % 4, corner, chunk.planes[thread / 4]);
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

/// Finds the owners of this thread's voxels among the chunk's tetrahedra. A tetrahedron is tested
/// with all four at once: most of its data is the same for all.
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
                                                     RasterCounts& mine) {
  std::uint32_t slots = 0;
  for (int slot = 0; slot < count && open != 0; ++slot) {
    VoxelBits inside = open;
    if (!chunk.accepted[slot]) {
      const VoxelBits tested =
          (chunk.rows[slot] >> j & 1) != 0 ? chunk.layers[slot][k_first] & open : 0;
      if (tested == 0) continue;
      const CellPlanes& planes = chunk.planes[slot];
      float column[4];
      set_column(planes, i, j, column);
      VoxelBits unsure = 0;
      inside = 0;
      for (int d = 0; d < raster_depth; ++d) {
        const float least = least_plane(planes, column, k_first + 2 * d);
        if (least > 1.0f) inside |= 1u << 8 * d;
        if (!(fabsf(least) > 1.0f)) unsure |= 1u << 8 * d;
      }
      inside &= tested;
      unsure &= tested;
      mine.inside_tests += __popc(tested);
      if (unsure != 0) {
        const std::int32_t* const tet = job.tets.data + std::int64_t{4} * chunk.tet[slot];
        inside |=
            inside_exact(job.nodes, tet, corner[0] + i, corner[1] + j, corner[2] + k_first, unsure);
        mine.exact_tests += __popc(unsure);
      }
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
