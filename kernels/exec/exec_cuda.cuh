/// @file exec_cuda.cuh
/// CudaExec: the executor of stages and pipelines on one device: its memory, copies and loops.
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "kernels/base/cell_pair.hpp"
#include "kernels/base/view.hpp"
#include "kernels/exec/device_queue.cuh"
#include "kernels/exec/each_kernel.cuh"
#include "kernels/exec/exec_buffer.cuh"
#include "kernels/exec/grouped_scan.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

// Defined in primitives_cuda.cu by CUB; `scratch` grows as needed.
void cuda_exclusive_scan(cudaStream_t stream,
                         DeviceBuffer<std::byte>& scratch,
                         View<std::int64_t> values);
void cuda_sort_pairs(cudaStream_t stream,
                     DeviceBuffer<std::byte>& scratch,
                     View<CellPair> pairs,
                     View<CellPair> other,
                     int cell_bits);

/// Runs stages on one device. All work is enqueued and returns before it has run, unless stated.
class CudaExec : public DeviceQueue {
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

  /// Arrays of a step that are read once from the host's memory instead of being copied first.
  static constexpr std::size_t most_bytes_in_place = std::size_t{1} << 16;

  /// @param clocks  off: times() are empty
  /// @pre the device is current
  explicit CudaExec(int device, StageClocks clocks = StageClocks::on)
      : DeviceQueue(device, clocks) {}

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
      check_cuda(cudaMemcpyAsync(staged.device.view(size).data, staged.host.view(size).data,
                                 bytes_of<T>(size), cudaMemcpyHostToDevice, upload_stream()),
                 "cudaMemcpyAsync to device");
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
    DeviceQueue::timed(label, download_stream(),
                       [&] { copy_slices(from, to, part, download_stream()); });
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
  /// Sets few bytes to zero, by a kernel, so that it may be part of a graph.
  template <class T>
  void zero(const char* label, View<T> view) {
    for_each(label, static_cast<std::int64_t>(bytes_of<T>(view.size)),
             ZeroBody{{reinterpret_cast<std::uint8_t*>(view.data),
                       static_cast<std::int64_t>(bytes_of<T>(view.size))}});
  }

  /// Calls body(i) for i in [0, count), in any order.
  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    if (count == 0) return;
    enqueue(label, each_kernel<Body>, blocks_for(count), each_threads, 0, count, body);
  }
  /// Calls body(s, item - offsets[s], item) for every item of segments s, which are the ranges
  /// [offsets[s], offsets[s + 1]), in any order. Items from `capacity` on are left out.
  /// @tparam Offsets  View<const std::int64_t> or GroupedSums
  template <class Offsets, class Body>
  void for_each_item(const char* label,
                     const Offsets& offsets,
                     std::int64_t capacity,
                     const Body& body) {
    if (capacity == 0) return;
    enqueue(label, each_item_kernel<Offsets, Body>, blocks_for(capacity), each_threads, 0, offsets,
            capacity, body);
  }
  /// Sums body(i) for i in [0, count), and calls body.finish(total, k) for k in [0, sum_group).
  /// A body with a constant `lanes` is called by so many lanes together.
  /// @pre sums has room for `count` counts, in groups of sum_group / lanes
  template <class Body>
  void grouped_scan(const char* label,
                    std::int64_t count,
                    const Body& body,
                    const GroupedSums& sums) {
    unsigned* const own_ticket = ticket();
    const dim3 blocks(static_cast<unsigned>(group_count(count, sums.shift)));
    enqueue(label, grouped_scan_kernel<Body>, blocks, sum_group, 0, count, body, sums, own_ticket);
  }
  void exclusive_scan(const char* label, View<std::int64_t> values) {
    timed(label, [&] { cuda_exclusive_scan(stream(), scratch_, values); });
  }

  /// Sorts by cell, of which the lowest `cell_bits` bits count; stable.
  void sort_pairs(const char* label,
                  View<CellPair> pairs,
                  View<const std::int64_t>,
                  int cell_bits) {
    if (pairs.size == 0) return;
    other_pairs_.reserve(pairs.size);
    timed(label, [&] {
      cuda_sort_pairs(stream(), scratch_, pairs, other_pairs_.view(pairs.size), cell_bits);
    });
  }

 private:
  /// Zero at the start and at the end of each kernel that counts its blocks in it.
  unsigned* ticket() {
    if (!has_ticket_) {
      ticket_.reserve(1);
      check_cuda(cudaMemsetAsync(ticket_.view(1).data, 0, sizeof(unsigned), stream()),
                 "cudaMemsetAsync");
      has_ticket_ = true;
    }
    return ticket_.view(1).data;
  }
  template <class T>
  static std::size_t bytes_of(std::int64_t size) {
    return static_cast<std::size_t>(size) * sizeof(T);
  }
  static dim3 blocks_for(std::int64_t count) {
    return dim3(static_cast<unsigned>((count + each_threads - 1) / each_threads));
  }

  DeviceBuffer<std::byte> scratch_;
  DeviceBuffer<CellPair> other_pairs_;
  DeviceBuffer<unsigned> ticket_;
  bool has_ticket_ = false;
};

}  // namespace tetwarp
