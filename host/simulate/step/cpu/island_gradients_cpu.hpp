/// @file island_gradients_cpu.hpp
/// IslandGradients on host threads. Results do not depend on their number.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "host/base/parallel.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/simulate/step/cpu/island_factors.hpp"
#include "host/simulate/step/cpu/rest_gradients.hpp"
#include "host/simulate/step/cpu/stages_cpu.hpp"
#include "host/simulate/step/island_gradients.hpp"
#include "kernels/body/island_cg.hpp"

namespace tetwarp {

template <>
class IslandGradients<CpuExec> {
 public:
  /// @param exec  kept by the caller
  /// @param rest  for islands that block Jacobi solves slowly; kept by the caller
  IslandGradients(CpuExec& exec, RestGradients& rest)
      : exec_(exec), shared_(exec.threads(), StageClocks::off), rest_(rest) {}

  /// Sets the first row of each island, and the end; sorts them by whether one thread solves them.
  void set_islands(const std::vector<std::int32_t>& island_start) {
    start_ = island_start;
    ends_.resize(start_.size() - 1);
    factors_.resize(ends_.size());
    small_.clear();
    large_.clear();
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      const auto island = static_cast<std::int32_t>(i);
      (is_large(island) ? large_ : small_).push_back(island);
    }
  }

  /// Solves all islands and calls take(end) for each. Small islands are one task each. Islands that
  /// RestGradients can solve and that have not converged after `first_iterations` follow with it;
  /// others that IslandFactors can solve follow with it after iterations that take as long, or
  /// at once where that is not long.
  /// @param proceed  as of island_cg(); called by this thread only
  template <class T, class Proceed, class Take>
  void solve(const GradientArrays<T>& arrays,
             const GradientOptions& options,
             const Proceed& proceed,
             const Take& take) {
    const CpuExec::Clock clock(exec_, gradient_label());
    const auto most_at_first = [&](std::int32_t island) {
      const std::int64_t most = options.max_iterations;
      if (can_follow<T>(island)) return std::min(most, first_iterations);
      if constexpr (!std::is_same_v<T, double>) return most;
      IslandFactors& factors = factors_[static_cast<std::size_t>(island)];
      const std::int64_t worth = factors.find_worth(arrays.rows, begin_of(island), end_of(island));
      return std::min(most, factors.are_quick() ? 0 : worth);
    };
    const auto most_in_all = [&](std::int32_t) { return options.max_iterations; };
    for (GradientEnd& end : ends_) end = {};
    for (IslandFactors& factors : factors_) factors.forget();
    if ((goes_on_ = proceed(0))) {
      solve_small(small_, arrays, options.tolerance, most_at_first);
      solve_large(large_, arrays, options.tolerance, most_at_first, proceed);
    }
    for (Islands* list : {&improved_, &improved_small_, &improved_large_}) list->clear();
    if (goes_on_) improve(arrays, options);
    if (goes_on_) {
      solve_small(improved_small_, arrays, options.tolerance, most_in_all);
      solve_large(improved_large_, arrays, options.tolerance, most_in_all, proceed);
    }
    for (GradientEnd& end : ends_) {
      end.is_stopped |= !goes_on_;
      take(end);
    }
  }

  /// [islands] Factors of the last solve.
  std::vector<IslandFactors>& factors() { return factors_; }

 private:
  using Islands = std::vector<std::int32_t>;

  static constexpr std::int64_t large_rows = 512;  ///< from which all threads solve an island
  static constexpr std::int64_t first_iterations = 3;
  static constexpr std::int64_t asked_after = 10;  ///< iterations between calls of `proceed`

  std::int64_t begin_of(std::int32_t island) const {
    return start_[static_cast<std::size_t>(island)];
  }
  std::int64_t end_of(std::int32_t island) const { return begin_of(island + 1); }
  GradientEnd& end_for(std::int32_t island) { return ends_[static_cast<std::size_t>(island)]; }
  bool is_large(std::int32_t island) const {
    return end_of(island) - begin_of(island) >= large_rows;
  }
  template <class T>
  bool can_follow(std::int32_t island) const {
    return std::is_same_v<T, double> && rest_.is_possible(island);
  }

  /// Goes on with an island until it has had `most` iterations.
  template <class T, class Proceed>
  void solve(CpuExec& exec,
             std::int32_t island,
             const GradientArrays<T>& arrays,
             const GradientOptions& options,
             const Proceed& proceed) {
    IslandScalars scalars;
    const std::int64_t before = end_for(island).iterations;
    GradientEnd end =
        island_cg(exec, arrays, begin_of(island), end_of(island),
                  {options.tolerance, options.max_iterations - before}, &scalars,
                  [&](std::int64_t iterations) { return proceed(before + iterations); });
    end.iterations += before;
    end_for(island) = end;
  }
  /// @param most  (island): iterations in all
  template <class T, class Most>
  void solve_small(const Islands& islands,
                   const GradientArrays<T>& arrays,
                   double tolerance,
                   const Most& most) {
    parallel_tasks(exec_.threads(), std::ssize(islands), [&](std::int64_t k) {
      const std::int32_t island = islands[static_cast<std::size_t>(k)];
      CpuExec own(1, StageClocks::off);
      solve(own, island, arrays, {tolerance, most(island)}, [](std::int64_t) { return true; });
    });
  }
  template <class T, class Most, class Proceed>
  void solve_large(const Islands& islands,
                   const GradientArrays<T>& arrays,
                   double tolerance,
                   const Most& most,
                   const Proceed& proceed) {
    for (std::size_t k = 0; k < islands.size() && goes_on_; ++k) {
      solve(shared_, islands[k], arrays, {tolerance, most(islands[k])},
            [&](std::int64_t iterations) {
              return iterations % asked_after != 0 || proceed(iterations);
            });
      goes_on_ = !end_for(islands[k]).is_stopped;
    }
  }

  /// Lists the islands that have not converged, and improves them by RestGradients or by their
  /// factors, one task each.
  template <class T>
  void improve(const GradientArrays<T>& arrays, const GradientOptions& options) {
    if constexpr (std::is_same_v<T, double>) {
      for (std::size_t i = 0; i < ends_.size(); ++i) {
        const auto island = static_cast<std::int32_t>(i);
        const bool is_begun = ends_[i].iterations >= first_iterations || factors_[i].are_quick();
        const bool is_left =
            !ends_[i].is_converged && is_begun && ends_[i].iterations < options.max_iterations;
        if (!is_left || (!can_follow<T>(island) && !factors_[i].is_possible())) continue;
        improved_.push_back(island);
        (is_large(island) ? improved_large_ : improved_small_).push_back(island);
      }
      parallel_tasks(exec_.threads(), std::ssize(improved_), [&](std::int64_t k) {
        const std::int32_t island = improved_[static_cast<std::size_t>(k)];
        if (!can_follow<T>(island)) {
          return factors_[static_cast<std::size_t>(island)].solve(arrays, begin_of(island));
        }
        const std::int64_t left = options.max_iterations - end_for(island).iterations;
        end_for(island).iterations += rest_.solve(arrays, island, begin_of(island), end_of(island),
                                                  {options.tolerance, left});
      });
    }
  }

  CpuExec& exec_;
  CpuExec shared_;  ///< of large islands; its loops are parts of one time
  RestGradients& rest_;
  Islands start_;
  std::vector<GradientEnd> ends_;
  std::vector<IslandFactors> factors_;
  bool goes_on_ = true;
  Islands small_, large_;
  Islands improved_, improved_small_, improved_large_;  ///< by improve()
};

}  // namespace tetwarp
