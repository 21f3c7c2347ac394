/// @file island_gradients_cuda.cuh
/// IslandGradients on a device: a block solves a small island, the whole device a large one.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/step/island_gradients.hpp"
#include "kernels/body/island_block.cuh"
#include "kernels/body/island_cg.hpp"
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

template <>
class IslandGradients<CudaExec> {
 public:
  /// @param exec  kept by the caller
  explicit IslandGradients(CudaExec& exec) : exec_(exec), large_exec_(exec, StageClocks::off) {
    scalars_.resize(1);
  }

  /// Sets the first row of each island, and the end; sorts them by whether one block solves them.
  void set_islands(const std::vector<std::int32_t>& island_start) {
    std::vector<IslandRows> small;
    large_.clear();
    for (std::size_t i = 0; i + 1 < island_start.size(); ++i) {
      const IslandRows rows = {island_start[i], island_start[i + 1]};
      (rows.end - rows.begin <= block_rows ? small : large_).push_back(rows);
    }
    exec_.put(small, small_);
    ends_.resize(small_.view().size);
    host_ends_.reserve(small_.view().size);
    large_exec_.reserve_sums<PlainSums<2>>(island_start.back());
    graphs_ = std::vector<IterationGraph>(large_.size());
  }

  /// Solves the islands and calls take(end) for each, until one is stopped.
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
      if (small_.view().size > 0) solve_small(arrays, options, take);
      for (std::size_t i = 0; i < large_.size(); ++i) {
        const GradientEnd end =
            island_cg(large_exec_, arrays, large_[i].begin, large_[i].end, options,
                      scalars_.view().data, proceed, GraphIterations{graphs_[i]});
        take(end);
        if (end.is_stopped) return;
      }
    });
  }

 private:
  static constexpr std::int64_t block_rows = 1024;  ///< larger islands use the whole device

  template <class T, class Take>
  void solve_small(const GradientArrays<T>& arrays,
                   const GradientOptions& options,
                   const Take& take) {
    const View<const IslandRows> small = const_view(small_);
    launch(exec_.stream(), island_cg_kernel<T>, dim3(static_cast<unsigned>(small.size)),
           dim3(sum_threads), IslandExec<BlockTeam>::shared_bytes, arrays, small, options,
           ends_.view());
    const View<GradientEnd> ends = host_ends_.view(small.size);
    exec_.get(const_view(ends_), ends.data);
    for (std::int64_t i = 0; i < ends.size; ++i) take(ends[i]);
  }

  CudaExec& exec_;
  CudaExec large_exec_;  ///< of large islands; its launches are parts of one time, or of a graph
  DeviceVector<GradientScalars> scalars_;
  DeviceVector<IslandRows> small_;
  DeviceVector<GradientEnd> ends_;
  PinnedBuffer<GradientEnd> host_ends_;
  std::vector<IslandRows> large_;
  std::vector<IterationGraph> graphs_;  ///< of them
};

}  // namespace tetwarp
