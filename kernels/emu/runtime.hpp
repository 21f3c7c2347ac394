/// @file runtime.hpp
/// CUDA's runtime functions on the emulated device, to test host code that calls them.
///
/// Work on a stream runs as late as CUDA permits: when the host waits for it. A test can choose one
/// stream whose work runs as early as events permit. Code that reads a result without waiting for
/// it, or overwrites memory that a pending copy still reads, therefore computes wrong results.
/// Copies whose direction contradicts their addresses fail. Device::take_calls() returns the
/// recorded calls. All functions may be called from any thread.
#pragma once
#include <cstddef>
#include <cstring>
#include <mutex>
#include <vector>

#include "kernels/emu/device.hpp"

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names
using cudaEvent_t = tetwarp::simt::Event*;
enum cudaError_t { cudaSuccess, cudaErrorInvalidValue };
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost, cudaMemcpyDeviceToDevice };
constexpr unsigned cudaStreamNonBlocking = 1, cudaEventDisableTiming = 2;

enum cudaMemoryType { cudaMemoryTypeUnregistered, cudaMemoryTypeHost, cudaMemoryTypeDevice };
constexpr unsigned cudaHostRegisterPortable = 1;

struct cudaPointerAttributes {
  cudaMemoryType type;
};
struct cudaDeviceProp {
  char name[32];
};

inline const char* cudaGetErrorString(cudaError_t error) {
  return error == cudaSuccess ? "no error" : "invalid value";
}
inline cudaError_t cudaSetDevice(int) {
  return cudaSuccess;
}
inline cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int) {
  *properties = {"emulation"};
  return cudaSuccess;
}

template <class T>
cudaError_t cudaMalloc(T** data, std::size_t size) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  device.note(tetwarp::simt::ApiCall::allocate);
  *data = static_cast<T*>(device.allocate(size, false));
  return cudaSuccess;
}
template <class T>
cudaError_t cudaMallocHost(T** data, std::size_t size) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  device.note(tetwarp::simt::ApiCall::allocate);
  *data = static_cast<T*>(device.allocate(size, true));
  return cudaSuccess;
}
inline cudaError_t cudaFree(void* data) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  if (data == nullptr) return cudaSuccess;
  device.note(tetwarp::simt::ApiCall::release);
  return device.release(data) ? cudaSuccess : cudaErrorInvalidValue;
}
inline cudaError_t cudaFreeHost(void* data) {
  return cudaFree(data);
}
inline cudaError_t cudaHostRegister(void* data, std::size_t size, unsigned) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  device.pin(data, size);
  return cudaSuccess;
}
inline cudaError_t cudaHostUnregister(void* data) {
  return cudaFree(data);
}
inline cudaError_t cudaPointerGetAttributes(cudaPointerAttributes* attributes, const void* data) {
  const auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(tetwarp::simt::Device::only().lock);
  attributes->type = device.is_pinned(data, 1)      ? cudaMemoryTypeHost
                     : device.is_on_device(data, 1) ? cudaMemoryTypeDevice
                                                    : cudaMemoryTypeUnregistered;
  return cudaSuccess;
}

inline cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  *stream = device.make_stream();
  return cudaSuccess;
}
inline cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  if (stream != nullptr) device.end_stream(static_cast<tetwarp::simt::Stream*>(stream));
  return cudaSuccess;
}
inline cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  device.note(tetwarp::simt::ApiCall::wait);
  auto* const own = static_cast<tetwarp::simt::Stream*>(stream);
  own->run_until(own->queued);
  device.run_eager();
  return cudaSuccess;
}

inline cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) {
  *event = new tetwarp::simt::Event;
  return cudaSuccess;
}
inline cudaError_t cudaEventDestroy(cudaEvent_t event) {
  delete event;
  return cudaSuccess;
}
inline cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  const std::lock_guard guard(tetwarp::simt::Device::only().lock);
  auto* const own = static_cast<tetwarp::simt::Stream*>(stream);
  *event = {own, own->queued};
  return cudaSuccess;
}
inline cudaError_t cudaEventSynchronize(cudaEvent_t event) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  device.note(tetwarp::simt::ApiCall::wait);
  event->pass();
  device.run_eager();
  return cudaSuccess;
}
inline cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  if (device.skipped_wait == device.none || device.skipped_wait-- != 0) {
    static_cast<tetwarp::simt::Stream*>(stream)->enqueue([] {}, *event);
    device.run_eager();
  }
  return cudaSuccess;
}
/// Always one millisecond: the emulation has no clock.
inline cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t, cudaEvent_t) {
  *milliseconds = 1;
  return cudaSuccess;
}

/// As in CUDA, a copy from pageable memory reads it before the call returns, and a copy to pageable
/// memory is complete when the call returns.
inline cudaError_t cudaMemcpyAsync(
    void* to, const void* from, std::size_t size, cudaMemcpyKind kind, cudaStream_t stream) {
  using tetwarp::simt::ApiCall;
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  auto* const own = static_cast<tetwarp::simt::Stream*>(stream);
  const bool to_host = kind == cudaMemcpyDeviceToHost, from_host = kind == cudaMemcpyHostToDevice;
  if (device.is_on_device(to, size) == to_host || device.is_on_device(from, size) == from_host) {
    return cudaErrorInvalidValue;
  }
  device.note(to_host     ? ApiCall::copy_to_host
              : from_host ? ApiCall::copy_to_device
                          : ApiCall::copy_within);
  if (from_host && !device.is_pinned(from, size)) {
    const auto* const bytes = static_cast<const std::byte*>(from);
    own->enqueue([to, staged = std::vector<std::byte>(bytes, bytes + size)] {
      std::memcpy(to, staged.data(), staged.size());
    });
    device.run_eager();
    return cudaSuccess;
  }
  own->enqueue([=] { std::memcpy(to, from, size); });
  if (to_host && !device.is_pinned(to, size)) {
    device.note(ApiCall::wait);
    own->run_until(own->queued);
  }
  device.run_eager();
  return cudaSuccess;
}
inline cudaError_t cudaMemsetAsync(void* data, int value, std::size_t size, cudaStream_t stream) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  if (!device.is_on_device(data, size)) return cudaErrorInvalidValue;
  device.note(tetwarp::simt::ApiCall::fill);
  static_cast<tetwarp::simt::Stream*>(stream)->enqueue([=] { std::memset(data, value, size); });
  device.run_eager();
  return cudaSuccess;
}
// NOLINTEND(readability-identifier-naming)

#include "kernels/emu/graph.hpp"  // IWYU pragma: export: uses the names above
