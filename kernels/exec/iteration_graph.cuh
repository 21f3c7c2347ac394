/// @file iteration_graph.cuh
/// IterationGraph: iterations that make the same launches each time, as a CUDA graph.
#pragma once
#include "kernels/exec/stream_capture.cuh"

namespace tetwarp {

class IterationGraph {
 public:
  IterationGraph() = default;
  IterationGraph(const IterationGraph&) = delete;
  IterationGraph& operator=(const IterationGraph&) = delete;
  ~IterationGraph() { restart(); }

  /// To be called before the arguments of the launches change.
  void restart() {
    if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
    graph_ = nullptr;
    is_loaded_ = false;
  }

  /// @param run  launches iterations, with the same arguments each time. The first time they run as
  ///             they are, which loads their kernels and takes memory, as a recording must not; the
  ///             second time they are recorded
  template <class Run>
  void launch(cudaStream_t stream, const Run& run) {
    if (!is_loaded_) {
      is_loaded_ = true;
      return run();
    }
    if (graph_ == nullptr) {
      StreamCapture capture(stream);
      run();
      check_cuda(cudaGraphInstantiate(&graph_, capture.end(), 0), "cudaGraphInstantiate");
    }
    check_cuda(cudaGraphLaunch(graph_, stream), "cudaGraphLaunch");
  }

 private:
  bool is_loaded_ = false;
  cudaGraphExec_t graph_ = nullptr;
};

}  // namespace tetwarp
