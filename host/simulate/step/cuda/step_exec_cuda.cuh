/// @file step_exec_cuda.cuh
/// CudaStepExec: the executor of BodyPipeline on a device; functions as those of CpuStepExec.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "host/simulate/step/body_arrays.hpp"
#include "host/simulate/step/cuda/grid_gradients.cuh"
#include "host/simulate/step/stepper.hpp"
#include "kernels/body/block_assemble.hpp"
#include "kernels/body/island_block.cuh"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {

/// One index = one flag.
struct FlagSumBody {
  View<const std::uint8_t> flags;
  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const {
    return {{static_cast<double>(flags[i])}};
  }
};

class CudaStepExec {
 public:
  static constexpr bool is_on_host = false;  ///< host reads its memory

  template <class T>
  using Vector = DeviceVector<T>;
  /// An array that the host renews in every step, and what it sent last.
  template <class T>
  struct Input : DeviceVector<T> {
    std::vector<T> sent;
  };

  explicit CudaStepExec(int device) : exec_(device) {
    scalars_.resize(1);
    ones_.resize(2);
    pinned_.reserve(1);
  }

  /// @returns  an object during whose life the device is the current one of this thread
  DeviceScope enter() { return exec_.enter(0); }

  template <class T>
  void resize(Vector<T>& values, std::int64_t size) {
    values.resize(size);
    if (size > 0) {
      check_cuda(cudaMemsetAsync(values.view().data, 0, static_cast<std::size_t>(size) * sizeof(T),
                                 exec_.stream()),
                 "cudaMemsetAsync");
    }
    sums_.reserve(size);
  }
  template <class T>
  void put(const T* host, std::int64_t size, Vector<T>& values) {
    values.resize(size);
    if (size == 0) return;
    check_cuda(cudaMemcpyAsync(values.view().data, host, static_cast<std::size_t>(size) * sizeof(T),
                               cudaMemcpyHostToDevice, exec_.stream()),
               "cudaMemcpyAsync to device");
  }
  /// Copies the part between the first and the last number that changed since the last call.
  template <class T>
  void renew(const T* host, std::int64_t size, Input<T>& values) {
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
    check_cuda(cudaMemcpyAsync(values.view().data + begin, host + begin,
                               static_cast<std::size_t>(end - begin) * sizeof(T),
                               cudaMemcpyHostToDevice, exec_.stream()),
               "cudaMemcpyAsync to device");
  }
  /// Copies an array within memory of the device.
  template <class T>
  void copy(const Vector<T>& from, Vector<T>& to) {
    to.resize(from.view().size);
    if (from.view().size == 0) return;
    check_cuda(cudaMemcpyAsync(to.view().data, from.view().data,
                               static_cast<std::size_t>(from.view().size) * sizeof(T),
                               cudaMemcpyDeviceToDevice, exec_.stream()),
               "cudaMemcpyAsync on the device");
  }
  cudaStream_t stream() const { return exec_.stream(); }
  /// The executor that it enqueues on.
  CudaExec& device_exec() { return exec_; }
  /// Waits for all that has been enqueued.
  void wait() { check_cuda(cudaStreamSynchronize(exec_.stream()), "cudaStreamSynchronize"); }
  template <class T>
  void get(View<const T> values, T* host) {
    if (values.size > 0) exec_.read(values, host);
  }
  /// With one wait for all.
  void get_all(std::initializer_list<HostCopy> copies) {
    std::int64_t size = 0;
    for (const HostCopy& copy : copies) size += copy.from.size;
    host_numbers_.reserve(size);
    double* const numbers = host_numbers_.view(size).data;
    double* next = numbers;
    for (const HostCopy& copy : copies) {
      if (copy.from.size == 0) continue;
      check_cuda(cudaMemcpyAsync(next, copy.from.data,
                                 static_cast<std::size_t>(copy.from.size) * sizeof(double),
                                 cudaMemcpyDeviceToHost, exec_.stream()),
                 "cudaMemcpyAsync to host");
      next += copy.from.size;
    }
    wait();
    next = numbers;
    for (const HostCopy& copy : copies) {
      std::copy_n(next, copy.from.size, copy.to);
      next += copy.from.size;
    }
  }
  template <class T>
  View<T> view(Vector<T>& values) const {
    return values.view();
  }
  template <class T>
  View<const T> view(const Vector<T>& values) const {
    return values.view();
  }

  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    exec_.for_each(label, count, body);
  }
  void tet_forces(const char* label, const TetForceBody& body) {
    exec_.for_each(label, body.tets.count, body);
  }
  void assemble(const char* label, const BlockAssembleBody& body) {
    exec_.for_each(label, body.rows.upper.size, body);
  }
  std::pair<std::int64_t, std::int64_t> count_ones(View<const std::uint8_t> first,
                                                   View<const std::uint8_t> second) {
    PlainSums<1>* const out = ones_.view().data;
    sums_.sum_to(exec_.stream(), 0, first.size, FlagSumBody{first}, out);
    sums_.sum_to(exec_.stream(), 0, second.size, FlagSumBody{second}, out + 1);
    PlainSums<1> totals[2];
    exec_.read(View<const PlainSums<1>>{out, 2}, totals);
    return {static_cast<std::int64_t>(totals[0].value[0]),
            static_cast<std::int64_t>(totals[1].value[0])};
  }

  /// Sorts the islands by whether one block solves them.
  void prepare_solve(const std::vector<std::int32_t>& island_start) {
    std::vector<IslandRows> small;
    large_.clear();
    for (std::size_t i = 0; i + 1 < island_start.size(); ++i) {
      const IslandRows rows = {island_start[i], island_start[i + 1]};
      (rows.end - rows.begin <= block_rows ? small : large_).push_back(rows);
    }
    put(small.data(), static_cast<std::int64_t>(small.size()), small_);
    ends_.resize(small_.view().size);
    host_ends_.reserve(small_.view().size);
    sums_.reserve(island_start.back());
    graphs_ = std::vector<IterationGraph>(large_.size());
  }

  template <class T, class Proceed, class Take>
  void solve_islands(const char* label,
                     const std::vector<std::int32_t>&,
                     const GradientArrays<T>& arrays,
                     const GradientOptions& options,
                     const Proceed& proceed,
                     const Take& take) {
    if (!proceed(0)) {
      GradientEnd stopped;
      stopped.is_stopped = true;
      return take(stopped);
    }
    exec_.timed(label, [&] {
      const std::int64_t small = small_.view().size;
      if (small > 0) {
        launch(exec_.stream(), island_cg_kernel<T>, dim3(static_cast<unsigned>(small)),
               dim3(sum_threads), island_shared_bytes, arrays,
               static_cast<const Vector<IslandRows>&>(small_).view(), options, ends_.view());
        const View<GradientEnd> ends = host_ends_.view(small);
        exec_.read(static_cast<const Vector<GradientEnd>&>(ends_).view(), ends.data);
        for (std::int64_t i = 0; i < small; ++i) take(ends[i]);
      }
      for (std::size_t i = 0; i < large_.size(); ++i) {
        const IslandRows& rows = large_[i];
        GridGradientExec grid(exec_, sums_, pinned_, graphs_[i]);
        const GradientEnd end =
            island_cg(grid, arrays, rows.begin, rows.end, options, scalars_.view().data, proceed);
        take(end);
        if (end.is_stopped) return;
      }
    });
  }

  void clear_times() { exec_.times().clear(); }
  void read_times(StepSeconds& seconds) {
    StageTimes& times = exec_.times();
    seconds.forces = times.of("body/forces");
    seconds.assembly = times.of("body/assembly");
    seconds.linear = times.of("body/linear");
    seconds.update = times.of("body/update");
    seconds.total = seconds.forces + seconds.assembly + seconds.linear + seconds.update;
  }

 private:
  static constexpr std::int64_t block_rows = 1024;  ///< larger islands use the whole device

  CudaExec exec_;
  DeviceSums sums_;
  DeviceVector<GradientScalars> scalars_;
  DeviceVector<PlainSums<1>> ones_;
  PinnedBuffer<GradientScalars> pinned_;
  PinnedBuffer<double> host_numbers_;
  DeviceVector<IslandRows> small_;
  DeviceVector<GradientEnd> ends_;
  PinnedBuffer<GradientEnd> host_ends_;
  std::vector<IslandRows> large_;
  std::vector<IterationGraph> graphs_;  ///< of them
};

}  // namespace tetwarp
