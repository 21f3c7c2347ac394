/// @file exec_cuda.cuh
/// CudaExec: the executor of stages and pipelines on one device. Kernels run on one stream, uploads
/// and downloads on two others, so that copies of one step overlap with kernels of another.
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "kernels/base/cell_pair.hpp"
#include "kernels/base/view.hpp"
#include "kernels/exec/each_kernel.cuh"
#include "kernels/exec/exec_buffer.cuh"
#include "kernels/exec/exec_stream.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

// Defined in primitives_cuda.cu by CUB; `scratch` grows as needed.
void cuda_reserve_scan(DeviceBuffer<std::byte>& scratch, std::int64_t count);
void cuda_exclusive_scan(cudaStream_t stream,
                         DeviceBuffer<std::byte>& scratch,
                         View<std::int64_t> values);
void cuda_select_valid(cudaStream_t stream,
                       DeviceBuffer<std::byte>& scratch,
                       View<const CellPair> candidates,
                       View<CellPair> pairs,
                       std::int64_t* pair_count);
void cuda_sort_pairs(cudaStream_t stream,
                     DeviceBuffer<std::byte>& scratch,
                     View<CellPair> pairs,
                     View<CellPair> other,
                     int cell_bits);

/// Runs stages on one device. All work is enqueued and returns before it has run, unless stated.
/// Two steps may be in flight: each has its own events and times; select() chooses the current one.
class CudaExec {
 public:
  template <class T>
  using Buffer = DeviceBuffer<T>;
  template <class T>
  using PinnedBuffer = tetwarp::PinnedBuffer<T>;
  template <class T>
  struct Staged {
    PinnedBuffer<T> host;
    Buffer<T> device;
  };

  /// Whether the host can read executor memory without waiting. On a device it cannot: pipelines
  /// read sizes once, then launch over the capacities of their buffers.
  static constexpr bool reads_are_free = false;

  /// @pre the device is current
  explicit CudaExec(int device) : state_(std::make_unique<State>(device)) {}

  int number() const { return state_->device; }

  cudaStream_t stream() const { return state_->stream; }
  std::string device() const {
    cudaDeviceProp properties;
    check_cuda(cudaGetDeviceProperties(&properties, state_->device), "cudaGetDeviceProperties");
    return properties.name;
  }
  int threads() const { return 1; }

  /// Makes `flight`, 0 or 1, the current step: all calls after it belong to that step. Initially 0.
  /// @returns  an object during whose life the device is the current one of this thread
  DeviceScope enter(int flight) {
    state_->flight = &state_->flights[flight];
    return DeviceScope(state_->device);
  }

  /// Later kernels run on the caller's stream; null: on this executor's own. Waits for the kernels
  /// of the previous stream if it changes.
  void use_stream(void* stream) {
    const cudaStream_t next =
        stream != nullptr ? static_cast<cudaStream_t>(stream) : cudaStream_t{state_->own_stream};
    if (next == state_->stream) return;
    check_cuda(cudaStreamSynchronize(state_->stream), "cudaStreamSynchronize");
    state_->stream = next;
  }

  /// To be called before the first kernel of the current step: its kernels wait for its upload().
  /// @param has_device_memory  whether the step uses device memory of the caller: without a stream
  ///                           of the caller its kernels wait for the default stream
  void begin_compute(void* stream, bool has_device_memory) {
    use_stream(stream);
    flight().uploaded.make_wait(this->stream());
    if (stream != nullptr || !has_device_memory) return;
    flight().given.record(cudaStreamLegacy);
    flight().given.make_wait(this->stream());
  }
  /// To be called after the last kernel of the current step: records the event that download() and
  /// wait_computed() wait for.
  void end_compute() { flight().computed.record(stream()); }
  /// Waits for the kernels of the current step. Afterwards the caller may destroy its stream.
  void wait_computed() {
    flight().computed.wait();
    state_->stream = state_->own_stream;
  }

  /// Waits for all enqueued work and ignores its errors.
  void drain() noexcept {
    for (cudaStream_t stream :
         {cudaStream_t{state_->upload}, state_->stream, cudaStream_t{state_->download}}) {
      cudaStreamSynchronize(stream);
    }
    state_->stream = state_->own_stream;
  }

  /// Seconds per label of the current step since the last clear() of the result; waits for its
  /// work.
  StageTimes& times() { return flight().times(); }

  /// Copies a host array to the device, into `buffer`, on the stream of kernels.
  /// @param size  number of elements, here and below
  template <class T>
  View<const T> resident(const char* label, const T* host, std::int64_t size, Buffer<T>& buffer) {
    buffer.reserve(size);
    timed(label, [&] {
      check_cuda(cudaMemcpyAsync(buffer.view(size).data, host, bytes_of<T>(size),
                                 cudaMemcpyHostToDevice, stream()),
                 "cudaMemcpyAsync to device");
    });
    return buffer.const_view(size);
  }
  /// Copies `host` to pinned memory before it returns, and from there to the device on the upload
  /// stream, concurrently with kernels of earlier steps.
  template <class T>
  View<const T> upload(const char* label, const T* host, std::int64_t size, Staged<T>& staged) {
    staged.host.reserve(size);
    staged.device.reserve(size);
    std::copy_n(host, size, staged.host.view(size).data);
    flight().timed(label, state_->upload, [&] {
      check_cuda(cudaMemcpyAsync(staged.device.view(size).data, staged.host.view(size).data,
                                 bytes_of<T>(size), cudaMemcpyHostToDevice, state_->upload),
                 "cudaMemcpyAsync to device");
    });
    flight().uploaded.record(state_->upload);
    return staged.device.const_view(size);
  }
  /// Memory of `size` elements that stages write to; the CPU's executor returns the first argument.
  template <class T>
  T* writable(T*, std::int64_t size, Buffer<T>& buffer) {
    buffer.reserve(size);
    return buffer.view(size).data;
  }
  /// Copies results of the current step to the host after end_compute(), concurrently with kernels
  /// of the next step. Returns before the copy is done if downloads_async(to).
  template <class T>
  void download(const char* label, View<const T> from, T* to) {
    flight().computed.make_wait(state_->download);
    flight().timed(label, state_->download, [&] {
      check_cuda(cudaMemcpyAsync(to, from.data, bytes_of<T>(from.size), cudaMemcpyDeviceToHost,
                                 state_->download),
                 "cudaMemcpyAsync to host");
    });
  }
  /// Whether download() to this address returns at once: true for page-locked memory.
  bool downloads_async(const void* to) const {
    cudaPointerAttributes attributes;
    check_cuda(cudaPointerGetAttributes(&attributes, to), "cudaPointerGetAttributes");
    return attributes.type == cudaMemoryTypeHost;
  }
  /// As read(), but without waiting: `to` is valid after wait_computed().
  template <class T>
  void fetch(View<const T> from, PinnedBuffer<T>& to) {
    check_cuda(cudaMemcpyAsync(to.view(from.size).data, from.data, bytes_of<T>(from.size),
                               cudaMemcpyDeviceToHost, stream()),
               "cudaMemcpyAsync to host");
  }
  /// Copies device memory to the host and waits for it.
  template <class T>
  void read(View<const T> from, T* to) {
    check_cuda(
        cudaMemcpyAsync(to, from.data, bytes_of<T>(from.size), cudaMemcpyDeviceToHost, stream()),
        "cudaMemcpyAsync to host");
    check_cuda(cudaStreamSynchronize(stream()), "cudaStreamSynchronize");
  }
  template <class T>
  void zero(const char* label, View<T> view) {
    timed(label, [&] {
      check_cuda(cudaMemsetAsync(view.data, 0, bytes_of<T>(view.size), stream()),
                 "cudaMemsetAsync");
    });
  }

  /// Calls body(i) for i in [0, count), in any order.
  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    if (count == 0) return;
    timed(label, [&] {
      launch(stream(), each_kernel<Body>, blocks_for(count), each_threads, 0, count, body);
    });
  }
  /// Calls body(s, item - offsets[s], item) for every item of segments s, which are the ranges
  /// [offsets[s], offsets[s + 1]), in any order. Items from `capacity` on are left out.
  template <class Body>
  void for_each_item(const char* label,
                     View<const std::int64_t> offsets,
                     std::int64_t capacity,
                     const Body& body) {
    if (capacity == 0) return;
    timed(label, [&] {
      launch(stream(), each_item_kernel<Body>, blocks_for(capacity), each_threads, 0, offsets,
             capacity, body);
    });
  }
  void exclusive_scan(const char* label, View<std::int64_t> values) {
    timed(label, [&] { cuda_exclusive_scan(stream(), state_->scratch, values); });
  }

  /// Allocates the scratch memory for scans of up to `count` values.
  void reserve_scan(std::int64_t count) { cuda_reserve_scan(state_->scratch, count); }

  /// Sets all pairs to rejected_pair, as later stages run over the capacity and not the count.
  void reject_all(const char* label, View<CellPair> pairs) {
    timed(label, [&] {
      check_cuda(cudaMemsetAsync(pairs.data, 0xff, bytes_of<CellPair>(pairs.size), stream()),
                 "cudaMemsetAsync");
    });
  }
  /// Copies the candidates that are not rejected_pair to the front of `pairs`, in order, and their
  /// number to pair_count[0]; the rest of `pairs` becomes rejected_pair.
  void select_valid(const char* label,
                    View<const CellPair> candidates,
                    View<const std::int64_t>,
                    View<CellPair> pairs,
                    View<std::int64_t> pair_count) {
    reject_all(label, pairs);
    if (candidates.size == 0) return;
    timed(label, [&] {
      cuda_select_valid(stream(), state_->scratch, candidates, pairs, pair_count.data);
    });
  }
  /// Sorts by cell, of which the lowest `cell_bits` bits count; stable.
  void sort_pairs(const char* label,
                  View<CellPair> pairs,
                  View<const std::int64_t>,
                  int cell_bits) {
    if (pairs.size == 0) return;
    state_->other_pairs.reserve(pairs.size);
    timed(label, [&] {
      cuda_sort_pairs(stream(), state_->scratch, pairs, state_->other_pairs.view(pairs.size),
                      cell_bits);
    });
  }

  /// Calls work(), which enqueues on stream(), and adds its time on the device to that of `label`.
  template <class Work>
  void timed(const char* label, Work&& work) {
    flight().timed(label, stream(), std::forward<Work>(work));
  }

 private:
  struct State {
    int device;
    DeviceStream own_stream, upload, download;
    DeviceFlight flights[2];
    cudaStream_t stream = own_stream;
    DeviceFlight* flight = flights;
    DeviceBuffer<std::byte> scratch;
    DeviceBuffer<CellPair> other_pairs;

    explicit State(int number) : device(number) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
  };

  DeviceFlight& flight() { return *state_->flight; }
  template <class T>
  static std::size_t bytes_of(std::int64_t size) {
    return static_cast<std::size_t>(size) * sizeof(T);
  }
  static dim3 blocks_for(std::int64_t count) {
    return dim3(static_cast<unsigned>((count + each_threads - 1) / each_threads));
  }

  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
