/// @file part_graphs.cuh
/// Stages in parts, one after the other, as CUDA graphs: the launches are the same every time, one
/// per part.
#pragma once
#include <algorithm>
#include <any>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/base/from_index.hpp"
#include "kernels/base/view.hpp"
#include "kernels/exec/each_kernel.cuh"
#include "kernels/exec/four_lanes.cuh"
#include "kernels/exec/stream_capture.cuh"

namespace tetwarp {

/// One stage: a launch per part. An op with a constant `lanes` is called for each lane of an index:
/// op(lanes i + lane).
class PartGraph {
 public:
  template <class Op>
  PartGraph(cudaStream_t stream,
            std::int64_t multiprocessors,
            View<const std::int64_t> part_start,
            const Op& op) {
    // The first use of a kernel loads it, and loading must not happen while the graph is recorded.
    cudaFuncAttributes attributes;
    check_cuda(cudaFuncGetAttributes(&attributes,
                                     reinterpret_cast<const void*>(&each_kernel<FromIndex<Op>>)),
               "cudaFuncGetAttributes");
    StreamCapture capture(stream);
    for (std::int64_t k = 0; k + 1 < part_start.size; ++k) {
      const std::int64_t count = lanes_of<Op> * (part_start[k + 1] - part_start[k]);
      const EachShape shape = each_shape(count, multiprocessors);
      launch(stream, each_kernel<FromIndex<Op>>, shape.blocks, shape.threads, 0, count,
             FromIndex<Op>{op, lanes_of<Op> * part_start[k]});
    }
    check_cuda(cudaGraphInstantiate(&graph_, capture.end(), 0), "cudaGraphInstantiate");
  }
  PartGraph(const PartGraph&) = delete;
  PartGraph& operator=(const PartGraph&) = delete;
  ~PartGraph() { cudaGraphExecDestroy(graph_); }

  void launch_on(cudaStream_t stream) const {
    check_cuda(cudaGraphLaunch(graph_, stream), "cudaGraphLaunch");
  }

 private:
  cudaGraphExec_t graph_ = nullptr;
};

/// The graphs of several stages, recorded on demand.
class PartGraphs {
 public:
  /// @param multiprocessors  of the device
  /// @param part_start       in memory of the host
  template <class Op>
  void launch(cudaStream_t stream,
              std::int64_t multiprocessors,
              View<const std::int64_t> part_start,
              const Op& op) {
    auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& known) {
      const Op* const recorded = std::any_cast<Op>(&known.op);
      return known.part_start == part_start && recorded != nullptr && *recorded == op;
    });
    if (entry == entries_.end()) {
      entries_.push_back(
          {part_start, op, std::make_unique<PartGraph>(stream, multiprocessors, part_start, op)});
      entry = entries_.end() - 1;
    }
    entry->graph->launch_on(stream);
  }
  void clear() { entries_.clear(); }

 private:
  struct Entry {
    View<const std::int64_t> part_start;
    std::any op;  ///< arguments of the recorded launches
    std::unique_ptr<PartGraph> graph;
  };

  std::vector<Entry> entries_;
};

}  // namespace tetwarp
