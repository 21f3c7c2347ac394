/// @file step_exec_cuda.cuh
/// CudaStepExec: the executor of BodyPipeline on a device; functions as those of CpuStepExec.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/simulate/stepper.hpp"
#include "kernels/body/block_assemble.hpp"
#include "kernels/body/island_block.cuh"
#include "kernels/body/tet_force.hpp"
#include "kernels/exec/device_vector.cuh"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/exec/grid_sum.cuh"

namespace tetwarp {

/// Sums on a whole device, without allocation.
class DeviceSums {
 public:
  void reserve(std::int64_t terms) { runs_.resize((terms + sum_run - 1) / sum_run + 1); }

  /// *out = sum of body(i) for i in [begin, end). @param out  in memory of the device
  template <class Body, int count>
  void sum_to(cudaStream_t stream,
              std::int64_t begin,
              std::int64_t end,
              const Body& body,
              PlainSums<count>* out) {
    using Sum = PlainSums<count>;
    const std::int64_t runs = (end - begin + sum_run - 1) / sum_run;
    const View<Sum> sums = {reinterpret_cast<Sum*>(runs_.view().data), runs};
    if (runs > 0) launch_sums(stream, begin, end, sum_run, body, sums);
    launch_sums(stream, 0, runs, runs, ReadySums<Sum>{sums}, View<Sum>{out, 1});
  }

 private:
  template <class Sum, class Term>
  static void launch_sums(cudaStream_t stream,
                          std::int64_t begin,
                          std::int64_t end,
                          std::int64_t run,
                          const Term& term,
                          View<Sum> sums) {
    launch(stream, sums_kernel<Sum, Term>, dim3(static_cast<unsigned>(sums.size)),
           dim3(sum_threads), sum_warps * sizeof(Sum), begin, end, run, term, sums);
  }

  DeviceVector<PlainSums<2>> runs_;
};

/// One index = index begin + i of the other body.
template <class Body>
struct ShiftedBody {
  std::int64_t begin;
  Body body;
  TETWARP_HD void operator()(std::int64_t i) const { body(begin + i); }
};

/// Runs island_cg() on a whole device; the host reads sums at every eighth iteration.
class GridGradientExec {
 public:
  GridGradientExec(CudaExec& exec, DeviceSums& sums, PinnedBuffer<GradientScalars>& pinned)
      : exec_(exec), sums_(sums), pinned_(pinned) {}

  template <class Body>
  void for_each(std::int64_t begin, std::int64_t end, const Body& body) const {
    const ShiftedBody<Body> shifted{begin, body};
    const std::int64_t count = end - begin;
    launch(exec_.stream(), each_kernel<ShiftedBody<Body>>,
           dim3(static_cast<unsigned>((count + each_threads - 1) / each_threads)),
           dim3(each_threads), 0, count, shifted);
  }
  template <class Body>
  void once(const Body& body) const {
    for_each(0, 1, body);
  }
  template <class Body, int count>
  void sum_to(std::int64_t begin, std::int64_t end, const Body& body, PlainSums<count>* out) {
    sums_.sum_to(exec_.stream(), begin, end, body, out);
  }
  template <class Value>
  Value load(const Value* value) const {
    static_assert(sizeof(Value) <= sizeof(GradientScalars));
    auto* const pinned = reinterpret_cast<Value*>(pinned_.view(1).data);
    exec_.read(View<const Value>{value, 1}, pinned);
    return *pinned;
  }
  bool is_sync_point(std::int64_t iteration) const { return iteration % 8 == 0; }

 private:
  CudaExec& exec_;
  DeviceSums& sums_;
  PinnedBuffer<GradientScalars>& pinned_;
};

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

  explicit CudaStepExec(int device) : exec_(device) {
    scalars_.resize(1);
    pinned_.reserve(1);
  }

  /// Makes the device current on this thread.
  void enter() { exec_.use_stream(nullptr); }

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
  template <class T>
  void get(View<const T> values, T* host) {
    if (values.size > 0) exec_.read(values, host);
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
  std::int64_t count_ones(View<const std::uint8_t> flags) {
    PlainSums<1>* const out = &scalars_.view().data->next;
    sums_.sum_to(exec_.stream(), 0, flags.size, FlagSumBody{flags}, out);
    PlainSums<1> total;
    exec_.read(View<const PlainSums<1>>{out, 1}, &total);
    return static_cast<std::int64_t>(total.value[0]);
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
      GridGradientExec grid(exec_, sums_, pinned_);
      for (const IslandRows& rows : large_) {
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
  PinnedBuffer<GradientScalars> pinned_;
  DeviceVector<IslandRows> small_;
  DeviceVector<GradientEnd> ends_;
  PinnedBuffer<GradientEnd> host_ends_;
  std::vector<IslandRows> large_;
};

}  // namespace tetwarp
