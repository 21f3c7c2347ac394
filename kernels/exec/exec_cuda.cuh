/// @file exec_cuda.cuh
/// CudaExec: the executor of stages and pipelines on one device: its loops, sums, sorts and lists.
#pragma once
#include <cstddef>
#include <cstdint>

#include "kernels/base/cell_pair.hpp"
#include "kernels/base/pair_limit.hpp"
#include "kernels/base/view.hpp"
#include "kernels/exec/device_copies.cuh"
#include "kernels/exec/device_limits.cuh"
#include "kernels/exec/device_list.cuh"
#include "kernels/exec/each_kernel.cuh"
#include "kernels/exec/grid_sum.cuh"
#include "kernels/exec/grouped_scan.cuh"
#include "kernels/exec/launch.hpp"
#include "kernels/exec/part_graphs.cuh"

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
/// Sums have one fixed tree: blocks of sum_threads threads sum runs of sum_run_of(terms) terms,
/// then one block sums these. Loops have as many blocks as multiprocessors or more, if their count
/// allows.
class CudaExec : public DeviceCopies {
 public:
  template <class T>
  using List = DeviceList<T>;

  /// Whether the host can read executor memory without waiting. On a device it cannot: pipelines
  /// read sizes once, then launch over the capacities of their buffers.
  static constexpr bool reads_are_free = false;

  /// @param clocks  off: times() are empty
  /// @pre the device is current
  explicit CudaExec(int device, StageClocks clocks = StageClocks::on)
      : DeviceCopies(device, clocks), multiprocessors_(device_limits(device).multiprocessors) {}
  /// An executor on the streams of another one, which may have other clocks. Its memory for sums
  /// and states is its own.
  CudaExec(const CudaExec& other, StageClocks clocks)
      : DeviceCopies(other, clocks), multiprocessors_(other.multiprocessors_) {}

  /// Sets few bytes to zero, by a kernel, so that it may be part of a graph.
  template <class T>
  void zero(const char* label, View<T> view) {
    const auto bytes = static_cast<std::int64_t>(bytes_of<T>(view.size));
    for_each(label, bytes, ZeroOp{{reinterpret_cast<std::uint8_t*>(view.data), bytes}});
  }
  /// Calls op(i) for i in [0, count), in any order.
  template <class Op>
  void for_each(const char* label, std::int64_t count, const Op& op) {
    if (count > 0) enqueue_each(label, each_kernel<Op>, count, count, op);
  }
  /// Calls op.finish(i, sum of op.part(i, lane) over Op::lanes lanes) for i in [0, count), in any
  /// order; the sum has the tree of summed_by_lanes().
  template <class Op>
  void for_each_by_lanes(const char* label, std::int64_t count, const Op& op) {
    if (count > 0) enqueue_each(label, each_by_lanes_kernel<Op>, Op::lanes * count, count, op);
  }
  template <class Op>
  void for_runs(const char* label, std::int64_t count, const Op& op) {
    for_each(label, count, SingleRuns<Op>{op});
  }
  template <class Op>
  void once(const char* label, const Op& op) {
    for_each(label, 1, op);
  }
  /// Calls op(i) for i in [part_start[k], part_start[k + 1]), one part after the other: a CUDA
  /// graph, recorded at the first call and launched again after it. Not measured.
  /// @param part_start  in memory of the host
  template <class Op>
  void for_each_part(View<const std::int64_t> part_start, const Op& op) {
    part_graphs_.launch(stream(), multiprocessors_, part_start, op);
  }
  /// Drops the recorded graphs; to be called when the arrays they read have moved.
  void forget_parts() { part_graphs_.clear(); }
  /// Calls op(s, item - offsets[s], item) for every item of segments s, which are the ranges
  /// [offsets[s], offsets[s + 1]), in any order. Items from `capacity` on are left out.
  /// @tparam Offsets  View<const std::int64_t> or GroupedSums
  template <class Offsets, class Op>
  void for_each_item(const char* label,
                     const Offsets& offsets,
                     std::int64_t capacity,
                     const Op& op) {
    if (capacity == 0) return;
    enqueue_each(label, each_item_kernel<Offsets, Op>, capacity, offsets, capacity, op);
  }

  /// Memory for sums of so many terms: launches that are recorded must not take it.
  template <class Sum>
  void reserve_sums(std::int64_t terms) {
    sums_.reserve(most_sum_runs_of(terms) * static_cast<std::int64_t>(sizeof(Sum)));
  }
  /// Sum of op(i) for i in [first, last); synchronizes.
  template <class Sum, class Op>
  Sum sum(const char* label, std::int64_t first, std::int64_t last, const Op& op) {
    if (first == last) return {};
    total_.reserve(sizeof(Sum));
    Sum* const total = reinterpret_cast<Sum*>(total_.view(0).data);
    sum_to(label, first, last, op, total);
    return load(total);
  }
  /// As sum(), without a wait. Not measured: events would take as long as the launches.
  /// @param out  in memory of the device
  template <class Sum, class Op>
  void sum_to(const char*, std::int64_t first, std::int64_t last, const Op& op, Sum* out) {
    const std::int64_t runs = sum_runs_of(last - first);
    reserve_sums<Sum>(last - first);
    const View<Sum> sums = {reinterpret_cast<Sum*>(sums_.view(0).data), runs};
    if (runs > 0) launch_sums(first, last, sum_run_of(last - first), op, sums);
    launch_sums(0, runs, runs, ReadySums<Sum>{sums}, View<Sum>{out, 1});
  }
  template <class Sum, class Op>
  void sum_runs_to(
      const char* label, std::int64_t first, std::int64_t last, const Op& op, Sum* out) {
    sum_to(label, first, last, SingleRuns<Op>{op}, out);
  }
  /// Sums op(i) for i in [0, count), and calls op.finish(total, k) for k in [0, sum_group).
  /// An op with a constant `lanes` is called by so many lanes together.
  /// @pre sums has room for `count` counts, in groups of sum_group / lanes
  template <class Op>
  void grouped_scan(const char* label, std::int64_t count, const Op& op, const GroupedSums& sums) {
    unsigned* const own_ticket = ticket();
    const dim3 blocks(static_cast<unsigned>(group_count(count, sums.shift)));
    enqueue(label, grouped_scan_kernel<Op>, blocks, sum_group, 0, count, op, sums, own_ticket);
  }
  void exclusive_scan(const char* label, View<std::int64_t> values) {
    timed(label, [&] { cuda_exclusive_scan(stream(), scratch_, values); });
  }

  /// Replaces the list by what op(i, emit) appends; see CpuExec::append(). Runs the op twice:
  /// to count, and to write. Waits for the counts.
  template <class Op, class T>
  void append(const char* label,
              std::int64_t count,
              const Op& op,
              DeviceList<T>& list,
              std::int64_t most = unlimited) {
    list.clear();
    if (count == 0) return;
    list_sums_.resize(2 * count + 1);
    list_totals_.resize(2);
    std::int64_t* const sums = list_sums_.view().data;
    for_each(label, count, AppendCountOp<Op>{op, {sums, count}, {sums + count, count}});
    exclusive_scan(label, list_sums_.view());
    for_each(label, 1, AppendTotalsOp{list_sums_.view(), list_totals_.view()});
    std::int64_t totals[2];
    get(View<const std::int64_t>(list_totals_.view()), totals);
    check_count(totals[0], most);
    list.tally_ = totals[1];
    list.set_size(totals[0]);
    for_each(label, list.size_ == 0 ? 0 : count,
             AppendWriteOp<Op, T>{op, list_sums_.view(), list.values()});
  }
  /// Replaces the list by op(i) for i in [0, count).
  template <class Op, class T>
  void fill(const char* label, std::int64_t count, const Op& op, DeviceList<T>& list) {
    list.clear();
    list.set_size(count);
    for_each(label, count, ListFillOp<Op, T>{op, list.values()});
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
  void sort_pairs(const char* label, DeviceList<CellPair>& list, int cell_bits) {
    sort_pairs(label, list.values(), {}, cell_bits);
  }

 private:
  /// Launches a kernel with one thread for each of `count` pieces of work, at least one.
  template <class... Parameters, class... Args>
  void enqueue_each(const char* label,
                    void (*kernel)(Parameters...),
                    std::int64_t count,
                    const Args&... args) {
    const EachShape shape = each_shape(count, multiprocessors_);
    enqueue(label, kernel, shape.blocks, shape.threads, 0, args...);
  }

  template <class Sum, class Term>
  void launch_sums(std::int64_t first,
                   std::int64_t last,
                   std::int64_t run,
                   const Term& term,
                   View<Sum> sums) const {
    launch(stream(), sums_kernel<Sum, Term>, dim3(static_cast<unsigned>(sums.size)),
           dim3(sum_threads), sum_warps * sizeof(Sum), first, last, run, term, sums);
  }
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

  std::int64_t multiprocessors_;
  DeviceBuffer<std::byte> scratch_, sums_, total_;
  DeviceBuffer<CellPair> other_pairs_;
  DeviceVector<std::int64_t> list_sums_, list_totals_;  ///< of append()
  PartGraphs part_graphs_;
  DeviceBuffer<unsigned> ticket_;
  bool has_ticket_ = false;
};

}  // namespace tetwarp
