/// @file cell_group.cuh
/// Stage "raster" of the warp as a CUDA kernel, for plain images: a warp takes a cell. It finds the
/// owners of the voxels row by row, from where rows cross the faces of tetrahedra, and then samples
/// them. Warps do not wait for each other.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/cuda/cell_raster.cuh"
#include "kernels/warp/interior_sample.hpp"

namespace tetwarp {

constexpr int group_cells = 4;  ///< of a block, side by side along i, one per warp
constexpr int group_threads = 32 * group_cells;
constexpr int pair_parts = 4;     ///< threads of a pair: one face each, three a row of the map
constexpr int lane_rows = 2;      ///< rows of a cell per lane, four apart along k
constexpr int group_blocks = 8;   ///< per multiprocessor at least: leaves 64 registers per thread
constexpr int column_flight = 2;  ///< voxels of a lane whose samples are loaded together
constexpr unsigned whole_warp = 0xffffffffu;

/// The owners of a cell's voxels [k][j][i]: an owner's number among the cell's pairs, from 1; 0:
/// none.
struct alignas(8) CellOwners {
  std::uint8_t at[cell_edge][cell_edge][cell_edge];
};

/// What a warp keeps in dynamic shared memory of the pairs of its cell, in the order of the list.
struct GroupPairs {
  PairMap* maps;     ///< after one that voxels without an owner use
  RowBound* bounds;  ///< four per pair, those from below first, those from above last
  PairHead* heads;
};

/// Bytes of the GroupPairs of all warps of a block.
/// @param capacity  pairs of a block that have room
inline std::size_t group_bytes(int capacity) {
  const auto count = static_cast<std::size_t>(capacity);
  return (count + group_cells) * sizeof(PairMap) +
         count * (pair_parts * sizeof(RowBound) + sizeof(PairHead));
}

/// Those of a warp.
/// @param first  pairs of the warps before
__device__ __forceinline__ GroupPairs group_pairs(int capacity, int warp, int first) {
  auto* const maps = dynamic_shared<PairMap>();
  auto* const bounds = reinterpret_cast<RowBound*>(maps + capacity + group_cells);
  auto* const heads = reinterpret_cast<PairHead*>(bounds + pair_parts * capacity);
  return {maps + first + warp, bounds + pair_parts * first, heads + first};
}

/// A cell of the block.
struct GroupCell {
  CellClass state;
  std::uint32_t begin;  ///< its first pair in the list
  int pairs;
};

/// The cell of each of the first four lanes; those beyond the output are kept.
template <class T>
__device__ __forceinline__ GroupCell group_cell(const RasterJob<T>& job) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const int ci = static_cast<int>(blockIdx.x) * group_cells + lane;
  if (lane >= group_cells || ci >= job.frame.cells[0]) return {CellClass::keep, 0, 0};
  const std::int64_t number =
      job.frame.cell_index(ci, static_cast<int>(blockIdx.y), static_cast<int>(blockIdx.z));
  const CellRange range = job.ranges[number];
  return {likely_class(job, number, range), range.begin, static_cast<int>(range.end - range.begin)};
}

/// The room of a cell among that of its block, which plain cells take in turn.
/// @param cell  of the first four lanes
/// @returns  the cell's first place; `capacity` if its pairs do not fit. Every warp finds the same.
__device__ __forceinline__ int place_of(const GroupCell& cell, int capacity, int warp) {
  const int wanted = cell.state == CellClass::plain ? cell.pairs : 0;
  int sum = 0, place = capacity;
  for (int c = 0; c < group_cells; ++c) {
    const int pairs = __shfl_sync(whole_warp, wanted, c);
    const bool fits = sum + pairs <= capacity;
    if (c == warp && fits) place = sum;
    sum += fits ? pairs : 0;
  }
  return place;
}

/// Stores what the voxels of a cell need of its pairs, four lanes per pair. Called by all lanes of
/// a warp.
/// @param corner  the cell's first voxel [frame]
/// @returns  the cell's class: plain, rim or general
template <class T>
__device__ __forceinline__ CellClass set_pairs(const RasterJob<T>& job,
                                               const GroupCell& cell,
                                               const int* corner,
                                               const GroupPairs& pairs) {
  const int lane = static_cast<int>(threadIdx.x) % 32, part = lane & (pair_parts - 1);
  const int shift = lane & (32 - pair_parts), row = min_of(part, 2);
  if (lane == 0) {
    PairMap none = {};
    none.source = job.source.data;
    none.tet = -1;
    pairs.maps[0] = none;
  }
  bool is_plain = true, is_rim = false;
  for (int first = 0; first < cell.pairs; first += 32 / pair_parts) {
    const int p = first + lane / pair_parts;
    const bool is_wanted = p < cell.pairs;
    const CellPair pair = job.pairs[cell.begin + static_cast<unsigned>(min_of(p, cell.pairs - 1))];
    const TetSetup& tet = job.setups[tet_of(pair)];
    bool is_cut;
    const RowBound bound = row_bound(tet, part, corner, is_cut);
    double start, linear[3];
    map_start_along(tet, corner, row, start, linear);
    const double lower = whole_voxel(start), relative = lower - job.source.origin[row];
    const bool is_good = is_blended(job, tet) && fabs(relative) < most_whole;
    const int whole = is_good ? static_cast<int>(relative) : 0;
    is_plain = is_plain && is_good;
    is_rim = is_rim || !maps_inside(job.source.origin[row], job.source.dims[row], start, linear);

    const auto of_pair = [&](bool vote) {
      return __ballot_sync(whole_warp, vote) >> shift & ((1u << pair_parts) - 1);
    };
    const bool is_below = bound.margin > 0;
    const unsigned below = of_pair(is_cut && is_below), above = of_pair(is_cut && !is_below);
    int from[3];
    for (int r = 0; r < 3; ++r) from[r] = __shfl_sync(whole_warp, whole, r, pair_parts);
    if (!is_wanted) continue;
    if (is_cut) {
      const int rank = __popc((is_below ? below : above) & ((1u << part) - 1));
      pairs.bounds[pair_parts * p + (is_below ? rank : pair_parts - 1 - rank)] = bound;
    }
    PairMap& map = pairs.maps[p + 1];
    if (part < 3) {
      map.base[part] = static_cast<float>(start - lower);
      for (int axis = 0; axis < 3; ++axis) {
        map.axis[axis][part] = static_cast<float>(linear[axis]);
      }
      map.whole[part] = static_cast<float>(whole);
    } else {
      map.source = job.source.data + voxel_of(job.source, from[0], from[1], from[2]);
      map.tet = tet_of(pair);
      pairs.heads[p] = pair_head(tet, corner) | (is_accepted(pair) ? accepted_cell : 0u) |
                       static_cast<unsigned>(__popc(below)) << below_bits |
                       static_cast<unsigned>(__popc(above)) << above_bits;
    }
  }
  if (!__all_sync(whole_warp, is_plain)) return CellClass::general;
  return __any_sync(whole_warp, is_rim) ? CellClass::rim : CellClass::plain;
}

/// Four bits as the bytes of a word, 0 or 1 each.
TETWARP_HD std::uint32_t bytes_of(std::uint32_t bits) {
  return (bits & 15u) * 0x00204081u & 0x01010101u;
}

/// The owners of a row.
struct RowOwners {
  RowBits open;                       ///< voxels without an owner yet
  std::uint32_t numbers[2] = {0, 0};  ///< a byte per voxel, as in CellOwners

  /// Gives voxels to pair p of the cell.
  TETWARP_HD void give(RowBits voxels, int p) {
    const auto number = static_cast<std::uint32_t>(p + 1);
    numbers[0] += bytes_of(voxels) * number;
    numbers[1] += bytes_of(voxels >> 4) * number;
    open &= ~voxels;
  }
};

/// The rows of a lane: row r is that of layer k + 4 r.
struct LaneRows {
  int j, k;
  RowOwners rows[lane_rows];
  int inside_tests = 0;

  TETWARP_HD RowBits open() const { return rows[0].open | rows[1].open; }
};

/// Cuts the spans of a lane's rows by the faces of a pair.
TETWARP_HD void cut_spans(const LaneRows& lane,
                          PairHead head,
                          const RowBound* bounds,
                          RowSpan* spans) {
  const float j = static_cast<float>(lane.j);
  const int below = static_cast<int>(head >> below_bits & 3u);
  const int above = static_cast<int>(head >> above_bits & 3u);
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int b = 0; b < 3; ++b) {
    if (b >= below) break;
    const RowBound bound = bounds[b];
    for (int r = 0; r < lane_rows; ++r) {
      spans[r].cut_below(bound, j, static_cast<float>(lane.k + 4 * r));
    }
  }
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int b = 0; b < 3; ++b) {
    if (b >= above) break;
    const RowBound bound = bounds[pair_parts - 1 - b];
    for (int r = 0; r < lane_rows; ++r) {
      spans[r].cut_above(bound, j, static_cast<float>(lane.k + 4 * r));
    }
  }
}

/// Finds the owners of a lane's rows among the pairs of its cell.
/// @param decide  decide(pair, row, unsure) returns those of the voxels `unsure` that are inside
template <class Decide>
TETWARP_HD void find_owners(LaneRows& lane,
                            const PairHead* heads,
                            const RowBound* bounds,
                            int pairs,
                            const Decide& decide) {
  for (int p = 0; p < pairs && lane.open() != 0; ++p) {
    const PairHead head = heads[p];
    if ((head & accepted_cell) != 0) {
      for (RowOwners& row : lane.rows) row.give(row.open, p);
      return;
    }
    const PairHead layers = (head >> lane.j & 1u) != 0 ? head >> (layer_bits + lane.k) & 0x11u : 0;
    if (layers == 0) continue;
    RowSpan spans[lane_rows];
    cut_spans(lane, head, bounds + pair_parts * p, spans);
    for (int r = 0; r < lane_rows; ++r) {
      RowOwners& row = lane.rows[r];
      const RowBits tested = (layers >> 4 * r & 1u) != 0 ? row.open : 0;
      lane.inside_tests += __builtin_popcount(tested);
      const RowBits sure = spans[r].inside() & tested;
      row.give(sure | decide(p, r, spans[r].possible() & tested & ~sure), p);
    }
  }
}

/// The same with exact tests: for rows some of whose voxels float32 leaves open.
/// @param corner  the cell's first voxel [frame]
/// @returns  number of exact tests
TETWARP_HD_RARE int find_owners_exactly(LaneRows& lane,
                                        GroupPairs pairs,
                                        int count,
                                        const int* corner,
                                        View<const Node> nodes,
                                        const std::int32_t* tets) {
  int tests = 0;
  find_owners(lane, pairs.heads, pairs.bounds, count, [&](int p, int r, RowBits unsure) {
    RowBits inside = 0;
    if (unsure == 0) return inside;
    const TetNodes tet = tet_nodes(nodes, tets + std::int64_t{4} * pairs.maps[p + 1].tet);
    for (int i = 0; i < cell_edge; ++i) {
      if ((unsure >> i & 1u) == 0) continue;
      ++tests;
      if (is_inside_exact(tet, corner[0] + i, corner[1] + lane.j, corner[2] + lane.k + 4 * r)) {
        inside |= 1u << i;
      }
    }
    return inside;
  });
  return tests;
}

/// The sum of a number over the lanes of a warp.
__device__ __forceinline__ int lane_sum(int mine) {
  for (int step = 16; step > 0; step /= 2) mine += __shfl_xor_sync(whole_warp, mine, step);
  return mine;
}

/// Finds the owners of the voxels of a cell, and counts. Called by all lanes of a warp.
/// @param number  of the cell
/// @param corner  its first voxel [frame]
template <class T>
__device__ __forceinline__ void set_owners(const RasterJob<T>& job,
                                           std::int64_t number,
                                           int count,
                                           const int* corner,
                                           const GroupPairs& pairs,
                                           CellOwners& owners) {
  const int thread = static_cast<int>(threadIdx.x) % 32;
  const OutputFrame& frame = job.frame;
  LaneRows lane{thread & 7, thread >> cell_shift, {}};
  const int y = corner[1] + lane.j;
  const RowBits row = y >= frame.begin[1] && y < frame.end[1]
                          ? bits_within(frame.begin[0], frame.end[0], corner[0])
                          : 0;
  const unsigned layers = bits_within(frame.begin[2], frame.end[2], corner[2]) >> lane.k;
  RowBits all[lane_rows];
  for (int r = 0; r < lane_rows; ++r) {
    lane.rows[r].open = all[r] = (layers >> 4 * r & 1u) != 0 ? row : 0;
  }
  RowBits unsure = 0;
  find_owners(lane, pairs.heads, pairs.bounds, count, [&](int, int, RowBits voxels) {
    unsure |= voxels;
    return RowBits{0};
  });
  int exact_tests = 0;
  if (unsure != 0) {
    LaneRows again{lane.j, lane.k, {}};
    for (int r = 0; r < lane_rows; ++r) again.rows[r].open = all[r];
    exact_tests = find_owners_exactly(again, pairs, count, corner, job.nodes, job.tets.data);
    lane = again;
  }
  int covered = 0;
  for (int r = 0; r < lane_rows; ++r) {
    auto* const out = reinterpret_cast<std::uint32_t*>(owners.at[lane.k + 4 * r][lane.j]);
    for (int w = 0; w < 2; ++w) out[w] = lane.rows[r].numbers[w];
    covered += __popc(all[r] & ~lane.rows[r].open);
  }
  covered = lane_sum(covered);
  const int inside_tests = lane_sum(lane.inside_tests);
  if (thread == 0 && job.cell_covered.size > 0) {
    job.cell_covered[number] = static_cast<std::uint16_t>(covered);
  }
  if (job.counts == nullptr) return;
  RasterCounts& counts = job.counts[number & (job.count_places - 1)];
  if (exact_tests != 0) atomic_add(&counts.exact_tests, std::int64_t{exact_tests});
  if (thread != 0) return;
  if (covered != 0) atomic_add(&counts.covered, std::int64_t{covered});
  if (inside_tests != 0) atomic_add(&counts.inside_tests, std::int64_t{inside_tests});
}

/// Successive voxels along k of an output.
struct GroupColumn {
  unsigned stored;     ///< bit k: the voxel of layer k of the cell is to be stored
  std::int64_t first;  ///< place of the voxel of layer 0 in the output
  int slice;           ///< voxels of a layer of the output

  __device__ __forceinline__ bool is_stored(int k) const { return (stored >> k & 1u) != 0; }
};

/// The column of the cells' voxels (x, y) [frame].
__device__ __forceinline__ GroupColumn column_at(const OutputFrame& frame, int x, int y) {
  const int z = static_cast<int>(blockIdx.z) * cell_edge;
  const bool is_in =
      x >= frame.begin[0] && x < frame.end[0] && y >= frame.begin[1] && y < frame.end[1];
  return {is_in ? bits_within(frame.begin[2], frame.end[2], z) : 0, frame.offset_of(x, y, z),
          (frame.end[0] - frame.begin[0]) * (frame.end[1] - frame.begin[1])};
}

/// Computes and stores the voxels of a column. Called by all lanes of a warp.
/// @tparam is_rim  whether positions may leave the source
/// @param i, j     in the cell
template <bool is_rim, class T>
__device__ __forceinline__ void store_column(const RasterJob<T>& job,
                                             const GroupColumn& column,
                                             const PairMap* maps,
                                             const CellOwners& owners,
                                             int i,
                                             int j) {
  const SourceSteps steps(job.source.dims);
  const auto x_i = static_cast<float>(i), x_j = static_cast<float>(j);
  T* const out = kept(job.volume + column.first);
#if defined(__CUDACC__)
#pragma unroll 1
#endif
  for (int k = 0; k < cell_edge; k += column_flight) {
    InteriorTap taps[column_flight];
    SampleCube<T> cubes[column_flight];
    bool is_defined[column_flight];
    for (int v = 0; v < column_flight; ++v) {
      const int owner = owners.at[k + v][j][i];
      const PairMap& map = maps[owner];
      float x[3];
      local_position(map, x_i, x_j, static_cast<float>(k + v), x);
      const T* source = static_cast<const T*>(map.source);
      is_defined[v] = owner != 0;
      if constexpr (is_rim) {
        const RimTap tap = rim_tap(map.whole, job.source.dims, x);
        is_defined[v] = is_defined[v] && tap.is_defined;
        if (!tap.is_defined) source = job.source.data;
        taps[v] = tap.tap;
        cubes[v] = steps.cube(source + steps.offset_of(tap.tap), tap);
      } else {
        taps[v] = interior_tap(x);
        cubes[v] = steps.cube(kept(source + steps.offset_of(taps[v])));
      }
    }
    for (int v = 0; v < column_flight; ++v) {
      const T value = kept(interior_value(cubes[v], taps[v]));  // all of them without branches
      if (column.is_stored(k + v)) {
        out[(k + v) * column.slice] = is_defined[v] ? value : job.background;
      }
    }
  }
}

/// Stores mask and owners of a column.
template <class T>
__device__ __forceinline__ void store_owners(const RasterJob<T>& job,
                                             const GroupColumn& column,
                                             const PairMap* maps,
                                             const CellOwners& owners,
                                             int i,
                                             int j) {
  for (int k = 0; k < cell_edge; ++k) {
    if (!column.is_stored(k)) continue;
    const std::int64_t at = column.first + k * column.slice;
    const int owner = owners.at[k][j][i];
    if (job.mask != nullptr) job.mask[at] = owner != 0;
    if (job.tet != nullptr) job.tet[at] = maps[owner].tet;
  }
}

/// Stores background in a column.
template <class T>
__device__ __forceinline__ void store_background(const RasterJob<T>& job,
                                                 const GroupColumn& column) {
  T* const out = kept(job.volume + column.first);
  for (int k = 0; k < cell_edge; ++k) {
    if (column.is_stored(k)) out[k * column.slice] = job.background;
  }
  if (job.mask == nullptr && job.tet == nullptr) return;
  for (int k = 0; k < cell_edge; ++k) {
    if (!column.is_stored(k)) continue;
    if (job.mask != nullptr) job.mask[column.first + k * column.slice] = 0;
    if (job.tet != nullptr) job.tet[column.first + k * column.slice] = -1;
  }
}

/// Stores background in the voxels of a block without pairs, in rows across its cells. Called by
/// all threads.
/// @param state  of the cell of the first four lanes
template <class T>
__device__ __forceinline__ void store_blank(const RasterJob<T>& job, CellClass state) {
  const int lane = static_cast<int>(threadIdx.x) % 32, warp = static_cast<int>(threadIdx.x) / 32;
  const int of_cell = __shfl_sync(whole_warp, static_cast<int>(state), lane >> cell_shift);
  const int first_cell = static_cast<int>(blockIdx.x) * group_cells;
  const int cj = static_cast<int>(blockIdx.y), ck = static_cast<int>(blockIdx.z);
  if (warp == 0 && state == CellClass::plain && job.cell_covered.size > 0) {
    job.cell_covered[job.frame.cell_index(first_cell + lane, cj, ck)] = 0;
  }
  for (int j = warp; j < cell_edge; j += group_cells) {
    GroupColumn column = column_at(job.frame, first_cell * cell_edge + lane, cj * cell_edge + j);
    if (of_cell != static_cast<int>(CellClass::plain)) column.stored = 0;
    store_background(job, column);
  }
}

/// Computes all cells of the output but those that it lists.
///
/// Blocks: (groups of four cells along i, cells along j, cells along k). Threads: group_threads.
/// Shared: owners of four cells, 2 KiB, and group_bytes(capacity).
/// @param capacity       pairs of a block that have room
/// @param general        out, numbers of the other cells, in any order
/// @param general_count  their number is added
template <class T>
__global__ void __launch_bounds__(group_threads, group_blocks) cell_group_kernel(
    RasterJob<T> job, int capacity, std::uint32_t* general, std::int32_t* general_count) {
  __shared__ CellOwners all_owners[group_cells];
  const int lane = static_cast<int>(threadIdx.x) % 32, warp = static_cast<int>(threadIdx.x) / 32;
  GroupCell cell = group_cell(job);
  const bool is_blank =
      cell.state == CellClass::keep || (cell.state == CellClass::plain && cell.pairs == 0);
  if (__all_sync(whole_warp, is_blank)) return store_blank(job, cell.state);

  const int place = place_of(cell, capacity, warp);
  cell.state = static_cast<CellClass>(__shfl_sync(whole_warp, static_cast<int>(cell.state), warp));
  cell.begin = __shfl_sync(whole_warp, cell.begin, warp);
  cell.pairs = __shfl_sync(whole_warp, cell.pairs, warp);
  if (cell.state == CellClass::keep) return;
  const int ci = static_cast<int>(blockIdx.x) * group_cells + warp;
  const int cj = static_cast<int>(blockIdx.y), ck = static_cast<int>(blockIdx.z);
  const int corner[3] = {ci * cell_edge, cj * cell_edge, ck * cell_edge};
  const std::int64_t number = job.frame.cell_index(ci, cj, ck);
  const GroupPairs pairs = group_pairs(capacity, warp, place);
  CellOwners& owners = all_owners[warp];
  if (place + cell.pairs > capacity) cell.state = CellClass::general;
  if (cell.state == CellClass::plain) cell.state = set_pairs(job, cell, corner, pairs);
  if (cell.state == CellClass::general) {
    if (lane == 0) general[atomicAdd(general_count, 1)] = static_cast<std::uint32_t>(number);
    return;
  }
  __syncwarp();
  set_owners(job, number, cell.pairs, corner, pairs, owners);
  __syncwarp();
  const int i = lane & (cell_edge - 1);
#if defined(__CUDACC__)
#pragma unroll 1
#endif
  for (int j = lane >> cell_shift; j < cell_edge; j += 32 / cell_edge) {
    const GroupColumn column = column_at(job.frame, corner[0] + i, corner[1] + j);
    if (cell.pairs == 0) {
      store_background(job, column);
      continue;
    }
    if (cell.state == CellClass::rim) {
      store_column<true>(job, column, pairs.maps, owners, i, j);
    } else {
      store_column<false>(job, column, pairs.maps, owners, i, j);
    }
    if (job.mask == nullptr && job.tet == nullptr) continue;
    store_owners(job, column, pairs.maps, owners, i, j);
  }
}

}  // namespace tetwarp
