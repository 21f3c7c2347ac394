/// @file sweep_graph.cuh
/// Sweeps over colors as CUDA graphs: a sweep makes the same launches every time, one per color.
#pragma once
#include <algorithm>
#include <any>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/contact/contact_sweep.hpp"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/exec/stream_capture.cuh"

namespace tetwarp {

/// One sweep over colors: a launch per color.
class SweepGraph {
 public:
  template <class Body>
  SweepGraph(cudaStream_t stream, View<const std::int64_t> color_start, const Body& body) {
    // The first use of a kernel loads it, and loading must not happen while the graph is recorded.
    cudaFuncAttributes attributes;
    check_cuda(cudaFuncGetAttributes(
                   &attributes, reinterpret_cast<const void*>(&each_kernel<FromContact<Body>>)),
               "cudaFuncGetAttributes");
    StreamCapture capture(stream);
    for (std::int64_t k = 0; k + 1 < color_start.size; ++k) {
      const std::int64_t count = color_start[k + 1] - color_start[k];
      launch(stream, each_kernel<FromContact<Body>>,
             dim3(static_cast<unsigned>((count + each_threads - 1) / each_threads)),
             dim3(each_threads), 0, count, FromContact<Body>{body, color_start[k]});
    }
    check_cuda(cudaGraphInstantiate(&graph_, capture.end(), 0), "cudaGraphInstantiate");
  }
  SweepGraph(const SweepGraph&) = delete;
  SweepGraph& operator=(const SweepGraph&) = delete;
  ~SweepGraph() { cudaGraphExecDestroy(graph_); }

  void launch_on(cudaStream_t stream) const {
    check_cuda(cudaGraphLaunch(graph_, stream), "cudaGraphLaunch");
  }

 private:
  cudaGraphExec_t graph_ = nullptr;
};

/// The graphs of one solve, recorded on demand.
class SweepGraphs {
 public:
  /// @param color_start  in memory of the host
  template <class Body>
  void launch(cudaStream_t stream, View<const std::int64_t> color_start, const Body& body) {
    auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& known) {
      const Body* const recorded = std::any_cast<Body>(&known.body);
      return known.color_start == color_start && recorded != nullptr && *recorded == body;
    });
    if (entry == entries_.end()) {
      entries_.push_back(
          {color_start, body, std::make_unique<SweepGraph>(stream, color_start, body)});
      entry = entries_.end() - 1;
    }
    entry->graph->launch_on(stream);
  }
  void clear() { entries_.clear(); }

 private:
  struct Entry {
    View<const std::int64_t> color_start;
    std::any body;  ///< arguments of the recorded launches
    std::unique_ptr<SweepGraph> graph;
  };

  std::vector<Entry> entries_;
};

}  // namespace tetwarp
