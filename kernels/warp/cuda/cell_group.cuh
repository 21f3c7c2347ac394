/// @file cell_group.cuh
/// Stage "raster" of the warp as a CUDA kernel, for plain images: a warp takes a cell. It finds the
/// owners of the voxels, see cell_search.cuh, and then samples them. Warps do not wait for each
/// other.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/cuda/cell_raster.cuh"
#include "kernels/warp/cuda/cell_search.cuh"
#include "kernels/warp/sample/interior_sample.hpp"

namespace tetwarp {

constexpr int group_cells = 4;  ///< of a block, side by side along i, one per warp
constexpr int group_threads = 32 * group_cells;
constexpr int group_blocks = 8;   ///< per multiprocessor at least: leaves 64 registers per thread
constexpr int column_flight = 2;  ///< voxels of a lane whose samples are loaded together

/// Dynamic shared memory of a block. Per cell: first the voxels that float32 leaves open, then the
/// maps of its pairs after one that voxels without an owner use.
/// @param capacity  maps of a cell that have room
inline std::size_t group_bytes(int capacity) {
  return static_cast<std::size_t>(group_cells) * static_cast<std::size_t>(capacity + 1) *
         sizeof(PairMap);
}

/// Unsure voxels of a cell that have room.
TETWARP_HD int words_of(int capacity) {
  return (capacity + 1) * static_cast<int>(sizeof(PairMap) / sizeof(std::uint32_t));
}

/// The samples of a job, as they are (Sample = T) or packed.
template <class Sample, class T>
__device__ __forceinline__ const Sample* samples_of(const RasterJob<T>& job) {
  if constexpr (std::is_same_v<Sample, T>) {
    return job.source.data;
  } else {
    return job.packed;
  }
}

/// Where the maps of a cell's pairs may be computed.
struct MapClass {
  bool is_plain = true;  ///< else by the general kernel
  bool is_rim = false;   ///< a position may leave the source

  /// Of the lanes of a warp together.
  __device__ __forceinline__ CellClass of_warp() const {
    if (!__all_sync(whole_warp, is_plain)) return CellClass::general;
    return __any_sync(whole_warp, is_rim) ? CellClass::rim : CellClass::plain;
  }
};

/// Stores the map of a pair by four lanes. Called by all lanes of a warp.
/// @param is_wanted  else nothing is stored
template <class Sample, class T>
__device__ __forceinline__ void set_map(
    const GroupCell<T>& cell, int p, bool is_wanted, PairMap& map, MapClass& found) {
  const RasterJob<T>& job = cell.job;
  const int part = lane_of() & (pair_parts - 1), row = min_of(part, 2);
  const TetSetup& tet = cell.setup(p);
  double start, linear[3];
  map_start_along(tet, cell.corner, row, start, linear);
  const double lower = whole_voxel(start), relative = lower - job.source.origin[row];
  const bool is_good = is_blended(job, tet) && fabs(relative) < most_whole;
  const int whole = is_good ? static_cast<int>(relative) : 0;
  found.is_plain = found.is_plain && is_good;
  found.is_rim =
      found.is_rim || !maps_inside(job.source.origin[row], job.source.dims[row], start, linear);
  int from[3];
  for (int r = 0; r < 3; ++r) from[r] = __shfl_sync(whole_warp, whole, r, pair_parts);
  if (!is_wanted) return;
  if (part < 3) {
    map.base[part] = static_cast<float>(start - lower);
    for (int axis = 0; axis < 3; ++axis) map.axis[axis][part] = static_cast<float>(linear[axis]);
    map.whole[part] = static_cast<float>(whole);
  } else {
    map.source = samples_of<Sample>(job) + voxel_of(job.source, from[0], from[1], from[2]);
    map.tet = tet_of(cell.pairs[p]);
  }
}

/// Sets bounds and heads of the pairs from `first` on, four lanes per pair. Called by all lanes of
/// a warp.
template <class T>
__device__ __forceinline__ void set_bounds(const GroupCell<T>& cell, int first) {
  const int part = lane_of() & (pair_parts - 1), slot = lane_of() / pair_parts;
  const int p = first + slot, last = cell.count - 1;
  const TetSetup& tet = cell.setup(min_of(p, last));
  bool is_cut;
  const RowBound bound = row_bound(tet, part, cell.corner, is_cut);
  const auto of_pair = [&](bool vote) {
    return __ballot_sync(whole_warp, vote) >> (lane_of() - part) & ((1u << pair_parts) - 1);
  };
  const bool is_below = bound.margin > 0;
  const unsigned below = of_pair(is_cut && is_below), above = of_pair(is_cut && !is_below);
  if (is_cut) {
    const int rank = __popc((is_below ? below : above) & ((1u << part) - 1));
    cell.state.bounds[slot][is_below ? rank : pair_parts - 1 - rank] = bound;
  }
  if (part == 0 && p <= last) {
    cell.state.heads[slot] = pair_head(tet, cell.corner) |
                             (is_accepted(cell.pairs[p]) ? accepted_cell : 0u) |
                             static_cast<unsigned>(__popc(below)) << below_bits |
                             static_cast<unsigned>(__popc(above)) << above_bits;
  }
}

/// Finds the owners of the voxels of a cell. Pairs come one after the other, small ones two at a
/// time; for each the lanes take the rows of its box. Called by all lanes of a warp.
template <class T>
__device__ __forceinline__ void find_owners(const GroupCell<T>& cell, OwnerSearch& search) {
  CellState& state = cell.state;
  const bool is_single = cell.is_single();
#if defined(__CUDA_ARCH__)
#pragma unroll 1
#endif
  for (int r = lane_of(); r < cell_rows; r += 32) {
    state.rows[r] = is_single ? 0 : row_within(cell.job.frame, cell.corner, r);
    std::uint32_t* const owners = state.row(r & (cell_edge - 1), r >> cell_shift);
    owners[0] = owners[1] = is_single ? 0x01010101u : 0;
  }
  if (is_single) {
    if (lane_of() == 0) state.pairs[1] = 0;
    search.numbers = 1;
    return;
  }
  for (int first = 0; first < cell.count; first += chunk_pairs) {
    __syncwarp();
    set_bounds(cell, first);
    const int past = min_of(first + chunk_pairs, cell.count);
    const auto rows_of = [&](int p) {
      if (p >= past) return cell_rows;
      const PairHead head = state.heads[p - first];
      return (head & accepted_cell) != 0 ? cell_rows + 1 : row_box(head).count();
    };
    for (int p = first; p < past; ++p) {
      __syncwarp();
      const int rows = rows_of(p);
      if (rows > cell_rows) {
        give_rest(cell, p, search);
      } else if (rows > 32) {
        give_rows<2>(cell, {p, lane_of(), false}, search);
      } else {
        const bool is_half = rows <= 16 && rows_of(p + 1) <= 16;
        const int lanes = is_half ? 16 : 32, second = lane_of() / lanes;
        give_rows<1>(cell, {p + second, lane_of() - lanes * second, is_half}, search);
        p += is_half ? 1 : 0;
      }
    }
    if (search.waiting >= (past < cell.count ? 32 : 1)) {
      search.exact_tests += search.waiting;
      search.is_plain = search.is_plain && search.waiting <= search.room;
      decide(state, cell.tests(), search.unsure, min_of(search.waiting, search.room));
      search.waiting = 0;
    }
  }
}

/// Stores the maps of the pairs of a cell that may own a voxel, four lanes per pair. Called by all
/// lanes of a warp.
template <class Sample, class T>
__device__ __forceinline__ void set_maps(const GroupCell<T>& cell,
                                         int count,
                                         PairMap* maps,
                                         MapClass& found) {
  for (int first = 1; first <= count; first += chunk_pairs) {
    const int number = first + lane_of() / pair_parts;
    set_map<Sample>(cell, cell.state.pairs[min_of(number, count)], number <= count, maps[number],
                    found);
  }
}

/// Finds owners and maps of a cell. Called by all lanes of a warp.
/// @param maps         room for `capacity` after one that voxels without an owner use; out
/// @param exact_tests  out, their number
template <class Sample, class T>
__device__ __forceinline__ CellClass
prepare(const GroupCell<T>& cell, int capacity, PairMap* maps, int& exact_tests) {
  OwnerSearch search = {reinterpret_cast<std::uint32_t*>(maps), words_of(capacity)};
  find_owners(cell, search);
  exact_tests = search.exact_tests;
  if (!search.is_plain || search.numbers > capacity) return CellClass::general;
  __syncwarp();
  MapClass found;
  set_maps<Sample>(cell, search.numbers, maps, found);
  if (lane_of() == 0) {
    PairMap none = {};
    none.source = samples_of<Sample>(cell.job);
    none.tet = -1;
    maps[0] = none;
  }
  return found.of_warp();
}

/// The sum of a number over the lanes of a warp.
__device__ __forceinline__ int lane_sum(int mine) {
  for (int step = 16; step > 0; step /= 2) mine += __shfl_xor_sync(whole_warp, mine, step);
  return mine;
}

/// Adds a cell to the counts of the job. Called by all lanes of a warp.
/// @param number  of the cell
template <class T>
__device__ __forceinline__ void count_cell(const GroupCell<T>& cell,
                                           std::int64_t number,
                                           int exact_tests) {
  const RasterJob<T>& job = cell.job;
  int covered = 0, inside_tests = 0;
#if defined(__CUDA_ARCH__)
#pragma unroll 1
#endif
  for (int r = lane_of(); r < cell_rows; r += 32) {
    const std::uint32_t row = cell.state.rows[r];
    covered += __popc(row_within(job.frame, cell.corner, r) & ~row);
    inside_tests += static_cast<int>(row >> tests_shift);
  }
  covered = lane_sum(covered);
  inside_tests = lane_sum(inside_tests);
  if (lane_of() != 0) return;
  if (job.cell_covered.size > 0) job.cell_covered[number] = static_cast<std::uint16_t>(covered);
  if (job.counts == nullptr) return;
  RasterCounts& counts = job.counts[number & (job.count_places - 1)];
  if (covered != 0) atomic_add(&counts.covered, std::int64_t{covered});
  if (inside_tests != 0) atomic_add(&counts.inside_tests, std::int64_t{inside_tests});
  if (exact_tests != 0) atomic_add(&counts.exact_tests, std::int64_t{exact_tests});
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

/// Computes and stores the voxels of a column.
/// @param load  (k, tap, cube): loads the samples of voxel k; @returns whether it has a value, else
///              it is background
template <class T, class Load>
__device__ __forceinline__ void store_loaded(const RasterJob<T>& job,
                                             const GroupColumn& column,
                                             const Load& load) {
  T* const out = kept(job.volume + column.first);
#if defined(__CUDACC__)
#pragma unroll 1
#endif
  for (int k = 0; k < cell_edge; k += column_flight) {
    InteriorTap taps[column_flight];
    SampleCube<T> cubes[column_flight];
    bool has_value[column_flight];
    for (int v = 0; v < column_flight; ++v) has_value[v] = load(k + v, taps[v], cubes[v]);
    for (int v = 0; v < column_flight; ++v) {
      const T value = kept(interior_value(cubes[v], taps[v]));  // all of them without branches
      if (column.is_stored(k + v)) {
        out[(k + v) * column.slice] = has_value[v] ? value : job.background;
      }
    }
  }
}

/// Computes and stores the voxels of a column. Called by all lanes of a warp.
/// @tparam is_rim  whether positions may leave the source
/// @tparam Sample  see samples_of()
/// @param i, j     in the cell
template <bool is_rim, class Sample, class T>
__device__ __forceinline__ void store_column(const RasterJob<T>& job,
                                             const GroupColumn& column,
                                             const PairMap* maps,
                                             const CellState& state,
                                             int i,
                                             int j) {
  const SourceSteps steps(job.source.dims);
  const auto x_i = static_cast<float>(i), x_j = static_cast<float>(j);
  store_loaded(job, column, [&](int k, InteriorTap& of, SampleCube<T>& cube) {
    const int owner = state.owners[k][j][i];
    const PairMap& map = maps[owner];
    float x[3];
    local_position(map, x_i, x_j, static_cast<float>(k), x);
    const Sample* source = static_cast<const Sample*>(map.source);
    if constexpr (is_rim) {
      const RimTap tap = rim_tap(map.whole, job.source.dims, x);
      if (!tap.is_defined) source = samples_of<Sample>(job);
      of = tap.tap;
      cube = steps.cube(source + steps.offset_of(of), tap);
      return owner != 0 && tap.is_defined;
    } else {
      of = interior_tap(x);
      cube = steps.cube(kept(source + steps.offset_of(of)));
      return owner != 0;
    }
  });
}

/// The same for a cell that one tetrahedron holds, within the source.
template <class Sample, class T>
__device__ __forceinline__ void store_single_column(
    const RasterJob<T>& job, const GroupColumn& column, const PairMap& shared_map, int i, int j) {
  const SourceSteps steps(job.source.dims);
  const PairMap map = shared_map;
  const Sample* const source = kept(static_cast<const Sample*>(map.source));
  const auto x_i = static_cast<float>(i), x_j = static_cast<float>(j);
  store_loaded(job, column, [&](int k, InteriorTap& tap, SampleCube<T>& cube) {
    float x[3];
    local_position(map, x_i, x_j, static_cast<float>(k), x);
    tap = interior_tap(x);
    cube = steps.cube(source + steps.offset_of(tap));
    return true;
  });
}

/// Stores mask and owners of a column.
template <class T>
__device__ __forceinline__ void store_owners(const RasterJob<T>& job,
                                             const GroupColumn& column,
                                             const PairMap* maps,
                                             const CellState& state,
                                             int i,
                                             int j) {
#if defined(__CUDA_ARCH__)
#pragma unroll 1
#endif
  for (int k = 0; k < cell_edge; ++k) {
    if (!column.is_stored(k)) continue;
    const std::int64_t at = column.first + k * column.slice;
    const int owner = state.owners[k][j][i];
    if (job.mask != nullptr) job.mask[at] = owner != 0;
    if (job.tet != nullptr) job.tet[at] = maps[owner].tet;
  }
}

/// Stores background in a column.
template <class T>
__device__ __forceinline__ void store_background(const RasterJob<T>& job,
                                                 const GroupColumn& column) {
  T* const out = kept(job.volume + column.first);
#if defined(__CUDA_ARCH__)
#pragma unroll 1
#endif
  for (int k = 0; k < cell_edge; ++k) {
    if (column.is_stored(k)) out[k * column.slice] = job.background;
  }
  if (job.mask == nullptr && job.tet == nullptr) return;
#if defined(__CUDA_ARCH__)
#pragma unroll 1
#endif
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
/// Shared: CellState of four cells, 7 KiB, and group_bytes(capacity).
/// @tparam Sample        see samples_of()
/// @param capacity       maps of a cell that have room
/// @param general        out, numbers of the other cells, in any order
/// @param general_count  their number is added
template <class T, class Sample>
__global__ void __launch_bounds__(group_threads, group_blocks) cell_group_kernel(
    RasterJob<T> job, int capacity, std::uint32_t* general, std::int32_t* general_count) {
  __shared__ CellState states[group_cells];
  const int lane = lane_of(), warp = static_cast<int>(threadIdx.x) / 32;
  const int cj = static_cast<int>(blockIdx.y), ck = static_cast<int>(blockIdx.z);
  const int first = static_cast<int>(blockIdx.x) * group_cells;
  // The first four lanes of each warp look at the cells of the block.
  CellClass state = CellClass::keep;
  CellRange range = {0, 0};
  if (lane < group_cells && first + lane < job.frame.cells[0]) {
    const std::int64_t number = job.frame.cell_index(first + lane, cj, ck);
    range = job.ranges[number];
    state = likely_class(job, number, range);
  }
  const bool is_blank =
      state == CellClass::keep || (state == CellClass::plain && range.begin == range.end);
  if (__all_sync(whole_warp, is_blank)) return store_blank(job, state);

  state = static_cast<CellClass>(__shfl_sync(whole_warp, static_cast<int>(state), warp));
  range = {__shfl_sync(whole_warp, range.begin, warp), __shfl_sync(whole_warp, range.end, warp)};
  if (state == CellClass::keep) return;
  const int ci = first + warp;
  const std::int64_t number = job.frame.cell_index(ci, cj, ck);
  const GroupCell<T> cell = {job,
                             {ci * cell_edge, cj * cell_edge, ck * cell_edge},
                             job.pairs.data + range.begin,
                             static_cast<int>(range.end - range.begin),
                             states[warp]};
  PairMap* const maps = dynamic_shared<PairMap>() + warp * (capacity + 1);
  if (state == CellClass::plain) {
    int exact_tests = 0;
    state = prepare<Sample>(cell, capacity, maps, exact_tests);
    if (state != CellClass::general) count_cell(cell, number, exact_tests);
  }
  if (state == CellClass::general) {
    if (lane == 0) general[atomicAdd(general_count, 1)] = static_cast<std::uint32_t>(number);
    return;
  }
  __syncwarp();
  const int i = lane & (cell_edge - 1);
#if defined(__CUDACC__)
#pragma unroll 1
#endif
  for (int j = lane >> cell_shift; j < cell_edge; j += 32 / cell_edge) {
    const GroupColumn column = column_at(job.frame, cell.corner[0] + i, cell.corner[1] + j);
    if (cell.count == 0) {
      store_background(job, column);
      continue;
    }
    if (state == CellClass::plain && cell.is_single()) {
      store_single_column<Sample>(job, column, maps[1], i, j);
    } else if (state == CellClass::rim) {
      store_column<true, Sample>(job, column, maps, cell.state, i, j);
    } else {
      store_column<false, Sample>(job, column, maps, cell.state, i, j);
    }
    if (job.mask == nullptr && job.tet == nullptr) continue;
    store_owners(job, column, maps, cell.state, i, j);
  }
}

}  // namespace tetwarp
