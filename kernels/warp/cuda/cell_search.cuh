/// @file cell_search.cuh
/// Stage "raster" of the warp as a CUDA kernel, first half: a warp finds the owners of the voxels
/// of its cell, row by row, from where rows cross the faces of tetrahedra.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cuda/cell_raster.cuh"
#include "kernels/warp/pair_record.hpp"

namespace tetwarp {

constexpr int pair_parts = 4;  ///< threads of a pair: one face each, three a row of the map
constexpr int chunk_pairs = 32 / pair_parts;  ///< whose rows a warp walks at a time
constexpr int cell_rows = cell_edge * cell_edge;
constexpr unsigned whole_warp = 0xffffffffu;

/// What a warp knows of its cell, in shared memory. Pairs that may own a voxel are numbered from 1
/// in the order of the list.
struct alignas(16) CellState {
  RowBound bounds[chunk_pairs][pair_parts];  ///< those from below first, those from above last
  std::uint8_t owners[cell_edge][cell_edge][cell_edge];  ///< numbers; 0: none
  std::uint32_t rows[cell_rows];  ///< [k][j] voxels without an owner yet, tests << tests_shift
  PairHead heads[chunk_pairs];
  std::uint8_t pairs[256];  ///< place of pair `number` in the cell's part of the list

  /// Owners of a row as two words.
  TETWARP_HD std::uint32_t* row(int j, int k) {
    return reinterpret_cast<std::uint32_t*>(owners[k][j]);
  }
};
constexpr int tests_shift = 16;

/// Voxel i of row r, and the number of the pair that may own it.
TETWARP_HD std::uint32_t unsure_voxel(int r, int i, int number) {
  return static_cast<std::uint32_t>(number << 9 | r << cell_shift | i);
}

/// What exact tests of the voxels of a cell need.
struct ExactTests {
  const CellPair* pairs;
  View<const Node> nodes;
  const std::int32_t* tets;
  int corner[3];

  /// @param number  of the pair
  TETWARP_HD bool is_inside(const CellState& state, int number, int i, int j, int k) const {
    const auto tet = std::int64_t{4} * tet_of(pairs[state.pairs[number]]);
    return is_inside_exact(tet_nodes(nodes, tets + tet), corner[0] + i, corner[1] + j,
                           corner[2] + k);
  }
};

/// A cell as its warp sees it.
template <class T>
struct GroupCell {
  const RasterJob<T>& job;
  int corner[3];          ///< its first voxel [frame]
  const CellPair* pairs;  ///< its part of the list
  int count;              ///< pairs in it
  CellState& state;

  __device__ __forceinline__ ExactTests tests() const {
    return {pairs, job.nodes, job.tets.data, {corner[0], corner[1], corner[2]}};
  }
  /// Whether one tetrahedron holds the whole cell and no other comes before it.
  __device__ __forceinline__ bool is_single() const { return count == 1 && is_accepted(pairs[0]); }
  __device__ __forceinline__ const TetSetup& setup(int p) const {
    return job.setups[tet_of(pairs[p])];
  }
};

__device__ __forceinline__ int lane_of() {
  return static_cast<int>(threadIdx.x) % 32;
}

/// Four bits as the bytes of a word, 0 or 1 each.
TETWARP_HD std::uint32_t bytes_of(std::uint32_t bits) {
  return (bits & 15u) * 0x00204081u & 0x01010101u;
}

/// Gives voxels of a row without an owner to pair `number`. Two lanes may do so at once.
/// @param owners  of the row, two words
__device__ __forceinline__ void give(RowBits voxels, int number, std::uint32_t* owners) {
  for (int w = 0; w < 2; ++w) {
    atomicAdd(owners + w, bytes_of(voxels >> 4 * w) * static_cast<std::uint32_t>(number));
  }
}

/// Cuts the spans of rows (j, k) by the faces of a pair.
template <int count>
TETWARP_HD void cut_spans(
    PairHead head, const RowBound* bounds, const int* j, const int* k, RowSpan* spans) {
  const int below = static_cast<int>(head >> below_bits & 3u);
  const int above = static_cast<int>(head >> above_bits & 3u);
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int b = 0; b < 3; ++b) {
    if (b >= below) break;
    const RowBound bound = bounds[b];
    for (int n = 0; n < count; ++n) {
      spans[n].cut_below(bound, static_cast<float>(j[n]), static_cast<float>(k[n]));
    }
  }
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int b = 0; b < 3; ++b) {
    if (b >= above) break;
    const RowBound bound = bounds[pair_parts - 1 - b];
    for (int n = 0; n < count; ++n) {
      spans[n].cut_above(bound, static_cast<float>(j[n]), static_cast<float>(k[n]));
    }
  }
}

/// Decides unsure voxels, in their order: a voxel that is inside belongs to its pair unless one
/// before it has it. Called by all lanes of a warp.
__device__ __noinline__ inline void decide(CellState& state,
                                           ExactTests tests,
                                           const std::uint32_t* unsure,
                                           int count) {
  for (int first = 0; first < count; first += 32) {
    __syncwarp();
    const bool is_wanted = first + lane_of() < count;
    const std::uint32_t voxel = is_wanted ? unsure[first + lane_of()] : 0;
    const int number = static_cast<int>(voxel >> 9);
    const int r = static_cast<int>(voxel >> cell_shift) & (cell_rows - 1);
    const int i = static_cast<int>(voxel) & (cell_edge - 1);
    const int j = r & (cell_edge - 1), k = r >> cell_shift;
    bool is_inside = is_wanted && tests.is_inside(state, number, i, j, k);
    for (;;) {  // the voxels of one pair at a time, all different
      __syncwarp();
      const unsigned left = __ballot_sync(whole_warp, is_inside);
      if (left == 0) break;
      const int next = __shfl_sync(whole_warp, number, __ffs(static_cast<int>(left)) - 1);
      if (!is_inside || number != next) continue;
      std::uint8_t& owner = state.owners[k][j][i];
      if (owner == 0) atomicAnd(&state.rows[r], ~(1u << i));
      if (owner == 0 || owner > number) owner = static_cast<std::uint8_t>(number);
      is_inside = false;
    }
  }
  __syncwarp();
}

/// Where the search for the owners of a cell is; the same in all lanes.
struct OwnerSearch {
  std::uint32_t* unsure;  ///< voxels that float32 leaves open, see unsure_voxel()
  int room;               ///< for these
  int numbers = 0;        ///< pairs that may own a voxel
  int waiting = 0;        ///< unsure voxels, also those without room
  int exact_tests = 0;
  bool is_plain = true;  ///< else the general kernel has to compute the cell
};

/// Notes the voxels of row r that float32 leaves open. Called by all lanes of a warp.
/// @param number  of the pair
__device__ __forceinline__ void note_unsure(OwnerSearch& search,
                                            int r,
                                            RowBits voxels,
                                            int number) {
  for (;;) {
    const unsigned some = __ballot_sync(whole_warp, voxels != 0);
    if (some == 0) return;
    const int place = search.waiting + __popc(some & ((1u << lane_of()) - 1));
    if (voxels != 0 && place < search.room) {
      search.unsure[place] = unsure_voxel(r, __ffs(static_cast<int>(voxels)) - 1, number);
    }
    voxels &= voxels - (voxels != 0 ? 1 : 0);
    search.waiting += __popc(some);
  }
}

/// The pair that a lane works on: one for all lanes of a warp, or one for each half.
struct PairOfLane {
  int p;         ///< place in the cell's part of the list
  int lane;      ///< among those that work on it
  bool is_half;  ///< each half of the warp has a pair of its own
};

/// Gives voxels without an owner that lie within the tetrahedron of a pair to it, in up to `count`
/// rows of its box per lane. Called by all lanes of a warp.
template <int count, class T>
__device__ __forceinline__ void give_rows(const GroupCell<T>& cell,
                                          const PairOfLane& of,
                                          OwnerSearch& search) {
  CellState& state = cell.state;
  const PairHead head = state.heads[of.p % chunk_pairs];
  const PairRows box = row_box(head);
  int j[count], k[count];
  for (int n = 0; n < count; ++n) {
    const int row = of.lane + 32 * n, layer = row * box.per_width >> 8;
    j[n] = box.first_j + row - layer * box.width;
    k[n] = box.first_k + layer;
  }
  RowSpan spans[count];
  cut_spans<count>(head, state.bounds[of.p % chunk_pairs], j, k, spans);
  RowBits sure[count], unsure[count];
  RowBits some = 0, some_unsure = 0;
  bool is_twice = false;
  for (int n = 0; n < count; ++n) {
    const bool is_in = of.lane + 32 * n < box.count();
    std::uint32_t* const row = state.rows + (is_in ? cell_edge * k[n] + j[n] : 0);
    const RowBits open = is_in ? *row & whole_row : 0;
    sure[n] = spans[n].inside() & open;
    unsure[n] = spans[n].possible() & open & ~sure[n];
    some |= sure[n] | unsure[n];
    some_unsure |= unsure[n];
    const std::uint32_t change =
        (static_cast<std::uint32_t>(__builtin_popcount(open)) << tests_shift) - sure[n];
    if constexpr (count == 1) {
      __syncwarp();  // the other half may read the row, too
      if (open != 0) is_twice = (sure[n] & ~atomicAdd(row, change)) != 0;
    } else {
      if (open != 0) *row += change;
    }
  }
  const unsigned any = __ballot_sync(whole_warp, some != 0);
  if (any == 0) return;
  const unsigned low = of.is_half ? 0xffffu : whole_warp;
  const int in_low = (any & low) != 0 ? 1 : 0, in_high = (any & ~low) != 0 ? 1 : 0;
  const bool is_high = of.is_half && lane_of() >= 16;
  const int number = search.numbers + 1 + (is_high ? in_low : 0);
  if (of.lane == 0 && (is_high ? in_high : in_low) != 0) {
    state.pairs[number] = static_cast<std::uint8_t>(of.p);
  }
  search.numbers += in_low + in_high;
  for (int n = 0; n < count; ++n) {
    if (sure[n] != 0) give(sure[n], number, state.row(j[n], k[n]));
  }
  if (!__any_sync(whole_warp, some_unsure != 0 || is_twice)) return;
  // Two tetrahedra overlap: which of them comes first is not known here.
  if (__any_sync(whole_warp, is_twice)) search.is_plain = false;
  for (int n = 0; n < count; ++n) {
    note_unsure(search, cell_edge * k[n] + j[n], unsure[n], number);
  }
}

/// Gives what is left of a cell to pair p, which holds it whole. Called by all lanes of a warp.
template <class T>
__device__ __forceinline__ void give_rest(const GroupCell<T>& cell, int p, OwnerSearch& search) {
  const int number = ++search.numbers;
  if (lane_of() == 0) cell.state.pairs[number] = static_cast<std::uint8_t>(p);
#if defined(__CUDA_ARCH__)
#pragma unroll 1
#endif
  for (int r = lane_of(); r < cell_rows; r += 32) {
    give(cell.state.rows[r] & whole_row, number,
         cell.state.row(r & (cell_edge - 1), r >> cell_shift));
    cell.state.rows[r] &= ~whole_row;
  }
}

/// The voxels of row r = 8 k + j of a cell that are in the output.
/// @param corner  the cell's first voxel [frame]
TETWARP_HD RowBits row_within(const OutputFrame& frame, const int* corner, int r) {
  const int y = corner[1] + (r & (cell_edge - 1)), z = corner[2] + (r >> cell_shift);
  const bool is_in =
      y >= frame.begin[1] && y < frame.end[1] && z >= frame.begin[2] && z < frame.end[2];
  return is_in ? bits_within(frame.begin[0], frame.end[0], corner[0]) : 0;
}

}  // namespace tetwarp
