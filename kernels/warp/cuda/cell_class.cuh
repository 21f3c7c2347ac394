/// @file cell_class.cuh
/// Stage "raster" of the warp as a CUDA kernel: chooses the work of cells and lists them by class,
/// with all that their voxels need. Cells have a thread each, their pairs four threads each.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/cell_work.hpp"

namespace tetwarp {

constexpr int class_threads = 128;
constexpr int class_cells = 32;  ///< of a block, one per lane of its first warp
constexpr int pair_parts = 4;    ///< threads of a pair: one plane each, three a row of the map

/// A cell while its pairs are looked at.
struct ClassedCell {
  CellClass likely;
  int corner[3];        ///< first voxel [frame]
  std::uint32_t begin;  ///< first pair
  std::uint32_t count;  ///< pairs to look at
  RecordRange range;    ///< of a cell that is likely tested
  int failed;           ///< nonzero: a pair needs the general kernel
};

/// What the threads of a block share.
struct ClassBlock {
  ClassedCell cells[class_cells];
  PairMap maps[class_cells];  ///< of interior cells
  std::uint32_t begin, end;   ///< pairs of all these cells
};

/// The place in a list of this lane's item; one atomic addition per warp. All lanes of the warp
/// call it.
__device__ __forceinline__ int place_in_list(bool has_item, std::int32_t* count) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const unsigned items = __ballot_sync(0xffffffffu, has_item);
  int first = 0;
  if (lane == 0 && items != 0) first = atomicAdd(count, __popc(items));
  first = __shfl_sync(0xffffffffu, first, 0);
  return first + __popc(items & ((1u << lane) - 1));
}

/// The first of this lane's `size` places in a list; one atomic addition per warp. All lanes of the
/// warp call it.
__device__ __forceinline__ std::uint32_t places_in_list(std::uint32_t size, std::uint32_t* count) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  std::uint32_t sum = size;  // of this lane and those below
  for (int step = 1; step < 32; step *= 2) {
    const std::uint32_t below = __shfl_up_sync(0xffffffffu, sum, static_cast<unsigned>(step));
    if (lane >= step) sum += below;
  }
  std::uint32_t first = 0;
  if (lane == 31 && sum != 0) first = atomicAdd(count, sum);
  return __shfl_sync(0xffffffffu, first, 31) + sum - size;
}

/// Sets the cells of a block, and takes units for those that are likely tested.
/// Called by the first warp.
template <class T>
__device__ __forceinline__ void plan_cells(const CellWorkBody<T>& work,
                                           std::int64_t first_cell,
                                           CellListCounts* counts,
                                           ClassBlock& block) {
  const RasterJob<T>& job = work.job;
  const int lane = static_cast<int>(threadIdx.x);
  const std::int64_t cell = first_cell + lane, cell_count = job.frame.cell_count();
  ClassedCell plan = {};
  plan.likely = CellClass::keep;
  if (cell < cell_count) {
    if (cell < work.work.size) work(cell);
    const CellRange range = job.ranges[cell];
    job.frame.set_corner(static_cast<std::uint32_t>(cell), plan.corner);  // listed by 32 bits
    plan.likely = likely_class(job, cell, range, plan.corner);
    const bool is_listed = plan.likely == CellClass::interior || plan.likely == CellClass::tested;
    plan.begin = range.begin;
    plan.count = is_listed ? range.end - range.begin : 0;
    if (lane == 0) block.begin = range.begin;
    if (lane == class_cells - 1 || cell == cell_count - 1) block.end = range.end;
  }
  const bool is_tested = plan.likely == CellClass::tested;
  plan.range.units = is_tested ? cell_units + plan.count * pair_units : 0;
  plan.range.first = places_in_list(plan.range.units, &counts->units);
  block.cells[lane] = plan;
}

/// What one of the threads of a pair computes of it. All loads come before the first store.
struct PairPart {
  bool is_inside;  ///< the pair is blended, and its samples lie in the source along `row`
  int row;         ///< of the map, 0 to 2
  double start, linear[3], whole;  ///< from map_start_along() and whole_voxel()
  CellPlane plane;
  std::uint32_t voxels;  ///< from box_bits()
};

template <class T>
__device__ __forceinline__ PairPart
pair_part(const RasterJob<T>& job, CellPair pair, const int* corner, int part) {
  const TetSetup& tet = job.setups[tet_of(pair)];
  PairPart mine;
  mine.row = min_of(part, 2);
  map_start_along(tet, corner, mine.row, mine.start, mine.linear);
  mine.whole = whole_voxel(mine.start);
  const int origin = job.source.origin[mine.row], dim = job.source.dims[mine.row];
  mine.is_inside = is_blended(job, tet) && maps_inside(origin, dim, mine.start, mine.linear);
  mine.plane = cell_plane(tet, part, corner);
  mine.voxels = box_bits(tet, corner, is_accepted(pair));
  return mine;
}

/// Looks at the pairs of the block's cells: writes the records of tested cells, and the maps of
/// interior ones. Called by all threads.
template <class T>
__device__ __forceinline__ void set_records(const RasterJob<T>& job,
                                            std::int64_t first_cell,
                                            RecordUnit* units,
                                            ClassBlock& block) {
  const int thread = static_cast<int>(threadIdx.x), part = thread & (pair_parts - 1);
  const std::uint32_t end = block.end;
  for (std::uint32_t first = block.begin; first < end; first += class_threads / pair_parts) {
    const std::uint32_t p = first + static_cast<unsigned>(thread / pair_parts);
    const CellPair pair = job.pairs[min_of(p, end - 1)];
    const auto place = static_cast<int>(cell_of(pair) - first_cell);
    ClassedCell& cell = block.cells[place];
    const bool is_wanted = p < end && p - cell.begin < cell.count;
    PairPart mine = {};
    if (is_wanted) mine = pair_part(job, pair, cell.corner, part);
    const unsigned inside = __ballot_sync(0xffffffffu, mine.is_inside);
    const bool is_good = (inside >> (thread & (32 - pair_parts)) & 15u) == 15u;
    if (is_wanted && !is_good && part == 0) atomicAdd(&cell.failed, 1);
    int from[3];
    for (int r = 0; r < 3; ++r) {
      from[r] = __shfl_sync(0xffffffffu, static_cast<int>(mine.whole), r, pair_parts);
    }
    if (!is_good) continue;

    auto* const records = reinterpret_cast<PairRecord*>(units + (cell.range.first + cell_units));
    PairRecord& record = records[p - cell.begin];
    const bool is_interior = cell.likely == CellClass::interior;
    PairMap& map = is_interior ? block.maps[place] : record.map;
    if (!is_interior) set_cell_plane(mine.plane, part, record.planes);
    if (part < 3) {
      map.base[part] = static_cast<float>(mine.start - mine.whole);
      for (int axis = 0; axis < 3; ++axis) {
        map.axis[axis][part] = static_cast<float>(mine.linear[axis]);
      }
    } else {
      const int* const origin = job.source.origin;
      map.source = job.source.data + voxel_of(job.source, from[0] - origin[0], from[1] - origin[1],
                                              from[2] - origin[2]);
      map.tet = tet_of(pair);
      map.voxels = mine.voxels;
    }
  }
}

/// Lists the cells of a block. Called by the first warp.
template <class T>
__device__ __forceinline__ void list_cells(const RasterJob<T>& job,
                                           std::int64_t first_cell,
                                           const CellLists& lists,
                                           const ClassBlock& block) {
  const int lane = static_cast<int>(threadIdx.x);
  const std::int64_t cell = first_cell + lane;
  const ClassedCell& plan = block.cells[lane];
  const CellClass found = plan.failed != 0 ? CellClass::general : plan.likely;
  const int at_interior = place_in_list(found == CellClass::interior, &lists.counts->interior);
  const int at_tested = place_in_list(found == CellClass::tested, &lists.counts->tested);
  const int at_general = place_in_list(found == CellClass::general, &lists.counts->general);
  const int* const corner = plan.corner;
  const std::int64_t output = job.frame.offset_of(corner[0], corner[1], corner[2]);
  if (found == CellClass::interior) {
    lists.interior[at_interior] = {block.maps[lane], output};
    if (job.cell_covered.size > 0) job.cell_covered[cell] = cell_edge * cell_edge * cell_edge;
  } else if (found == CellClass::tested) {
    *reinterpret_cast<TestedCell*>(lists.units + plan.range.first) = {
        output,
        {corner[0], corner[1], corner[2]},
        static_cast<std::uint32_t>(cell),
        static_cast<std::int32_t>(plan.count)};
    lists.tested[at_tested] = plan.range;
  } else if (found == CellClass::general) {
    lists.general[at_general] = static_cast<std::uint32_t>(cell);
  }
}

/// Chooses the work of each cell where that is to be done, and lists cells by class. The order of a
/// list depends on the device's scheduling; each cell is written on its own, so that the output
/// does not.
///
/// Blocks: one per class_cells cells. Threads: class_threads. Shared: a ClassBlock, 3.3 KiB.
/// @param lists  the counts are zeros
template <class T>
__global__ void __launch_bounds__(class_threads)
    cell_class_kernel(CellWorkBody<T> work, CellLists lists) {
  __shared__ ClassBlock block;
  const std::int64_t first_cell = std::int64_t{blockIdx.x} * class_cells;
  const bool is_first_warp = threadIdx.x < class_cells;
  if (is_first_warp) plan_cells(work, first_cell, lists.counts, block);
  __syncthreads();
  set_records(work.job, first_cell, lists.units, block);
  __syncthreads();
  if (is_first_warp) list_cells(work.job, first_cell, lists, block);
}

}  // namespace tetwarp
