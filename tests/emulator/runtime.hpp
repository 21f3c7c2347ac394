/// @file runtime.hpp
/// CUDA's runtime functions on the emulated device, to test host code that calls them.
///
/// Work on a stream runs as late as CUDA permits: when the host waits for it. A test can choose one
/// stream whose work runs as early as events permit. Code that reads a result without waiting for
/// it, or overwrites memory that a pending copy still reads, therefore computes wrong results.
/// Copies whose direction contradicts their addresses fail. Device::take_calls() returns the
/// recorded calls. There are two devices, of which only the first has memory. All functions may be
/// called from any thread.
#pragma once
#include <cstddef>
#include <cstring>
#include <mutex>
#include <vector>

#include "tests/emulator/device.hpp"
#include "tests/emulator/error.hpp"

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names
using cudaEvent_t = tetwarp::simt::Event*;
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost, cudaMemcpyDeviceToDevice };
constexpr unsigned cudaStreamNonBlocking = 1, cudaEventDisableTiming = 2;

enum cudaMemoryType {
  cudaMemoryTypeUnregistered,
  cudaMemoryTypeHost,
  cudaMemoryTypeDevice,
  cudaMemoryTypeManaged
};
constexpr unsigned cudaHostRegisterPortable = 1;

struct cudaPointerAttributes {
  cudaMemoryType type;
  int device = 0;
};
struct cudaDeviceProp {
  char name[32];
};

namespace tetwarp::simt {

/// Runs a call of the runtime that fails when the device has failed, or when the calling thread
/// records a stream and the call must not be made meanwhile.
template <class Work>
cudaError_t call(bool may_record, Work&& work) {
  Device& device = Device::only();
  const std::lock_guard guard(device.lock);
  cudaError_t error = device.failure;
  if (error == cudaSuccess && !may_record && device.is_recorded_by_this_thread()) {
    error = cudaErrorStreamCaptureUnsupported;
  }
  if (error == cudaSuccess) error = work(device);
  if (error != cudaSuccess) last_error = error;
  return error;
}

template <class T>
cudaError_t allocate(T** data, std::size_t size, bool is_pinned) {
  return call(false, [&](Device& device) {
    device.note(ApiCall::allocate);
    if (device.allocation_fails()) return cudaErrorMemoryAllocation;
    *data = static_cast<T*>(device.allocate(size, is_pinned));
    return cudaSuccess;
  });
}

}  // namespace tetwarp::simt

inline cudaError_t cudaSetDevice(int device) {
  return tetwarp::simt::call(true, [&](const auto&) {
    if (device < 0 || device > 1) return cudaErrorInvalidDevice;
    tetwarp::simt::current_device = device;
    return cudaSuccess;
  });
}
inline cudaError_t cudaGetDevice(int* device) {
  *device = tetwarp::simt::current_device;
  return cudaSuccess;
}
inline cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int) {
  *properties = {"emulation"};
  return cudaSuccess;
}

template <class T>
cudaError_t cudaMalloc(T** data, std::size_t size) {
  return tetwarp::simt::allocate(data, size, false);
}
template <class T>
cudaError_t cudaMallocHost(T** data, std::size_t size) {
  return tetwarp::simt::allocate(data, size, true);
}
/// Frees the memory of a failed device, too, so that tests leave nothing behind.
inline cudaError_t cudaFree(void* data) {
  if (data == nullptr) return cudaSuccess;
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  if (device.is_recorded_by_this_thread()) return cudaErrorStreamCaptureUnsupported;
  device.note(tetwarp::simt::ApiCall::release);
  if (!device.release(data)) return cudaErrorInvalidValue;
  return device.failure;
}
inline cudaError_t cudaFreeHost(void* data) {
  return cudaFree(data);
}
inline cudaError_t cudaHostRegister(void* data, std::size_t size, unsigned) {
  return tetwarp::simt::call(false, [&](auto& device) {
    if (device.allocation_fails()) return cudaErrorMemoryAllocation;
    device.pin(data, size);
    return cudaSuccess;
  });
}
inline cudaError_t cudaHostUnregister(void* data) {
  return cudaFree(data);
}
inline cudaError_t cudaPointerGetAttributes(cudaPointerAttributes* attributes, const void* data) {
  return tetwarp::simt::call(true, [&](const auto& device) {
    attributes->type = device.is_pinned(data, 1)      ? cudaMemoryTypeHost
                       : device.is_on_device(data, 1) ? cudaMemoryTypeDevice
                                                      : cudaMemoryTypeUnregistered;
    return cudaSuccess;
  });
}

enum cudaDeviceAttr {
  cudaDevAttrMaxSharedMemoryPerBlockOptin,
  cudaDevAttrMultiProcessorCount,
  cudaDevAttrCooperativeLaunch
};
enum cudaFuncAttribute { cudaFuncAttributeMaxDynamicSharedMemorySize };

inline cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int) {
  return tetwarp::simt::call(true, [&](const auto& device) {
    *value = attribute == cudaDevAttrMaxSharedMemoryPerBlockOptin ? device.most_shared_bytes
             : attribute == cudaDevAttrMultiProcessorCount        ? device.multiprocessors
                                                                  : device.is_cooperative;
    return cudaSuccess;
  });
}
template <class Kernel>
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessor(int* blocks, Kernel, int, std::size_t) {
  *blocks = 2;
  return cudaSuccess;
}
inline cudaError_t cudaFuncSetAttribute(const void* kernel, cudaFuncAttribute, int bytes) {
  return tetwarp::simt::call(true, [&](const auto& device) {
    if (bytes > device.most_shared_bytes) return cudaErrorInvalidValue;
    auto& limit = tetwarp::simt::shared_limits()[kernel];
    limit = std::max(limit, static_cast<std::size_t>(bytes));
    return cudaSuccess;
  });
}

inline cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned) {
  return tetwarp::simt::call(false, [&](auto& device) {
    *stream = device.make_stream();
    return cudaSuccess;
  });
}
/// As cudaFree().
inline cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  if (stream != nullptr) device.end_stream(static_cast<tetwarp::simt::Stream*>(stream));
  return device.failure;
}
inline cudaError_t cudaStreamQuery(cudaStream_t stream) {
  return tetwarp::simt::call(true, [&](auto& device) {
    return device.stream(stream).work.empty() ? cudaSuccess : cudaErrorNotReady;
  });
}
inline cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  return tetwarp::simt::call(false, [&](auto& device) {
    device.note(tetwarp::simt::ApiCall::wait);
    tetwarp::simt::Stream& own = device.stream(stream);
    own.run_until(own.queued);
    device.run_eager();
    return cudaSuccess;
  });
}

inline cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) {
  return tetwarp::simt::call(true, [&](const auto&) {
    *event = new tetwarp::simt::Event;
    return cudaSuccess;
  });
}
inline cudaError_t cudaEventDestroy(cudaEvent_t event) {
  delete event;
  return cudaSuccess;
}
inline cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  return tetwarp::simt::call(true, [&](auto& device) {
    tetwarp::simt::Stream& own = device.stream(stream);
    if (own.device != tetwarp::simt::current_device) return cudaErrorInvalidResourceHandle;
    *event = {&own, own.queued};
    device.note(tetwarp::simt::ApiCall::record);
    return cudaSuccess;
  });
}
inline cudaError_t cudaEventSynchronize(cudaEvent_t event) {
  return tetwarp::simt::call(false, [&](auto& device) {
    device.note(tetwarp::simt::ApiCall::wait);
    event->pass();
    device.run_eager();
    return cudaSuccess;
  });
}
/// The device goes on while the host asks: what is not done at one call is at the next.
inline cudaError_t cudaEventQuery(cudaEvent_t event) {
  return tetwarp::simt::call(false, [&](auto& device) {
    if (event->is_passed()) return cudaSuccess;
    event->pass();
    device.run_eager();
    return cudaErrorNotReady;
  });
}
inline cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned) {
  return tetwarp::simt::call(true, [&](auto& device) {
    if (device.skipped_wait == device.none || device.skipped_wait-- != 0) {
      device.stream(stream).enqueue([] {}, *event);
      device.run_eager();
    }
    return cudaSuccess;
  });
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
  const bool to_host = kind == cudaMemcpyDeviceToHost, from_host = kind == cudaMemcpyHostToDevice;
  return tetwarp::simt::call(true, [&](auto& device) {
    tetwarp::simt::Stream& own = device.stream(stream);
    if (device.is_on_device(to, size) == to_host || device.is_on_device(from, size) == from_host) {
      return cudaErrorInvalidValue;
    }
    device.note_copy(to_host     ? ApiCall::copy_to_host
                     : from_host ? ApiCall::copy_to_device
                                 : ApiCall::copy_within,
                     size);
    if (from_host && !device.is_pinned(from, size)) {
      const auto* const bytes = static_cast<const std::byte*>(from);
      own.enqueue([to, staged = std::vector<std::byte>(bytes, bytes + size)] {
        std::memcpy(to, staged.data(), staged.size());
      });
      device.run_eager();
      return cudaSuccess;
    }
    own.enqueue([=] { std::memcpy(to, from, size); });
    if (to_host && !device.is_pinned(to, size)) {
      device.note(ApiCall::wait);
      own.run_until(own.queued);
    }
    device.run_eager();
    return cudaSuccess;
  });
}
inline cudaError_t cudaMemsetAsync(void* data, int value, std::size_t size, cudaStream_t stream) {
  return tetwarp::simt::call(true, [&](auto& device) {
    if (!device.is_on_device(data, size)) return cudaErrorInvalidValue;
    device.note(tetwarp::simt::ApiCall::fill);
    device.stream(stream).enqueue([=] { std::memset(data, value, size); });
    device.run_eager();
    return cudaSuccess;
  });
}
// NOLINTEND(readability-identifier-naming)

#include "tests/emulator/copy_3d.hpp"  // IWYU pragma: export: uses the names above
#include "tests/emulator/graph.hpp"    // IWYU pragma: export: uses the names above
