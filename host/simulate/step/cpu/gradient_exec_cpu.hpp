/// @file gradient_exec_cpu.hpp
/// CpuGradientExec: the executor of island_cg() on host threads.
#pragma once
#include <algorithm>
#include <cstdint>
#include <type_traits>

#include "host/base/parallel.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"
#include "kernels/body/island_cg.hpp"

namespace tetwarp {

/// Runs island_cg(): bodies over rows, on one or several threads.
class CpuGradientExec {
 public:
  static constexpr std::int64_t run_length = 64;  ///< rows that are summed in sequence

  /// @param sums  room for one sum per run of rows, [rows / run_length + 1]
  CpuGradientExec(int threads, PlainSums<2>* sums) : threads_(threads), sums_(sums) {}

  template <class Body>
  void for_each(std::int64_t begin, std::int64_t end, const Body& body) const {
    for_runs(begin, end, [&](std::int64_t, std::int64_t first, std::int64_t past) {
      for (std::int64_t i = first; i < past; ++i) body(i);
    });
  }
  template <class Body>
  void once(const Body& body) const {
    body(0);
  }
  /// *out = sum of body(i): runs of rows in sequence, then their sums in sequence.
  template <class Body, int count>
  void sum_to(std::int64_t begin, std::int64_t end, const Body& body, PlainSums<count>* out) const {
    for_runs(begin, end, [&](std::int64_t run, std::int64_t first, std::int64_t past) {
      const PlainSums<count> sum = sum_of<count>(body, first, past);
      for (int k = 0; k < count; ++k) sums_[run].value[k] = sum.value[k];
    });
    PlainSums<count> total{};
    for (std::int64_t run = 0; run < (end - begin + run_length - 1) / run_length; ++run) {
      for (int k = 0; k < count; ++k) total.value[k] += sums_[run].value[k];
    }
    *out = total;
  }
  template <class Value>
  Value load(const Value* value) const {
    return *value;
  }
  /// Iterations between two reads of their sums.
  std::int64_t iterations_at_once() const { return 1; }
  /// Runs an iteration that many times.
  template <class Iteration>
  void repeat(std::int64_t count, const Iteration& iteration) const {
    for (std::int64_t i = 0; i < count; ++i) iteration.run(*this);
  }

 private:
  template <int count, class Body>
  static PlainSums<count> sum_of(const Body& body, std::int64_t begin, std::int64_t end) {
    if constexpr (std::is_same_v<Body, IslandProductBody<double>>) {
      return vector_stages().product(body.a, begin, end);
    } else if constexpr (std::is_same_v<Body, IslandProductBody<float>>) {
      return vector_stages().product_float(body.a, begin, end);
    } else {
      PlainSums<count> sum{};
      for (std::int64_t i = begin; i < end; ++i) sum += body(i);
      return sum;
    }
  }

  template <class Run>
  void for_runs(std::int64_t begin, std::int64_t end, const Run& run) const {
    const std::int64_t runs = (end - begin + run_length - 1) / run_length;
    const std::int64_t tasks = threads_ == 1 ? 1 : std::min<std::int64_t>(runs, 2 * threads_);
    parallel_tasks(threads_, tasks, [&](std::int64_t task) {
      for (std::int64_t r = runs * task / tasks; r < runs * (task + 1) / tasks; ++r) {
        run(r, begin + r * run_length, std::min(end, begin + (r + 1) * run_length));
      }
    });
  }

  int threads_;
  PlainSums<2>* sums_;
};

}  // namespace tetwarp
