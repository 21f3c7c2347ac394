/// @file contact_grid.cuh
/// GridContactExec: the executor of the contact pipeline on a whole device, for islands that are
/// too large for one block or whose blocks A couples. The host controls the iteration and reads one
/// sum from the device for each decision.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/contact/contact_block.cuh"
#include "kernels/contact/sweep_graph.cuh"
#include "kernels/exec/device_vector.cuh"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/exec/grid_sum.cuh"

namespace tetwarp {

/// One index = one run of one entry.
template <class Body>
struct SingleRuns {
  Body body;

  TETWARP_HD auto operator()(std::int64_t i) const { return body.template run<1>(i, i + 1); }
};

/// Calls enqueue work on the stream of a CudaExec; see CpuContactExec for their definitions.
class GridContactExec {
 public:
  template <class T>
  using Vector = DeviceVector<T>;
  template <class T>
  using Buffer = DeviceBuffer<T>;

  /// @param exec  kept by the caller
  explicit GridContactExec(CudaExec& exec) : exec_(&exec) {}

  /// Sets the size; all entries become zero.
  template <class T>
  void resize(Vector<T>& values, std::int64_t size) const {
    values.resize(size);
    if (size == 0) return;
    check_cuda(cudaMemsetAsync(values.view().data, 0, static_cast<std::size_t>(size) * sizeof(T),
                               exec_->stream()),
               "cudaMemsetAsync");
  }
  /// Copies from the host.
  template <class T>
  void put(const T* host, std::int64_t size, Vector<T>& values) const {
    values.resize(size);
    if (size == 0) return;
    check_cuda(cudaMemcpyAsync(values.view().data, host, static_cast<std::size_t>(size) * sizeof(T),
                               cudaMemcpyHostToDevice, exec_->stream()),
               "cudaMemcpyAsync to device");
  }
  /// Copies to the host; synchronizes.
  template <class T>
  void get(View<const T> values, T* host) const {
    if (values.size > 0) exec_->read(values, host);
  }
  template <class T>
  void copy(const char*, View<const T> from, View<T> to) const {
    if (from.size == 0) return;
    check_cuda(cudaMemcpyAsync(to.data, from.data, static_cast<std::size_t>(from.size) * sizeof(T),
                               cudaMemcpyDeviceToDevice, exec_->stream()),
               "cudaMemcpyAsync on device");
  }
  /// Stages are not timed: events would take as long as the launches.
  template <class Body>
  void for_each(const char*, std::int64_t count, const Body& body) const {
    if (count == 0) return;
    launch(exec_->stream(), each_kernel<Body>,
           dim3(static_cast<unsigned>((count + each_threads - 1) / each_threads)),
           dim3(each_threads), 0, count, body);
  }

  template <class Body>
  void for_runs(const char* label, std::int64_t count, const Body& body) const {
    for_each(label, count, SingleRuns<Body>{body});
  }
  template <class Body>
  void once(const char* label, const Body& body) const {
    for_each(label, 1, body);
  }

  /// Default-constructs a State in memory of the device; replaces that of the previous call.
  template <class State>
  State* state() {
    static_assert(sizeof(State) <= state_bytes);
    state_.resize(state_bytes);
    const State fresh{};
    check_cuda(cudaMemcpyAsync(state_.view().data, &fresh, sizeof(State), cudaMemcpyHostToDevice,
                               exec_->stream()),
               "cudaMemcpyAsync to device");
    return reinterpret_cast<State*>(state_.view().data);
  }
  /// Reads one value of device memory; synchronizes.
  template <class T>
  T load(const T* value) {
    pinned_.reserve(sizeof(T));
    T* const pinned = reinterpret_cast<T*>(pinned_.view(0).data);
    exec_->read(View<const T>{value, 1}, pinned);
    return *pinned;
  }
  template <class T>
  T load_without_sync(const T*, T otherwise) const {
    return otherwise;
  }
  /// Only every eighth step, because the device idles while the host reads.
  bool is_sync_point(std::int64_t step) const { return step % 8 == 0; }
  static constexpr bool reads_need_sync = true;

  template <class Sum, class Body>
  Sum sum(const char* label, std::int64_t first, std::int64_t last, const Body& body) {
    if (first == last) return {};
    total_.resize(sizeof(Sum));
    Sum* const total = reinterpret_cast<Sum*>(total_.view().data);
    sum_to(label, first, last, body, total);
    return load(total);
  }
  /// @param out  in memory of the device
  template <class Sum, class Body>
  void sum_to(const char*, std::int64_t first, std::int64_t last, const Body& body, Sum* out) {
    const std::int64_t runs = (last - first + sum_run - 1) / sum_run;
    sums_.resize(runs * static_cast<std::int64_t>(sizeof(Sum)));
    const View<Sum> sums = {reinterpret_cast<Sum*>(sums_.view().data), runs};
    if (runs > 0) launch_sums(first, last, sum_run, body, sums);
    launch_sums(0, runs, runs, ReadySums<Sum>{sums}, View<Sum>{out, 1});
  }
  template <class Sum, class Body>
  void sum_runs_to(
      const char* label, std::int64_t first, std::int64_t last, const Body& body, Sum* out) {
    sum_to(label, first, last, SingleRuns<Body>{body}, out);
  }

  /// One sweep over colors as a CUDA graph, recorded at the first call and launched again after it.
  template <class Body>
  void sweep(View<const std::int64_t> color_start, const Body& body) {
    graphs_.launch(exec_->stream(), color_start, body);
  }

  /// Drops the recorded graphs; to be called when the arrays they read have moved.
  void forget_sweeps() { graphs_.clear(); }

 private:
  template <class Sum, class Term>
  void launch_sums(std::int64_t first,
                   std::int64_t last,
                   std::int64_t run,
                   const Term& term,
                   View<Sum> sums) const {
    launch(exec_->stream(), sums_kernel<Sum, Term>, dim3(static_cast<unsigned>(sums.size)),
           dim3(sum_threads), sum_warps * sizeof(Sum), first, last, run, term, sums);
  }

  static constexpr std::int64_t state_bytes = 1024;

  CudaExec* exec_;
  DeviceVector<std::byte> state_, sums_, total_;
  PinnedBuffer<std::byte> pinned_;
  SweepGraphs graphs_;
};

/// The stage "sweep" as a recorded graph.
template <class Body>
void contact_sweep(GridContactExec& exec, View<const std::int64_t> color_start, const Body& body) {
  exec.sweep(color_start, body);
}

}  // namespace tetwarp
