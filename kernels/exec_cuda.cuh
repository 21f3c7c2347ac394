/// @file exec_cuda.cuh
/// CudaExec: the operations a pipeline is made of, on one stream of one device. The only file with
/// allocation, copies, streams and events.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <tetwarp/error.hpp>
#include <utility>
#include <vector>

#include "host/stage_times.hpp"
#include "kernels/cell_cull.hpp"
#include "kernels/launch.hpp"
#include "kernels/view.hpp"

namespace tetwarp {

/// Throws CudaError naming the call when it failed.
inline void check_cuda(cudaError_t error, const char* call) {
  if (error != cudaSuccess) {
    throw CudaError(std::string(call) + ": " + cudaGetErrorString(error));
  }
}

/// Owns device memory that only grows; contents are undefined after growth.
template <class T>
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  DeviceBuffer(DeviceBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), capacity_(std::exchange(other.capacity_, 0)) {}
  DeviceBuffer& operator=(DeviceBuffer&&) = delete;
  ~DeviceBuffer() { cudaFree(data_); }

  void reserve(std::int64_t size) {
    if (size <= capacity_) return;
    check_cuda(cudaFree(data_), "cudaFree");
    data_ = nullptr;
    capacity_ = 0;
    check_cuda(cudaMalloc(&data_, static_cast<std::size_t>(size) * sizeof(T)), "cudaMalloc");
    capacity_ = size;
  }
  View<T> view(std::int64_t size) const { return {data_, size}; }
  View<const T> const_view(std::int64_t size) const { return {data_, size}; }

 private:
  T* data_ = nullptr;
  std::int64_t capacity_ = 0;
};

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

  /// Runs what follows on the caller's stream; null: on this executor's own.
  void use_stream(void* stream) {
    check_cuda(cudaSetDevice(state_->device), "cudaSetDevice");
    const cudaStream_t wanted =
        stream != nullptr ? static_cast<cudaStream_t>(stream) : state_->own_stream;
    if (wanted == state_->stream) return;
    check_cuda(cudaStreamSynchronize(state_->stream), "cudaStreamSynchronize");
    state_->stream = wanted;
  }

  /// Seconds per label since the last clear(); waits for the stream.
  StageTimes& times() {
    check_cuda(cudaStreamSynchronize(stream()), "cudaStreamSynchronize");
    for (std::size_t i = 0; i < state_->used; ++i) {
      float milliseconds = 0;
      const Span& span = state_->spans[i];
      check_cuda(cudaEventElapsedTime(&milliseconds, span.begin, span.end), "cudaEventElapsedTime");
      state_->times.add(span.label, milliseconds * 1e-3);
    }
    state_->used = 0;
    return state_->times;
  }

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
  template <class T>
  T* writable(T*, std::int64_t size, Buffer<T>& buffer) {
    buffer.reserve(size);
    return buffer.view(size).data;
  }
  template <class T>
  void deliver(const char* label, View<const T> from, T* to) {
    timed(label, [&] {
      check_cuda(
          cudaMemcpyAsync(to, from.data, bytes_of<T>(from.size), cudaMemcpyDeviceToHost, stream()),
          "cudaMemcpyAsync to host");
    });
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
    const Span& span = state_->next_span(label);
    check_cuda(cudaEventRecord(span.begin, stream()), "cudaEventRecord");
    work();
    check_cuda(cudaEventRecord(span.end, stream()), "cudaEventRecord");
  }

 private:
  struct Span {
    const char* label;
    cudaEvent_t begin;
    cudaEvent_t end;
  };

  struct State {
    int device;
    cudaStream_t own_stream = nullptr;
    cudaStream_t stream = nullptr;
    std::vector<Span> spans;
    std::size_t used = 0;
    StageTimes times;
    DeviceBuffer<std::byte> scratch;
    DeviceBuffer<CellPair> other_pairs;

    explicit State(int number) : device(number) {
      check_cuda(cudaSetDevice(device), "cudaSetDevice");
      check_cuda(cudaStreamCreateWithFlags(&own_stream, cudaStreamNonBlocking),
                 "cudaStreamCreateWithFlags");
      stream = own_stream;
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
      for (const Span& span : spans) {
        cudaEventDestroy(span.begin);
        cudaEventDestroy(span.end);
      }
      cudaStreamDestroy(own_stream);
    }
    const Span& next_span(const char* label) {
      if (used == spans.size()) {
        Span span{label, nullptr, nullptr};
        check_cuda(cudaEventCreate(&span.begin), "cudaEventCreate");
        check_cuda(cudaEventCreate(&span.end), "cudaEventCreate");
        spans.push_back(span);
      }
      spans[used].label = label;
      return spans[used++];
    }
  };

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
