/// @file graph.hpp
/// CUDA graphs on the emulated device: a graph is a list of work, captured from a stream or made of
/// kernels one after the other.
#pragma once
#include <cstddef>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "tests/emulator/runtime.hpp"

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names
using cudaGraph_t = tetwarp::simt::Recording*;
using cudaGraphExec_t = tetwarp::simt::Recording*;
using cudaGraphNode_t = std::size_t;  ///< position in the list, from 1 on
enum cudaStreamCaptureMode { cudaStreamCaptureModeThreadLocal };

struct cudaFuncAttributes {
  int numRegs;
};
/// Loads a kernel, so that it can be captured.
inline cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* attributes, const void* kernel) {
  return tetwarp::simt::call(true, [&](auto& device) {
    *attributes = {0};
    device.load(kernel);
    return cudaSuccess;
  });
}

inline cudaError_t cudaStreamBeginCapture(cudaStream_t stream, cudaStreamCaptureMode) {
  return tetwarp::simt::call(false, [&](auto& device) {
    auto& own = device.stream(stream);
    if (stream == nullptr || own.recording) return cudaErrorInvalidValue;
    own.recording.emplace();
    own.recorded_by = std::this_thread::get_id();
    return cudaSuccess;
  });
}
inline cudaError_t cudaStreamEndCapture(cudaStream_t stream, cudaGraph_t* graph) {
  return tetwarp::simt::call(true, [&](auto& device) {
    auto& own = device.stream(stream);
    if (!own.recording) return cudaErrorInvalidValue;
    *graph = new tetwarp::simt::Recording(std::move(*own.recording));
    own.recording.reset();
    return cudaSuccess;
  });
}
struct cudaKernelNodeParams {
  void* func;
  dim3 gridDim, blockDim;
  unsigned sharedMemBytes;
  void** kernelParams;
  void** extra;
  std::function<void()> run;  ///< of the emulation: runs the kernel
};
inline cudaError_t cudaGraphCreate(cudaGraph_t* graph, unsigned) {
  *graph = new tetwarp::simt::Recording;
  return cudaSuccess;
}
/// A node must depend on the one added before it, and on no other.
inline cudaError_t cudaGraphAddKernelNode(cudaGraphNode_t* node,
                                          cudaGraph_t graph,
                                          const cudaGraphNode_t* before,
                                          std::size_t before_count,
                                          const cudaKernelNodeParams* parameters) {
  return tetwarp::simt::call(true, [&](auto& device) {
    const std::size_t last = graph->size();
    if (before_count != (last > 0 ? 1 : 0) || (last > 0 && *before != last)) {
      return cudaErrorInvalidValue;
    }
    device.load(parameters->func);
    graph->push_back(parameters->run);
    *node = graph->size();
    return cudaSuccess;
  });
}
/// Changes later launches; those that are pending keep their arguments.
inline cudaError_t cudaGraphExecKernelNodeSetParams(cudaGraphExec_t exec,
                                                    cudaGraphNode_t node,
                                                    const cudaKernelNodeParams* parameters) {
  return tetwarp::simt::call(true, [&](const auto&) {
    if (node == 0 || node > exec->size()) return cudaErrorInvalidValue;
    (*exec)[node - 1] = parameters->run;
    return cudaSuccess;
  });
}
inline cudaError_t cudaGraphInstantiate(cudaGraphExec_t* exec, cudaGraph_t graph, unsigned) {
  return tetwarp::simt::call(true, [&](const auto&) {
    *exec = new tetwarp::simt::Recording(*graph);
    return cudaSuccess;
  });
}
inline cudaError_t cudaGraphLaunch(cudaGraphExec_t exec, cudaStream_t stream) {
  return tetwarp::simt::call(true, [&](auto& device) {
    device.note(tetwarp::simt::ApiCall::graph);
    auto& own = device.stream(stream);
    for (const auto& work : *exec) {
      device.note(tetwarp::simt::ApiCall::launch);
      own.enqueue(work);
    }
    device.run_eager();
    return cudaSuccess;
  });
}
inline cudaError_t cudaGraphDestroy(cudaGraph_t graph) {
  delete graph;
  return cudaSuccess;
}
inline cudaError_t cudaGraphExecDestroy(cudaGraphExec_t exec) {
  delete exec;
  return cudaSuccess;
}
// NOLINTEND(readability-identifier-naming)
