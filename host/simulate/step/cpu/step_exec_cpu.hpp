/// @file step_exec_cpu.hpp
/// CpuStepExec: the executor of BodyPipeline on host threads. Results do not depend on their
/// number.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/base/parallel.hpp"
#include "host/simulate/step/body_arrays.hpp"
#include "host/simulate/step/cpu/gradient_exec_cpu.hpp"
#include "host/simulate/step/cpu/huge_pages.hpp"
#include "host/simulate/step/cpu/rest_gradients.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"
#include "host/simulate/step/stepper.hpp"
#include "kernels/base/stage_times.hpp"
#include "kernels/base/view.hpp"
#include "kernels/body/island_cg.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {

class CpuStepExec {
 public:
  static constexpr bool is_on_host = true;  ///< host reads its memory

  template <class T>
  using Vector = std::vector<T, HugePageAllocator<T>>;
  /// An array that the host renews in every step.
  template <class T>
  using Input = Vector<T>;

  /// @param rest  for islands that block Jacobi solves slowly; kept by the caller
  CpuStepExec(int threads, RestGradients& rest) : threads_(threads), rest_(rest) {}

  int threads() const { return threads_; }

  /// Sets the size; all entries become zero.
  template <class T>
  void resize(Vector<T>& values, std::int64_t size) const {
    values.assign(static_cast<std::size_t>(size), T{});
  }
  /// Copies from the host to memory of the executor.
  template <class T>
  void put(const T* host, std::int64_t size, Vector<T>& values) const {
    values.assign(host, host + size);
  }
  /// As put(); an executor may leave out what has not changed since the last call.
  template <class T>
  void renew(const T* host, std::int64_t size, Input<T>& values) const {
    put(host, size, values);
  }
  /// Copies from memory of the executor to the host.
  template <class T>
  void get(View<const T> values, T* host) const {
    std::copy_n(values.data, values.size, host);
  }
  /// Several arrays of numbers; a device waits once for all.
  void get_all(std::initializer_list<HostCopy> copies) const {
    for (const HostCopy& copy : copies) get(copy.from, copy.to);
  }
  template <class T>
  View<T> view(Vector<T>& values) const {
    return {values.data(), static_cast<std::int64_t>(values.size())};
  }
  template <class T>
  View<const T> view(const Vector<T>& values) const {
    return {values.data(), static_cast<std::int64_t>(values.size())};
  }

  /// body(i) for i in [0, count), any order; adds the time to that of the label.
  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    const Clock clock(times_, label);
    parallel_for(count < serial_below ? 1 : threads_, count, body);
  }
  void tet_forces(const char* label, const TetForceBody& body) {
    for_ranges(label, body.tets.count, [&](std::int64_t begin, std::int64_t end) {
      vector_stages().tet_forces(body, begin, end);
    });
  }
  void assemble(const char* label, const BlockAssembleBody& body) {
    for_ranges(label, body.rows.upper.size, [&](std::int64_t begin, std::int64_t end) {
      vector_stages().assemble(body, begin, end);
    });
  }
  /// Numbers of ones in two arrays of 0 and 1.
  std::pair<std::int64_t, std::int64_t> count_ones(View<const std::uint8_t> first,
                                                   View<const std::uint8_t> second) const {
    const auto ones_in = [](View<const std::uint8_t> flags) {
      return std::accumulate(flags.data, flags.data + flags.size, std::int64_t{0});
    };
    return {ones_in(first), ones_in(second)};
  }

  /// Reserves memory for solve_islands(); sorts the islands by whether one thread solves them.
  void prepare_solve(const std::vector<std::int32_t>& island_start) {
    const std::size_t islands = island_start.size() - 1;
    sums_.resize(static_cast<std::size_t>(island_start.back()) / CpuGradientExec::run_length +
                 islands + 1);
    ends_.resize(islands);
    small_.clear();
    large_.clear();
    for (std::size_t i = 0; i < islands; ++i) {
      const auto island = static_cast<std::int32_t>(i);
      (is_large(island_start, island) ? large_ : small_).push_back(island);
    }
  }

  /// Solves all islands and calls take(end) for each. Small islands are one task each. Islands that
  /// RestGradients can solve and that have not converged after `first_iterations` follow with it.
  /// @param proceed  as of island_cg(); called by this thread only
  template <class T, class Proceed, class Take>
  void solve_islands(const char* label,
                     const std::vector<std::int32_t>& island_start,
                     const GradientArrays<T>& arrays,
                     const GradientOptions& options,
                     const Proceed& proceed,
                     const Take& take) {
    const Clock clock(times_, label);
    const auto solve = [&](std::int32_t island, int threads, std::int64_t most, const auto& go_on) {
      const auto i = static_cast<std::size_t>(island);
      const std::int64_t begin = island_start[i], end = island_start[i + 1];
      GradientScalars scalars;
      CpuGradientExec exec(threads, sums_.data() + begin / CpuGradientExec::run_length + i);
      const std::int64_t before = ends_[i].iterations;
      ends_[i] = island_cg(exec, arrays, begin, end, {options.tolerance, most - before}, &scalars,
                           [&](std::int64_t iterations) { return go_on(before + iterations); });
      ends_[i].iterations += before;
    };
    const auto most_at_first = [&](std::int32_t island) {
      const std::int64_t most = options.max_iterations;
      return can_follow<T>(island) ? std::min(most, first_iterations) : most;
    };
    for (GradientEnd& end : ends_) end = {};
    improved_.clear();
    bool goes_on = proceed(0);
    if (goes_on) {
      parallel_tasks(threads_, static_cast<std::int64_t>(small_.size()), [&](std::int64_t k) {
        const std::int32_t island = small_[static_cast<std::size_t>(k)];
        solve(island, 1, most_at_first(island), [](std::int64_t) { return true; });
      });
    }
    const auto solve_large = [&](std::int32_t island, std::int64_t most) {
      solve(island, threads_, most, [&](std::int64_t iterations) {
        return iterations % asked_after != 0 || proceed(iterations);
      });
      goes_on = !ends_[static_cast<std::size_t>(island)].is_stopped;
    };
    for (std::size_t k = 0; k < large_.size() && goes_on; ++k) {
      solve_large(large_[k], most_at_first(large_[k]));
    }
    if (goes_on) improve(island_start, arrays, options);
    if (goes_on) {
      parallel_tasks(threads_, static_cast<std::int64_t>(improved_.size()), [&](std::int64_t k) {
        const std::int32_t island = improved_[static_cast<std::size_t>(k)];
        if (!is_large(island_start, island)) {
          solve(island, 1, options.max_iterations, [](std::int64_t) { return true; });
        }
      });
    }
    for (std::size_t k = 0; k < improved_.size() && goes_on; ++k) {
      if (is_large(island_start, improved_[k])) solve_large(improved_[k], options.max_iterations);
    }
    for (GradientEnd& end : ends_) {
      end.is_stopped |= !goes_on;
      take(end);
    }
  }

  void clear_times() { times_.clear(); }
  void read_times(StepSeconds& seconds) const {
    seconds.forces = times_.of("body/forces");
    seconds.assembly = times_.of("body/assembly");
    seconds.linear = times_.of("body/linear");
    seconds.update = times_.of("body/update");
    seconds.total = seconds.forces + seconds.assembly + seconds.linear + seconds.update;
  }

 private:
  /// stage(begin, end) for parts of [0, count) of at most range_length indices.
  template <class Stage>
  void for_ranges(const char* label, std::int64_t count, const Stage& stage) {
    const Clock clock(times_, label);
    const std::int64_t ranges = (count + range_length - 1) / range_length;
    parallel_tasks(threads_, ranges, [&](std::int64_t range) {
      stage(range * range_length, std::min(count, (range + 1) * range_length));
    });
  }

  template <class T>
  bool can_follow(std::int32_t island) const {
    return std::is_same_v<T, double> && rest_.is_possible(island);
  }

  static bool is_large(const std::vector<std::int32_t>& island_start, std::int32_t island) {
    const auto i = static_cast<std::size_t>(island);
    return island_start[i + 1] - island_start[i] >= serial_below;
  }

  /// Lists the islands that have not converged, and improves them by RestGradients, one task each.
  template <class T>
  void improve(const std::vector<std::int32_t>& island_start,
               const GradientArrays<T>& arrays,
               const GradientOptions& options) {
    if constexpr (std::is_same_v<T, double>) {
      for (std::size_t i = 0; i < ends_.size(); ++i) {
        const auto island = static_cast<std::int32_t>(i);
        const bool is_left = !ends_[i].is_converged && ends_[i].iterations >= first_iterations &&
                             ends_[i].iterations < options.max_iterations;
        if (is_left && can_follow<T>(island)) improved_.push_back(island);
      }
      parallel_tasks(threads_, static_cast<std::int64_t>(improved_.size()), [&](std::int64_t k) {
        const std::int32_t island = improved_[static_cast<std::size_t>(k)];
        const auto i = static_cast<std::size_t>(island);
        const std::int64_t left = options.max_iterations - ends_[i].iterations;
        ends_[i].iterations += rest_.solve(arrays, island, island_start[i], island_start[i + 1],
                                           {options.tolerance, left});
      });
    }
  }

  class Clock {
   public:
    Clock(StageTimes& times, const char* label)
        : times_(times), label_(label), start_(std::chrono::steady_clock::now()) {}
    ~Clock() {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
      times_.add(label_, passed.count());
    }
    Clock(const Clock&) = delete;
    Clock& operator=(const Clock&) = delete;

   private:
    StageTimes& times_;
    const char* label_;
    std::chrono::steady_clock::time_point start_;
  };

  static constexpr std::int64_t serial_below = 512;  ///< with fewer indices one thread is faster

  static constexpr std::int64_t range_length = 1024;
  static constexpr std::int64_t first_iterations = 3;
  static constexpr std::int64_t asked_after = 10;  ///< iterations between calls of `proceed`

  int threads_;
  RestGradients& rest_;
  StageTimes times_;
  std::vector<PlainSums<2>> sums_;
  std::vector<GradientEnd> ends_;
  std::vector<std::int32_t> small_, large_;  ///< islands
  std::vector<std::int32_t> improved_;       ///< islands of improve()
};

}  // namespace tetwarp
