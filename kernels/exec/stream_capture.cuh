/// @file stream_capture.cuh
/// StreamCapture: records launches as a CUDA graph.
#pragma once
#include "kernels/exec/exec_buffer.cuh"

namespace tetwarp {

/// Records the launches on a stream during its life; an exception ends the recording.
class StreamCapture {
 public:
  explicit StreamCapture(cudaStream_t stream) : stream_(stream) {
    check_cuda(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal),
               "cudaStreamBeginCapture");
  }
  StreamCapture(const StreamCapture&) = delete;
  StreamCapture& operator=(const StreamCapture&) = delete;
  ~StreamCapture() {
    if (is_recording_) cudaStreamEndCapture(stream_, &graph_);
    if (graph_ != nullptr) cudaGraphDestroy(graph_);
  }

  /// @return  the graph, owned by this object
  cudaGraph_t end() {
    is_recording_ = false;
    check_cuda(cudaStreamEndCapture(stream_, &graph_), "cudaStreamEndCapture");
    return graph_;
  }

 private:
  cudaStream_t stream_;
  cudaGraph_t graph_ = nullptr;
  bool is_recording_ = true;
};

}  // namespace tetwarp
