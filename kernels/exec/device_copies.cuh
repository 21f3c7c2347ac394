/// @file device_copies.cuh
/// DeviceCopies: memory of an executor on a device, and copies between it and the host.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <utility>
#include <vector>

#include "kernels/base/host_copy.hpp"
#include "kernels/base/view.hpp"
#include "kernels/exec/device_queue.cuh"
#include "kernels/exec/device_vector.cuh"
#include "kernels/exec/exec_buffer.cuh"
#include "kernels/exec/staging_ring.cuh"

namespace tetwarp {

/// The copies of CudaExec. All are enqueued and return before they have run, unless stated; memory
/// of the host that is not page-locked may change once they have returned, and large arrays in it
/// pass through the StagingRing.
class DeviceCopies : public DeviceQueue {
 public:
  template <class T>
  using Vector = DeviceVector<T>;
  template <class T>
  using LargeVector = DeviceVector<T>;
  /// An array that the host renews in every step, and what it sent last.
  template <class T>
  struct Input : DeviceVector<T> {
    std::vector<T> sent;
  };
  template <class T>
  using Buffer = DeviceBuffer<T>;
  template <class T>
  using PinnedBuffer = tetwarp::PinnedBuffer<T>;
  template <class T>
  struct Staged {
    PinnedBuffer<T> host;
    Buffer<T> device;
  };

  /// Arrays of a step that are read once from the host's memory instead of being copied first.
  static constexpr std::size_t most_bytes_in_place = std::size_t{1} << 16;

  using DeviceQueue::DeviceQueue;

  /// Copies a host array to the device, into `buffer`, on the stream of kernels.
  /// @param size  number of elements, here and below
  template <class T>
  View<const T> resident(const char* label, const T* host, std::int64_t size, Buffer<T>& buffer) {
    buffer.reserve(size);
    timed(label, [&] { send(host, buffer.view(size), stream()); });
    return buffer.const_view(size);
  }
  /// Copies `host` to pinned memory before it returns, and from there to the device on the upload
  /// stream, concurrently with kernels of earlier steps. Kernels read few bytes from pinned memory
  /// in place: that takes no longer than a copy.
  template <class T>
  View<const T> upload(const char* label, const T* host, std::int64_t size, Staged<T>& staged) {
    staged.host.reserve(size);
    std::copy_n(host, size, staged.host.view(size).data);
    flight().has_upload = bytes_of<T>(size) > most_bytes_in_place;
    if (!flight().has_upload) return staged.host.const_view(size);
    staged.device.reserve(size);
    DeviceQueue::timed(label, upload_stream(), [&] {
      send(staged.host.view(size).data, staged.device.view(size), upload_stream());
    });
    flight().uploaded.record(upload_stream());
    return staged.device.const_view(size);
  }
  /// Memory of `size` elements that stages write to; the CPU's executor returns the first argument.
  template <class T>
  T* writable(T*, std::int64_t size, Buffer<T>& buffer) {
    buffer.reserve(size);
    return buffer.view(size).data;
  }
  /// Copies results of the current step to the host after end_compute(true), concurrently with
  /// kernels of the next step: the same bytes of each of `slices` slices. Returns before the copy
  /// is done if downloads_async(to).
  /// @param from, to  first byte to copy
  void download(const char* label, const std::byte* from, std::byte* to, const SliceBytes& part) {
    if (!std::exchange(flight().is_awaited, true)) flight().computed.make_wait(download_stream());
    DeviceQueue::timed(label, download_stream(), [&] {
      if (is_staged(to, part.row * part.rows * part.slices)) {
        return StagingRing::of(number()).download(from, to, part, download_stream());
      }
      copy_slices(from, to, part, part.pitch, download_stream());
    });
  }
  /// Whether download() to this address returns at once: true for page-locked memory.
  bool downloads_async(const void* to) const { return type_of(to) == cudaMemoryTypeHost; }

  template <class T>
  View<T> view(Vector<T>& values) const {
    return values.view();
  }
  template <class T>
  View<const T> view(const Vector<T>& values) const {
    return values.view();
  }
  /// Sets the size; entries are undefined.
  template <class T>
  void resize(Vector<T>& values, std::int64_t size) const {
    values.resize(size);
  }
  /// Sets the size; all entries become zero.
  template <class T>
  void make_zeros(Vector<T>& values, std::int64_t size) const {
    values.resize(size);
    if (size == 0) return;
    check_cuda(cudaMemsetAsync(values.view().data, 0, bytes_of<T>(size), stream()),
               "cudaMemsetAsync");
  }
  /// Copies from the host.
  template <class T>
  void put(const T* host, std::int64_t size, Vector<T>& values) const {
    values.resize(size);
    if (size > 0) send(host, values.view(), stream());
  }
  template <class T>
  void put(const std::vector<T>& host, Vector<T>& values) const {
    put(host.data(), static_cast<std::int64_t>(host.size()), values);
  }
  /// As put(), of the part between the first and the last number that changed since the last call.
  template <class T>
  void renew(const T* host, std::int64_t size, Input<T>& values) const {
    if (static_cast<std::int64_t>(values.sent.size()) != size) {
      values.sent.assign(host, host + size);
      return put(host, size, static_cast<Vector<T>&>(values));
    }
    const auto differs = [&](std::int64_t i) {
      return std::memcmp(&host[i], &values.sent[static_cast<std::size_t>(i)], sizeof(T)) != 0;
    };
    std::int64_t begin = 0, end = size;
    while (begin < end && !differs(begin)) ++begin;
    while (begin < end && !differs(end - 1)) --end;
    if (begin == end) return;
    std::copy(host + begin, host + end, values.sent.begin() + begin);
    send(host + begin, View<T>{values.view().data + begin, end - begin}, stream());
  }
  /// Memory of the host for stages to read: copied to `own`.
  template <class T>
  View<const T> input(const T* host, std::int64_t size, Vector<T>& own) const {
    put(host, size, own);
    return std::as_const(own).view();
  }
  /// Values that stages read later: copied to `own`.
  template <class T>
  View<const T> keep(View<const T> values, Vector<T>& own) const {
    own.resize(values.size);
    copy("", values, own.view());
    return std::as_const(own).view();
  }
  template <class T>
  void copy(const char*, View<const T> from, View<T> to) const {
    if (from.size == 0) return;
    check_cuda(cudaMemcpyAsync(to.data, from.data, bytes_of<T>(from.size), cudaMemcpyDeviceToDevice,
                               stream()),
               "cudaMemcpyAsync on device");
  }

  /// Copies to the host and waits for it.
  template <class T>
  void get(View<const T> from, T* to) const {
    if (from.size == 0) return;
    receive(from, to);
    wait();
  }
  template <class T>
  void get(const Vector<T>& values, std::vector<T>& host) const {
    host.resize(static_cast<std::size_t>(values.view().size));
    get(values.view(), host.data());
  }
  /// Several arrays, with one wait for all.
  void get_all(std::initializer_list<HostCopy> copies) {
    std::int64_t size = 0;
    for (const HostCopy& copy : copies) size += copy.from.size;
    numbers_.reserve(size);
    double* next = numbers_.view(size).data;
    for (const HostCopy& copy : copies) {
      if (copy.from.size > 0) receive(copy.from, next);
      next += copy.from.size;
    }
    wait();
    next -= size;
    for (const HostCopy& copy : copies) {
      std::copy_n(next, copy.from.size, copy.to);
      next += copy.from.size;
    }
  }
  /// As get(), but without waiting: `to` is valid after wait_computed().
  template <class T>
  void fetch(View<const T> from, PinnedBuffer<T>& to) const {
    receive(from, to.view(from.size).data);
  }
  /// What stages wrote, copied to the host.
  template <class T>
  View<const T> on_host(View<const T> values, std::vector<T>& host) const {
    host.resize(static_cast<std::size_t>(values.size));
    get(values, host.data());
    return {host.data(), values.size};
  }
  /// Reads one value of device memory; synchronizes.
  template <class T>
  T load(const T* value) {
    loaded_.reserve(sizeof(T));
    T* const pinned = reinterpret_cast<T*>(loaded_.view(0).data);
    get(View<const T>{value, 1}, pinned);
    return *pinned;
  }
  template <class T>
  T load_without_sync(const T*, T otherwise) const {
    return otherwise;
  }
  /// Only every eighth step, because the device idles while the host reads.
  bool is_sync_point(std::int64_t step) const { return step % 8 == 0; }

  /// Default-constructs a State in memory of the device; replaces that of the previous call.
  template <class State>
  State* state() {
    static_assert(sizeof(State) <= state_bytes);
    state_.resize(state_bytes);
    State* const state = reinterpret_cast<State*>(state_.view().data);
    const State fresh{};
    send(&fresh, View<State>{state, 1}, stream());
    return state;
  }

 protected:
  template <class T>
  static std::size_t bytes_of(std::int64_t size) {
    return static_cast<std::size_t>(size) * sizeof(T);
  }

 private:
  static constexpr std::int64_t state_bytes = 1024;

  static cudaMemoryType type_of(const void* data) {
    cudaPointerAttributes attributes;
    check_cuda(cudaPointerGetAttributes(&attributes, data), "cudaPointerGetAttributes");
    return attributes.type;
  }
  /// Whether a copy from or to this memory of the host takes the StagingRing.
  static bool is_staged(const void* host, std::size_t size) {
    return size >= StagingRing::least_bytes && type_of(host) == cudaMemoryTypeUnregistered;
  }

  template <class T>
  void send(const T* host, View<T> to, cudaStream_t on) const {
    if (is_staged(host, bytes_of<T>(to.size))) {
      return StagingRing::of(number()).upload(reinterpret_cast<const std::byte*>(host),
                                              reinterpret_cast<std::byte*>(to.data),
                                              bytes_of<T>(to.size), on);
    }
    check_cuda(cudaMemcpyAsync(to.data, host, bytes_of<T>(to.size), cudaMemcpyHostToDevice, on),
               "cudaMemcpyAsync to device");
  }
  template <class T>
  void receive(View<const T> from, T* to) const {
    const SliceBytes whole{bytes_of<T>(from.size), 1, 1, 1};
    if (is_staged(to, whole.row)) {
      return StagingRing::of(number()).download(reinterpret_cast<const std::byte*>(from.data),
                                                reinterpret_cast<std::byte*>(to), whole, stream());
    }
    check_cuda(
        cudaMemcpyAsync(to, from.data, bytes_of<T>(from.size), cudaMemcpyDeviceToHost, stream()),
        "cudaMemcpyAsync to host");
  }

  DeviceVector<std::byte> state_;
  tetwarp::PinnedBuffer<std::byte> loaded_;
  tetwarp::PinnedBuffer<double> numbers_;  ///< of get_all()
};

}  // namespace tetwarp
