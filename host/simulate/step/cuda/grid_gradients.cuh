/// @file grid_gradients.cuh
/// Conjugate gradients of large islands on a whole device.
#pragma once
#include <cstdint>

#include "kernels/body/island_cg.hpp"
#include "kernels/exec/device_vector.cuh"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/exec/grid_sum.cuh"
#include "kernels/exec/iteration_graph.cuh"

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

  /// sums[b] = sum of term over the b-th `run` of [begin, end).
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

 private:
  DeviceVector<PlainSums<2>> runs_;
};

/// One index = index begin + i of the other body.
template <class Body>
struct ShiftedBody {
  std::int64_t begin;
  Body body;
  TETWARP_HD void operator()(std::int64_t i) const { body(begin + i); }
};

/// Runs island_cg() on a whole device, several iterations as one graph; the host reads sums after
/// each.
class GridGradientExec {
 public:
  static constexpr std::int64_t length = 8;  ///< iterations of a graph

  /// @param graph  of the rows that island_cg() solves: the arrays of a stepper stay where they are
  GridGradientExec(CudaExec& exec,
                   DeviceSums& sums,
                   PinnedBuffer<GradientScalars>& pinned,
                   IterationGraph& graph)
      : exec_(exec), sums_(sums), pinned_(pinned), graph_(graph) {}

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
  std::int64_t iterations_at_once() const { return length; }
  template <class Iteration>
  void repeat(std::int64_t count, const Iteration& iteration) {
    const auto run = [&] {
      for (std::int64_t i = 0; i < count; ++i) iteration.run(*this);
    };
    if (count == length) return graph_.launch(exec_.stream(), run);
    run();
  }

 private:
  CudaExec& exec_;
  DeviceSums& sums_;
  PinnedBuffer<GradientScalars>& pinned_;
  IterationGraph& graph_;
};

}  // namespace tetwarp
