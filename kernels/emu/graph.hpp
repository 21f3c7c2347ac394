/// @file graph.hpp
/// CUDA graphs on the emulated device: a graph is the list of work captured from a stream.
#pragma once
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "kernels/emu/runtime.hpp"

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names
using cudaGraph_t = tetwarp::simt::Recording*;
using cudaGraphExec_t = tetwarp::simt::Recording*;
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
inline cudaError_t cudaGraphInstantiate(cudaGraphExec_t* exec, cudaGraph_t graph, unsigned) {
  return tetwarp::simt::call(true, [&](const auto&) {
    *exec = new tetwarp::simt::Recording(*graph);
    return cudaSuccess;
  });
}
inline cudaError_t cudaGraphLaunch(cudaGraphExec_t exec, cudaStream_t stream) {
  return tetwarp::simt::call(true, [&](auto& device) {
    device.note(tetwarp::simt::ApiCall::launch);
    auto& own = device.stream(stream);
    for (const auto& work : *exec) own.enqueue(work);
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
