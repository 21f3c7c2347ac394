/// @file graph.hpp
/// CUDA graphs on the emulated device: a graph is the list of work captured from a stream.
#pragma once
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "kernels/emu/device.hpp"

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names
using cudaGraph_t = tetwarp::simt::Recording*;
using cudaGraphExec_t = tetwarp::simt::Recording*;
enum cudaStreamCaptureMode { cudaStreamCaptureModeThreadLocal };

inline cudaError_t cudaStreamBeginCapture(cudaStream_t stream, cudaStreamCaptureMode) {
  const std::lock_guard guard(tetwarp::simt::Device::only().lock);
  auto* const own = static_cast<tetwarp::simt::Stream*>(stream);
  if (own == nullptr || own->recording) return cudaErrorInvalidValue;
  own->recording.emplace();
  return cudaSuccess;
}
inline cudaError_t cudaStreamEndCapture(cudaStream_t stream, cudaGraph_t* graph) {
  const std::lock_guard guard(tetwarp::simt::Device::only().lock);
  auto* const own = static_cast<tetwarp::simt::Stream*>(stream);
  if (!own->recording) return cudaErrorInvalidValue;
  *graph = new tetwarp::simt::Recording(std::move(*own->recording));
  own->recording.reset();
  return cudaSuccess;
}
inline cudaError_t cudaGraphInstantiate(cudaGraphExec_t* exec, cudaGraph_t graph, unsigned) {
  *exec = new tetwarp::simt::Recording(*graph);
  return cudaSuccess;
}
inline cudaError_t cudaGraphLaunch(cudaGraphExec_t exec, cudaStream_t stream) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  device.note(tetwarp::simt::ApiCall::launch);
  auto* const own = static_cast<tetwarp::simt::Stream*>(stream);
  for (const auto& work : *exec) own->enqueue(work);
  device.run_eager();
  return cudaSuccess;
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
