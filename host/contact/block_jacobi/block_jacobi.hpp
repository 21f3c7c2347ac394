/// @file block_jacobi.hpp
/// Contacts of bodies that A couples, by an outer block-Jacobi iteration around sweeps.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "host/contact/block_jacobi/residual_estimator.hpp"
#include "kernels/contact/anderson.hpp"
#include "kernels/contact/contact_accelerators.hpp"
#include "kernels/contact/contact_pipeline.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

/// Sweeps of one outer step. One is enough where no two contacts share a body: there is one color.
inline int sweeps_per_step(const ContactOptions& options, const ContactIsland& island) {
  return island.color_end - island.color_begin > 2 ? options.inner_sweeps : 1;
}

/// With D the diagonal blocks of A and q = J v_f + w, one outer step is
///
///     v_f = v - omega D^-1 (A v - b)
///     sweeps solve the contacts in  u = omega J D^-1 J^T r + q
///     v = v_f + omega D^-1 J^T r
///
/// Proximal gradients in the metric D / omega: it converges where omega times the largest
/// eigenvalue of D^-1 A is below 2. That eigenvalue is at most the number of nodes of an element,
/// so that 0.5 suits tetrahedra. Where A couples nothing and omega is 1, one step is exact.
/// Source: Otaduy et al. 2009 (iterative constraint anticipation); relaxation and acceleration
/// (Anderson, or nonlinear conjugate gradients, on v) are ours.
///
/// In float32 it ends where rounding does not let it come closer, too; whoever judges does so in
/// float64.
template <class Exec, class T = double>
class BlockJacobi {
 public:
  template <class U>
  using Vector = typename Exec::template Vector<U>;

  /// What it works with.
  struct Memory {
    Vector<T> impulse, velocity;                          ///< [3 slots]
    Vector<T> body_velocity, before, defect;              ///< [dofs]
    Vector<double> weights;                               ///< the diagonal of A, nearly its metric
    Vector<T> mixed;                                      ///< of accelerators
    Vector<double> double_impulse, double_body_velocity;  ///< for float32

    void resize(Exec& exec, const ContactNumbers<T>& numbers, const ContactIsland& island) {
      const std::int64_t rows = numbers.bodies.offset.size, dofs = numbers.load.size;
      for (Vector<T>* values : {&impulse, &velocity}) exec.resize(*values, rows);
      for (Vector<T>* values : {&body_velocity, &before, &defect}) exec.resize(*values, dofs);
      const std::int64_t size = island.dof_end - island.dof_begin;
      exec.resize(weights, size);
      exec.resize(mixed, AndersonMixer<Exec, T>::columns * size);
      if (std::is_same_v<T, double>) return;
      exec.resize(double_impulse, rows);
      exec.resize(double_body_velocity, dofs);
    }
    ContactState<T> state() {
      return {view_of(impulse), view_of(velocity), view_of(body_velocity), view_of(defect), {}, {}};
    }
  };

  /// @param numbers      of the whole problem, where the executor reads them
  /// @param color_start  on the host
  /// @param judge        has been started
  /// @param memory       kept by the caller
  BlockJacobi(Exec& exec,
              const ContactOptions& options,
              const ContactNumbers<T>& numbers,
              View<const std::int64_t> color_start,
              const ContactIsland& island,
              ResidualEstimator<Exec>& estimator,
              Memory& memory)
      : exec_(exec),
        options_(options),
        estimator_(estimator),
        inner_sweeps_(sweeps_per_step(options, island)),
        memory_((memory.resize(exec, numbers, island), memory)),
        pipeline_(exec, numbers, color_start, island, switches_of(options), memory_.state()),
        now_(view_of(memory_.body_velocity)),
        before_(view_of(memory_.before)) {
    body_relax(exec_, island.block_begin, island.block_end,
               DiagonalBody<T>{numbers.system.dof_start, numbers.diagonal_value,
                               numbers.system.values, island.dof_begin, view_of(memory_.weights)});
  }

  /// Goes on until judged done, out of budget, or far off.
  /// @param most           outer iterations
  /// @param impulse        to start from, [3 slots]
  /// @param body_velocity  to start from, [dofs]
  void solve(std::int64_t most,
             View<const double> impulse,
             View<const double> body_velocity,
             IslandOutcome& outcome) {
    convert(exec_, impulse, view_of(memory_.impulse));
    convert(exec_, body_velocity, now_);
    iterate(most, outcome);
    outcome.contact_updates = outcome.sweeps * pipeline_.island().contact_count();
  }

  bool is_lost() const { return is_lost_; }
  /// Where it has come to, in float64: r, [3 slots].
  View<const double> impulse() {
    return in_double(view_of(memory_.impulse), memory_.double_impulse);
  }
  /// v, [dofs].
  View<const double> body_velocity() { return in_double(now_, memory_.double_body_velocity); }

 private:
  View<const double> in_double(View<const T> values, Vector<double>& wide) {
    if constexpr (std::is_same_v<T, double>) {
      return values;
    } else {
      convert(exec_, values, view_of(wide));
      return view_of(std::as_const(wide));
    }
  }

  void iterate(std::int64_t most, IslandOutcome& outcome) {
    switch (options_.method) {
      case ContactMethod::gauss_seidel:
        outcome.methods = {"outer_jacobi"};
        return iterate<PlainSteps<Exec, T>>(most, outcome);
      case ContactMethod::nonlinear_cg:
        outcome.methods = {"outer_nonlinear_cg"};
        return iterate<ConjugateDirection<Exec, T>>(most, outcome);
      default:
        outcome.methods = {"outer_anderson"};
        return iterate<AndersonMixer<Exec, T>>(most, outcome);
    }
  }

  template <class Accelerator>
  void iterate(std::int64_t most, IslandOutcome& outcome) {
    const View<const double> weights = view_of(std::as_const(memory_.weights));
    Accelerator accelerator(exec_, weights, view_of(memory_.mixed));
    const std::int64_t first = outcome.outer_iterations + 1;
    double start = size_of_velocity();
    while (outcome.outer_iterations < most) {
      std::swap(before_, now_);
      pipeline_.use_body_velocity(now_);
      pipeline_.step_bodies(before_, static_cast<T>(options_.relaxation));
      for (int sweep = 0; sweep < inner_sweeps_; ++sweep) pipeline_.sweep({});
      outcome.sweeps += inner_sweeps_;
      ++outcome.outer_iterations;
      const View<const T> before =
          part_of(before_, pipeline_.island().dof_begin, pipeline_.island().dof_end);
      accelerator.observe(before, pipeline_.body_velocity());
      const bool is_last = outcome.outer_iterations == most;
      const bool is_first = outcome.outer_iterations == first;
      if (!is_last && !is_first && !exec_.is_sync_point(outcome.outer_iterations)) {
        accelerator.advance(before, pipeline_.body_velocity());
        continue;
      }
      const double defect = accelerator.defect();
      if (is_first) {
        start += defect;
        aim_ = options_.tolerance * start;
      }
      is_lost_ = !(defect <= divergence * start);
      if (is_lost_) return;
      const bool is_due = is_last || defect <= aim_ || outcome.outer_iterations >= next_;
      if (is_due && estimate(defect, is_last, outcome) <= 1) return;
      if (std::is_same_v<T, float> && is_as_close_as_float32(defect / start, outcome)) return;
      accelerator.advance(before, pipeline_.body_velocity());
    }
  }

  double size_of_velocity() {
    const SizeBody<T> body = {view_of(std::as_const(memory_.weights)), pipeline_.body_velocity()};
    return std::sqrt(
        exec_.template sum<PlainSums<1>>("contact/mix", 0, body.x.size, body).value[0]);
  }

  /// Whether rounding is, or may be, what keeps the defect from falling.
  bool is_as_close_as_float32(double defect, const IslandOutcome& outcome) {
    constexpr double rounding = 1e-6;
    constexpr std::int64_t patience = 100;
    if (defect < 0.5 * lowest_) {
      lowest_ = defect;
      lowest_at_ = outcome.outer_iterations;
    }
    return defect <= rounding || outcome.outer_iterations - lowest_at_ > patience;
  }

  /// Judging costs as much as 5 to 30 steps: it is done when the defect of the iteration has
  /// dropped as far as the last judgement asked for, at first to the tolerance, and now and then.
  double estimate(double defect, bool is_last, IslandOutcome& outcome) {
    const double excess = estimator_.estimate(impulse(), body_velocity(), is_last, outcome);
    aim_ = 0.9 * defect / excess;
    next_ = 2 * std::max(outcome.outer_iterations, first_check);
    return excess;
  }

  static constexpr std::int64_t first_check = 32;
  static constexpr double divergence = 1e8;  ///< of the velocities: nothing comes back from there

  Exec& exec_;
  const ContactOptions& options_;
  ResidualEstimator<Exec>& estimator_;
  int inner_sweeps_;
  Memory& memory_;
  ContactPipeline<Exec, T> pipeline_;
  View<T> now_, before_;  ///< v, and that of the step before; change places
  double aim_ = 0;
  std::int64_t next_ = 2 * first_check;
  double lowest_ = std::numeric_limits<double>::infinity();
  std::int64_t lowest_at_ = 0;
  bool is_lost_ = false;
};

/// Memory for islands whose blocks A couples, one after the other.
template <class Exec>
struct BlockJacobiMemory {
  EstimatorMemory<Exec> estimator;
  typename BlockJacobi<Exec, double>::Memory fine;
  typename BlockJacobi<Exec, float>::Memory coarse;
  typename Exec::template Vector<double> no_impulse, no_velocity;
};

/// One coupled island by the outer iteration, from impulses or from nothing.
/// @param rounded  the numbers in float32 where the options ask for that; else not read
/// @param guess    [3 slots] of the whole problem, where the executor reads it; empty: none
/// @param judge    of the island, in `memory`; has the best pair in the end
template <class Exec>
void solve_coupled_island(Exec& exec,
                          const ContactOptions& options,
                          const ContactNumbers<double>& numbers,
                          const ContactNumbers<float>& rounded,
                          View<const std::int64_t> color_start,
                          const ContactIsland& island,
                          View<const double> guess,
                          std::int64_t most,
                          ResidualEstimator<Exec>& estimator,
                          BlockJacobiMemory<Exec>& memory,
                          IslandOutcome& outcome) {
  estimator.start(outcome);
  if (outcome.reason == StopReason::converged) return;
  exec.resize(memory.no_impulse, numbers.bodies.offset.size);
  exec.resize(memory.no_velocity, numbers.load.size);
  View<const double> r = view_of(memory.no_impulse), v = view_of(memory.no_velocity);
  if (guess.size > 0) {
    estimator.find_body_velocity(guess);
    r = guess;
    v = estimator.body_velocity();
  }
  if (options.precision == ContactPrecision::float32) {
    BlockJacobi<Exec, float> coarse(exec, options, rounded, color_start, island, estimator,
                                    memory.coarse);
    coarse.solve(most, r, v, outcome);
    if (outcome.reason == StopReason::converged) return;
    if (!coarse.is_lost()) {
      r = coarse.impulse();
      v = coarse.body_velocity();
    }
  }
  BlockJacobi<Exec> block_jacobi(exec, options, numbers, color_start, island, estimator,
                                 memory.fine);
  block_jacobi.solve(most, r, v, outcome);
}

}  // namespace tetwarp
