/// @file runtime.hpp
/// A CUDA device on the CPU, to test what drives it: memory, streams, events and copies.
///
/// Work on a stream runs as late as CUDA allows: when somebody waits for it. What reads a result
/// without waiting, or overwrites what a copy still needs, gets wrong results in tests. Copies must
/// go the way they say, and every call of interest is written down. Any number of threads may call.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "kernels/emu/simt.hpp"

namespace tetwarp::simt {

/// Work in its order; `done` of `queued` items have run.
struct Stream {
  std::deque<std::function<void()>> work;
  std::uint64_t queued = 0;
  std::uint64_t done = 0;

  void enqueue(std::function<void()> item) {
    work.push_back(std::move(item));
    ++queued;
  }
  void run_until(std::uint64_t item) {
    while (done < item) {
      const std::function<void()> next = std::move(work.front());
      work.pop_front();
      ++done;
      next();
    }
  }
};

/// A place in a stream.
struct Event {
  Stream* stream = nullptr;
  std::uint64_t item = 0;
};

/// What the host asked for, in order.
enum class Call : char {
  launch = 'L',
  allocate = 'A',
  release = 'F',
  wait = 'W',            ///< for a stream or an event
  copy_to_device = 'U',  ///< from the host
  copy_to_host = 'D',
  copy_within = 'C',
  fill = 'Z'
};

/// The one device.
class Device {
 public:
  std::recursive_mutex lock;

  static Device& only() {
    static Device device;
    return device;
  }

  /// The calls since the last time it was asked, one letter each.
  std::string take_calls() {
    const std::lock_guard guard(lock);
    return std::exchange(calls_, {});
  }
  void note(Call call) { calls_ += static_cast<char>(call); }

  void* allocate(std::size_t size, bool is_pinned) {
    auto memory = std::make_unique<std::byte[]>(std::max<std::size_t>(size, 1));
    std::memset(memory.get(), 0xcd, size);
    std::byte* const data = memory.get();
    memory_[data] = {std::move(memory), size, is_pinned};
    return data;
  }
  /// @returns whether there was such memory
  bool release(const void* data) {
    run_all();
    return memory_.erase(static_cast<const std::byte*>(data)) == 1;
  }
  bool is_on_device(const void* data, std::size_t size) const {
    return is_within(data, size, false);
  }
  bool is_pinned(const void* data, std::size_t size) const { return is_within(data, size, true); }

  Stream* make_stream() { return streams_.emplace_back(std::make_unique<Stream>()).get(); }
  void end_stream(Stream* stream) {
    stream->run_until(stream->queued);
    std::erase_if(streams_, [&](const auto& one) { return one.get() == stream; });
  }
  void run_all() {
    for (const auto& stream : streams_) stream->run_until(stream->queued);
  }

 private:
  struct Memory {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size;
    bool is_pinned;
  };

  bool is_within(const void* data, std::size_t size, bool is_pinned) const {
    const auto* const begin = static_cast<const std::byte*>(data);
    auto after = memory_.upper_bound(begin);
    if (after == memory_.begin()) return false;
    const auto& [start, memory] = *--after;
    return memory.is_pinned == is_pinned && begin + size <= start + memory.size;
  }

  std::map<const std::byte*, Memory> memory_;
  std::vector<std::unique_ptr<Stream>> streams_;
  std::string calls_;
};

/// Runs a kernel on a stream; without one at once.
template <class Kernel, class... Args>
void launch_on(cudaStream_t stream,
               Kernel kernel,
               dim3 grid,
               dim3 block,
               std::size_t shared_bytes,
               const Args&... args) {
  if (stream == nullptr) return launch(kernel, grid, block, shared_bytes, args...);
  const std::lock_guard guard(Device::only().lock);
  Device::only().note(Call::launch);
  static_cast<Stream*>(stream)->enqueue(
      [=] { launch(kernel, grid, block, shared_bytes, args...); });
}

}  // namespace tetwarp::simt

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names
using cudaEvent_t = tetwarp::simt::Event*;
enum cudaError_t { cudaSuccess, cudaErrorInvalidValue };
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost, cudaMemcpyDeviceToDevice };
constexpr unsigned cudaStreamNonBlocking = 1, cudaEventDisableTiming = 2;

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
  device.note(tetwarp::simt::Call::allocate);
  *data = static_cast<T*>(device.allocate(size, false));
  return cudaSuccess;
}
template <class T>
cudaError_t cudaMallocHost(T** data, std::size_t size) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  device.note(tetwarp::simt::Call::allocate);
  *data = static_cast<T*>(device.allocate(size, true));
  return cudaSuccess;
}
inline cudaError_t cudaFree(void* data) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  if (data == nullptr) return cudaSuccess;
  device.note(tetwarp::simt::Call::release);
  return device.release(data) ? cudaSuccess : cudaErrorInvalidValue;
}
inline cudaError_t cudaFreeHost(void* data) {
  return cudaFree(data);
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
  device.note(tetwarp::simt::Call::wait);
  auto* const own = static_cast<tetwarp::simt::Stream*>(stream);
  own->run_until(own->queued);
  return cudaSuccess;
}

inline cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) {
  *event = new tetwarp::simt::Event;
  return cudaSuccess;
}
inline cudaError_t cudaEventCreate(cudaEvent_t* event) {
  return cudaEventCreateWithFlags(event, 0);
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
  device.note(tetwarp::simt::Call::wait);
  event->stream->run_until(event->item);
  return cudaSuccess;
}
inline cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event) {
  const std::lock_guard guard(tetwarp::simt::Device::only().lock);
  const tetwarp::simt::Event then = *event;
  static_cast<tetwarp::simt::Stream*>(stream)->enqueue(
      [then] { then.stream->run_until(then.item); });
  return cudaSuccess;
}
/// A millisecond each: the emulation has no clock.
inline cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t, cudaEvent_t) {
  *milliseconds = 1;
  return cudaSuccess;
}

/// Copies from pageable memory are staged at once, those to it wait, as CUDA's do.
inline cudaError_t cudaMemcpyAsync(
    void* to, const void* from, std::size_t size, cudaMemcpyKind kind, cudaStream_t stream) {
  using tetwarp::simt::Call;
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  auto* const own = static_cast<tetwarp::simt::Stream*>(stream);
  const bool to_host = kind == cudaMemcpyDeviceToHost, from_host = kind == cudaMemcpyHostToDevice;
  if (device.is_on_device(to, size) == to_host || device.is_on_device(from, size) == from_host) {
    return cudaErrorInvalidValue;
  }
  device.note(to_host ? Call::copy_to_host : from_host ? Call::copy_to_device : Call::copy_within);
  if (from_host && !device.is_pinned(from, size)) {
    const auto* const bytes = static_cast<const std::byte*>(from);
    own->enqueue([to, staged = std::vector<std::byte>(bytes, bytes + size)] {
      std::memcpy(to, staged.data(), staged.size());
    });
    return cudaSuccess;
  }
  own->enqueue([=] { std::memcpy(to, from, size); });
  if (to_host && !device.is_pinned(to, size)) {
    device.note(Call::wait);
    own->run_until(own->queued);
  }
  return cudaSuccess;
}
inline cudaError_t cudaMemsetAsync(void* data, int value, std::size_t size, cudaStream_t stream) {
  auto& device = tetwarp::simt::Device::only();
  const std::lock_guard guard(device.lock);
  if (!device.is_on_device(data, size)) return cudaErrorInvalidValue;
  device.note(tetwarp::simt::Call::fill);
  static_cast<tetwarp::simt::Stream*>(stream)->enqueue([=] { std::memset(data, value, size); });
  return cudaSuccess;
}
// NOLINTEND(readability-identifier-naming)
