/// @file exec_cuda.cuh
/// CudaExec: the operations a pipeline is made of, on one device: kernels on one stream, copies to
/// it and back on two others, so that those of one step run beside the kernels of another.
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "kernels/base/cell_pair.hpp"
#include "kernels/base/view.hpp"
#include "kernels/exec/exec_buffer.cuh"
#include "kernels/exec/exec_stream.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

// primitives_cuda.cu: CUB behind plain functions; `scratch` grows on first use.
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

constexpr int each_threads = 256;  ///< of the kernels below: one index per thread

/// Blocks per multiprocessor to share registers among, where ptxas would spill; 0: its own choice.
template <class Body>
constexpr int resident_blocks = [] {
  if constexpr (requires { Body::resident_blocks; }) return Body::resident_blocks;
  return 0;
}();

template <class Body>
__global__ void __launch_bounds__(each_threads, resident_blocks<Body>)
    each_kernel(std::int64_t count, Body body) {
  const std::int64_t i = std::int64_t{blockIdx.x} * each_threads + threadIdx.x;
  if (i < count) body(i);
}

/// The segment of an item by bisection of the offsets.
template <class Body>
__global__ void __launch_bounds__(each_threads)
    each_item_kernel(View<const std::int64_t> offsets, std::int64_t capacity, Body body) {
  const std::int64_t item = std::int64_t{blockIdx.x} * each_threads + threadIdx.x;
  std::int64_t low = 0, high = offsets.size - 1;
  if (item >= min_of(offsets[high], capacity)) return;
  while (low + 1 < high) {
    const std::int64_t middle = (low + high) / 2;
    if (offsets[middle] <= item) {
      low = middle;
    } else {
      high = middle;
    }
  }
  body(low, item - offsets[low], item);
}

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

  /// Reading a size waits for the device: pipelines do it once, then trust their buffers.
  static constexpr bool reads_are_free = false;

  explicit CudaExec(int device) : state_(std::make_unique<State>(device)) {}

  cudaStream_t stream() const { return state_->stream; }
  std::string device() const {
    cudaDeviceProp properties;
    check_cuda(cudaGetDeviceProperties(&properties, state_->device), "cudaGetDeviceProperties");
    return properties.name;
  }
  int threads() const { return 1; }

  /// What follows belongs to one of two steps in flight, 0 or 1; at first to 0.
  void select(int flight) {
    check_cuda(cudaSetDevice(state_->device), "cudaSetDevice");
    state_->flight = &state_->flights[flight];
  }

  /// Runs what follows on the caller's stream; null: on this executor's own.
  void use_stream(void* stream) {
    check_cuda(cudaSetDevice(state_->device), "cudaSetDevice");
    const cudaStream_t wanted =
        stream != nullptr ? static_cast<cudaStream_t>(stream) : cudaStream_t{state_->own_stream};
    if (wanted == state_->stream) return;
    check_cuda(cudaStreamSynchronize(state_->stream), "cudaStreamSynchronize");
    state_->stream = wanted;
  }

  /// The kernels of the selected step come now; they wait for its upload().
  void begin_compute(void* stream) {
    use_stream(stream);
    flight().uploaded.make_wait(this->stream());
  }
  /// There are no more of them: what download() brings home is there when they have run.
  void end_compute() { flight().computed.record(stream()); }
  /// From then on the caller may end his stream.
  void wait_computed() {
    flight().computed.wait();
    state_->stream = state_->own_stream;
  }

  /// Waits for all that was asked for, whatever became of it.
  void drain() noexcept {
    for (cudaStream_t stream :
         {cudaStream_t{state_->upload}, state_->stream, cudaStream_t{state_->download}}) {
      cudaStreamSynchronize(stream);
    }
    state_->stream = state_->own_stream;
  }

  /// Seconds per label of the selected step since the last clear(); waits for all it was charged.
  StageTimes& times() { return flight().times(); }

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
  /// Numbers for the selected step, taken as they are now, that travel beside earlier kernels.
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
  template <class T>
  T* writable(T*, std::int64_t size, Buffer<T>& buffer) {
    buffer.reserve(size);
    return buffer.view(size).data;
  }
  /// Brings home what the selected step has computed, beside the kernels of the next. Returns
  /// before it is there if downloads_async().
  template <class T>
  void download(const char* label, View<const T> from, T* to) {
    flight().computed.make_wait(state_->download);
    flight().timed(label, state_->download, [&] {
      check_cuda(cudaMemcpyAsync(to, from.data, bytes_of<T>(from.size), cudaMemcpyDeviceToHost,
                                 state_->download),
                 "cudaMemcpyAsync to host");
    });
  }
  /// True for page-locked memory. Copies to other memory wait on the host.
  bool downloads_async(const void* to) const {
    cudaPointerAttributes attributes;
    check_cuda(cudaPointerGetAttributes(&attributes, to), "cudaPointerGetAttributes");
    return attributes.type == cudaMemoryTypeHost;
  }
  /// As read(), but they are there after wait_computed().
  template <class T>
  void fetch(View<const T> from, PinnedBuffer<T>& to) {
    check_cuda(cudaMemcpyAsync(to.view(from.size).data, from.data, bytes_of<T>(from.size),
                               cudaMemcpyDeviceToHost, stream()),
               "cudaMemcpyAsync to host");
  }
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

  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    if (count == 0) return;
    timed(label, [&] {
      launch(stream(), each_kernel<Body>, blocks_for(count), each_threads, 0, count, body);
    });
  }
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

  /// Makes room for scans of so many values, so that a later one does not allocate.
  void reserve_scan(std::int64_t count) { cuda_reserve_scan(state_->scratch, count); }

  /// All pairs become rejected ones: later stages run over the capacity, not the count.
  void reject_all(const char* label, View<CellPair> pairs) {
    timed(label, [&] {
      check_cuda(cudaMemsetAsync(pairs.data, 0xff, bytes_of<CellPair>(pairs.size), stream()),
                 "cudaMemsetAsync");
    });
  }
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

  /// Runs work between two events that are charged to a label.
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

    explicit State(int number) : device(made_current(number)) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    static int made_current(int number) {
      check_cuda(cudaSetDevice(number), "cudaSetDevice");
      return number;
    }
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
