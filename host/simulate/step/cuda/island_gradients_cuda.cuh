/// @file island_gradients_cuda.cuh
/// IslandGradients on a device: a block solves a small island, a grid or the whole device a large
/// one.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/simulate/step/island_gradients.hpp"
#include "kernels/body/island_cg.hpp"
#include "kernels/body/island_team.cuh"
#include "kernels/exec/device_limits.cuh"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/exec/iteration_graph.cuh"

namespace tetwarp {

/// Runs several iterations of island_cg() as one graph.
struct GraphIterations {
  static constexpr std::int64_t most = 8;

  /// Of the rows that island_cg() solves: the arrays of a stepper stay where they are.
  IterationGraph& graph;

  template <class Iteration>
  void run(CudaExec& exec, std::int64_t count, const Iteration& iteration) const {
    const auto run_all = [&] {
      for (std::int64_t i = 0; i < count; ++i) iteration.run(exec);
    };
    if (count == most) return graph.launch(exec.stream(), run_all);
    run_all();
  }
};

/// Times of an iteration, estimated. A block reads the rows of its island through one
/// multiprocessor: about 1.1 KB a row in float64 at 64 B per cycle, the rate of the L2 cache. An
/// iteration of a grid has three synchronizations of it.
inline TeamTimes iteration_times(const IslandRows& island) {
  const auto rows = static_cast<double>(island.end - island.begin);
  return {2e-6 + 10e-9 * rows, 6e-6 + 0.1e-9 * rows};
}

template <>
class IslandGradients<CudaExec> {
 public:
  /// @param exec  kept by the caller
  explicit IslandGradients(CudaExec& exec)
      : exec_(exec), large_exec_(exec, StageClocks::off), limits_(device_limits(exec.number())) {
    scalars_.resize(1);
  }

  /// Sets the first row of each island, and the end; sorts them by what solves them.
  void set_islands(const std::vector<std::int32_t>& island_start) {
    std::vector<IslandRows> islands;
    for (std::size_t i = 0; i + 1 < island_start.size(); ++i) {
      islands.push_back({island_start[i], island_start[i + 1]});
    }
    const auto size = [](const IslandRows& rows) { return rows.end - rows.begin; };
    std::stable_sort(islands.begin(), islands.end(),
                     [&](const IslandRows& a, const IslandRows& b) { return size(a) > size(b); });
    std::vector<TeamTimes> times;
    for (const IslandRows& island : islands) times.push_back(iteration_times(island));
    const auto first_small = islands.begin() + static_cast<std::ptrdiff_t>(
                                                   count_by_grid(times, limits_.multiprocessors));
    large_.assign(islands.begin(), first_small);
    islands.erase(islands.begin(), first_small);
    narrow_begin_ =
        std::find_if(islands.begin(), islands.end(),
                     [&](const IslandRows& island) { return size(island) <= narrow_threads; }) -
        islands.begin();
    exec_.put(islands, small_);
    const auto count = static_cast<std::int64_t>(large_.size()) + small_.view().size;
    ends_.resize(count);
    host_ends_.reserve(count);
    large_exec_.reserve_sums<PlainSums<2>>(island_start.back());
    sums_.resize(large_.empty() ? 0 : GridTeam::sum_bytes(size(large_[0])));
    graphs_ = std::vector<IterationGraph>(large_.size());
  }

  /// Solves the islands and calls take(end) for each, until one is stopped. A solve that the caller
  /// may end runs large islands on the whole device stage by stage: a single launch has no end but
  /// its own.
  /// @param proceed  as of island_cg()
  template <class T, class Proceed, class Take>
  void solve(const GradientArrays<T>& arrays,
             const GradientOptions& options,
             const Proceed& proceed,
             const Take& take) {
    if (!proceed(0)) {
      GradientEnd stopped;
      stopped.is_stopped = true;
      return take(stopped);
    }
    exec_.timed(gradient_label(), [&] {
      const bool uses_grid = limits_.is_cooperative && !options.is_watched;
      solve_by_blocks<narrow_threads>(arrays, options, narrow_begin_, small_.view().size);
      solve_by_blocks<wide_threads>(arrays, options, 0, narrow_begin_);
      for (std::size_t i = 0; i < large_.size() && uses_grid; ++i) {
        solve_by_grid(arrays, options, i);
      }
      take_ends(small_.view().size + (uses_grid ? static_cast<std::int64_t>(large_.size()) : 0),
                take);
      for (std::size_t i = 0; i < large_.size() && !uses_grid; ++i) {
        const GradientEnd end =
            island_cg(large_exec_, arrays, large_[i].begin, large_[i].end, options,
                      scalars_.view().data, proceed, GraphIterations{graphs_[i]});
        take(end);
        if (end.is_stopped) return;
      }
    });
  }

 private:
  /// Threads of a block: one per row of a small island, or as many as 128 registers each allow.
  static constexpr int narrow_threads = 128, wide_threads = 512;

  template <int threads, class T>
  void solve_by_blocks(const GradientArrays<T>& arrays,
                       const GradientOptions& options,
                       std::int64_t first,
                       std::int64_t last) {
    if (first == last) return;
    const View<const IslandRows> islands = {const_view(small_).data + first, last - first};
    launch(exec_.stream(), island_cg_kernel<T, threads>, dim3(static_cast<unsigned>(islands.size)),
           dim3(threads), TeamOfBlock<threads>::shared_bytes, arrays, islands, options,
           View<GradientEnd>{ends_.view().data + first, islands.size});
  }

  template <class T>
  void solve_by_grid(const GradientArrays<T>& arrays,
                     const GradientOptions& options,
                     std::size_t i) {
    int resident = 0;
    check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&resident, island_cg_grid_kernel<T>,
                                                             sum_threads, GridTeam::shared_bytes),
               "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
    const std::int64_t blocks =
        std::min((large_[i].end - large_[i].begin + sum_threads - 1) / sum_threads,
                 resident * limits_.multiprocessors);
    const std::int64_t place = small_.view().size + static_cast<std::int64_t>(i);
    launch_cooperative(exec_.stream(), island_cg_grid_kernel<T>,
                       dim3(static_cast<unsigned>(blocks)), dim3(sum_threads),
                       GridTeam::shared_bytes, arrays, large_[i], options, sums_.view().data,
                       View<GradientEnd>{ends_.view().data + place, 1});
  }

  /// Reads the first `count` ends.
  template <class Take>
  void take_ends(std::int64_t count, const Take& take) {
    if (count == 0) return;
    const View<GradientEnd> ends = host_ends_.view(count);
    exec_.get(View<const GradientEnd>{const_view(ends_).data, count}, ends.data);
    for (std::int64_t i = 0; i < count; ++i) take(ends[i]);
  }

  CudaExec& exec_;
  CudaExec large_exec_;  ///< of large islands; its launches are parts of one time, or of a graph
  DeviceLimits limits_;
  DeviceVector<IslandScalars> scalars_;
  DeviceVector<IslandRows> small_;  ///< by falling size
  std::int64_t narrow_begin_ = 0;   ///< the first of them for narrow blocks
  std::vector<IslandRows> large_;
  std::vector<IterationGraph> graphs_;  ///< of them
  DeviceVector<std::byte> sums_;        ///< of a grid
  DeviceVector<GradientEnd> ends_;      ///< of small islands, then of large ones
  PinnedBuffer<GradientEnd> host_ends_;
};

}  // namespace tetwarp
