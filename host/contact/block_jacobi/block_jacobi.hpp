/// @file block_jacobi.hpp
/// Contacts of bodies that A couples: a block-Jacobi iteration (outer) around sweeps (inner).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "host/contact/block_jacobi/coupled_task.hpp"
#include "host/contact/block_jacobi/residual_estimator.hpp"
#include "kernels/contact/anderson.hpp"
#include "kernels/contact/contact_accelerators.hpp"
#include "kernels/contact/contact_pipeline.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

/// Sweeps per outer iteration. If no two contacts share a body (one color), one sweep solves them.
inline int sweeps_per_step(const ContactOptions& options, const ContactIsland& island) {
  return island.color_end - island.color_begin > 2 ? options.expert.inner_sweeps : 1;
}

/// With D the diagonal blocks of A and q = J v_f + w, one outer iteration is
///
///     v_f = v - omega D^-1 (A v - b)
///     sweeps solve the contacts in  u = omega J D^-1 J^T r + q
///     v = v_f + omega D^-1 J^T r
///
/// This is a proximal gradient step in the metric D / omega. It converges if omega times the
/// largest eigenvalue of D^-1 A is below 2. That eigenvalue is at most the number of nodes of an
/// element, so that 0.5 suits tetrahedra. If A couples no blocks and omega is 1, one iteration is
/// exact.
/// Source: Otaduy et al. 2009 (iterative constraint anticipation); relaxation and acceleration
/// (Anderson, or nonlinear conjugate gradients, on v) are ours.
///
/// In float32 it also stops when rounding prevents progress; residuals are estimated in float64.
template <class Exec, class T = double>
class BlockJacobi {
 public:
  template <class U>
  using Vector = typename Exec::template Vector<U>;

  struct Memory {
    Vector<T> impulse, velocity;                          ///< [3 slots]
    Vector<T> body_velocity, before, defect;              ///< [dofs]
    Vector<double> weights;                               ///< diagonal of A, for norms of v
    Vector<T> mixed;                                      ///< columns of the accelerator
    Vector<double> double_impulse, double_body_velocity;  ///< results of float32 in float64

    Memory& resize(Exec& exec, const CoupledTask& task) {
      const std::int64_t rows = task.numbers.bodies.offset.size, dofs = task.numbers.load.size;
      for (Vector<T>* values : {&impulse, &velocity}) exec.make_zeros(*values, rows);
      for (Vector<T>* values : {&body_velocity, &before, &defect}) exec.make_zeros(*values, dofs);
      const std::int64_t size = task.island.dof_end - task.island.dof_begin;
      exec.make_zeros(weights, size);
      exec.make_zeros(mixed, AndersonMixer<Exec, T>::columns * size);
      if (std::is_same_v<T, double>) return *this;
      exec.make_zeros(double_impulse, rows);
      exec.make_zeros(double_body_velocity, dofs);
      return *this;
    }
    ContactState<T> state() {
      return {view_of(impulse), view_of(velocity), view_of(body_velocity), view_of(defect), {}, {}};
    }
  };

  /// @param task       kept by the caller
  /// @param estimator  of the same task; start() has been called
  /// @param memory     kept by the caller
  BlockJacobi(Exec& exec,
              const CoupledTask& task,
              ResidualEstimator<Exec>& estimator,
              Memory& memory)
      : exec_(exec),
        task_(task),
        estimator_(estimator),
        inner_sweeps_(sweeps_per_step(task.options, task.island)),
        memory_(memory.resize(exec, task)),
        pipeline_(exec,
                  task.numbers_in<T>(),
                  task.color_start,
                  task.island,
                  switches_of(task.options),
                  memory_.state()),
        now_(view_of(memory_.body_velocity)),
        before_(view_of(memory_.before)) {
    const ContactNumbers<T>& numbers = task.numbers_in<T>();
    body_relax(
        exec_, task.island.block_begin, task.island.block_end,
        DiagonalOp<T>{numbers.system.dof_start, numbers.diagonal_value, numbers.system.values,
                      task.island.dof_begin, view_of(memory_.weights)});
  }

  /// Iterates until the estimated residual is within the tolerance, the iteration diverges, or
  /// task.max_iterations are done.
  /// @param impulse        to start from, [3 slots]
  /// @param body_velocity  to start from, [dofs]
  void solve(View<const double> impulse, View<const double> body_velocity, IslandOutcome& outcome) {
    convert(exec_, impulse, view_of(memory_.impulse));
    convert(exec_, body_velocity, now_);
    iterate(outcome);
    outcome.contact_updates = outcome.sweeps * task_.island.contact_count();
  }

  bool has_diverged() const { return has_diverged_; }
  /// r of the last iteration in float64, [3 slots].
  View<const double> impulse() {
    return in_double(view_of(memory_.impulse), memory_.double_impulse);
  }
  /// v of the last iteration in float64, [dofs].
  View<const double> body_velocity() { return in_double(now_, memory_.double_body_velocity); }

 private:
  View<const double> in_double(View<const T> values, Vector<double>& converted) {
    if constexpr (std::is_same_v<T, double>) {
      return values;
    } else {
      convert(exec_, values, view_of(converted));
      return view_of(std::as_const(converted));
    }
  }

  void iterate(IslandOutcome& outcome) {
    switch (task_.options.method) {
      case ContactMethod::gauss_seidel:
        outcome.methods = {"outer_jacobi"};
        return iterate<PlainSteps<Exec, T>>(outcome);
      case ContactMethod::nonlinear_cg:
        outcome.methods = {"outer_nonlinear_cg"};
        return iterate<ConjugateDirection<Exec, T>>(outcome);
      default:
        outcome.methods = {"outer_anderson"};
        return iterate<AndersonMixer<Exec, T>>(outcome);
    }
  }

  template <class Accelerator>
  void iterate(IslandOutcome& outcome) {
    const View<const double> weights = view_of(std::as_const(memory_.weights));
    Accelerator accelerator(exec_, weights, view_of(memory_.mixed));
    const std::int64_t first = outcome.outer_iterations + 1;
    double start = norm_of_velocity();
    while (outcome.outer_iterations < task_.max_iterations) {
      std::swap(before_, now_);
      pipeline_.use_body_velocity(now_);
      pipeline_.step_bodies(before_, static_cast<T>(task_.options.expert.relaxation));
      for (int sweep = 0; sweep < inner_sweeps_; ++sweep) pipeline_.sweep({});
      outcome.sweeps += inner_sweeps_;
      ++outcome.outer_iterations;
      const View<const T> before = part_of(before_, task_.island.dof_begin, task_.island.dof_end);
      accelerator.observe(before, pipeline_.body_velocity());
      const bool is_over = task_.is_over();
      const bool is_last = is_over || outcome.outer_iterations == task_.max_iterations;
      const bool is_first = outcome.outer_iterations == first;
      if (!is_last && !is_first && !exec_.is_sync_point(outcome.outer_iterations)) {
        accelerator.advance(before, pipeline_.body_velocity());
        continue;
      }
      const double defect = accelerator.defect();
      if (is_first) {
        start += defect;
        estimate_below_ = task_.options.tolerance * start;
      }
      has_diverged_ = !(defect <= divergence * start);
      if (has_diverged_) return;
      const bool is_due =
          is_last || defect <= estimate_below_ || outcome.outer_iterations >= estimate_at_;
      if (is_due && estimate(defect, is_last, outcome) <= 1) return;
      if (is_over) return;
      if (std::is_same_v<T, float> && is_at_rounding_limit(defect / start, outcome)) return;
      accelerator.advance(before, pipeline_.body_velocity());
    }
  }

  double norm_of_velocity() {
    const SizeOp<T> body = {view_of(std::as_const(memory_.weights)), pipeline_.body_velocity()};
    return std::sqrt(
        exec_.template sum<PlainSums<1>>("contact/mix", 0, body.x.size, body).value[0]);
  }

  /// Whether the defect is at the rounding error of float32, or has not halved for long.
  bool is_at_rounding_limit(double defect, const IslandOutcome& outcome) {
    constexpr double rounding = 1e-6;
    constexpr std::int64_t patience = 100;
    if (defect < 0.5 * lowest_) {
      lowest_ = defect;
      lowest_at_ = outcome.outer_iterations;
    }
    return defect <= rounding || outcome.outer_iterations - lowest_at_ > patience;
  }

  /// An estimate costs as much as 5 to 30 iterations. It is made when the defect of the iteration
  /// has dropped to what the last estimate suggests (at first to the tolerance), and whenever the
  /// number of iterations has doubled.
  double estimate(double defect, bool is_last, IslandOutcome& outcome) {
    const double excess = estimator_.estimate(impulse(), body_velocity(), is_last, outcome);
    estimate_below_ = 0.9 * defect / excess;
    estimate_at_ = 2 * std::max(outcome.outer_iterations, first_check);
    return excess;
  }

  static constexpr std::int64_t first_check = 32;
  static constexpr double divergence = 1e8;  ///< growth of the defect at which the iteration ends

  Exec& exec_;
  const CoupledTask& task_;
  ResidualEstimator<Exec>& estimator_;
  int inner_sweeps_;
  Memory& memory_;
  ContactPipeline<Exec, T> pipeline_;
  View<T> now_, before_;       ///< v of this iteration and of the one before; swapped each time
  double estimate_below_ = 0;  ///< defect at which the next estimate is due
  std::int64_t estimate_at_ = 2 * first_check;  ///< iteration at which it is due at the latest
  double lowest_ = std::numeric_limits<double>::infinity();
  std::int64_t lowest_at_ = 0;
  bool has_diverged_ = false;
};

/// Memory of solve_coupled_island(), kept from island to island.
template <class Exec>
struct BlockJacobiMemory {
  EstimatorMemory<Exec> estimator;
  typename BlockJacobi<Exec, double>::Memory fine;
  typename BlockJacobi<Exec, float>::Memory coarse;
  typename Exec::template Vector<double> no_impulse, no_velocity;
};

/// Solves one coupled island from task.guess. With options.precision float32 it iterates in float32
/// first and finishes in float64.
/// @param outcome  out: reason is `converged` if the best pair is within the tolerance
/// @return  the best pair; views of `memory`
template <class Exec>
CoupledSolution solve_coupled_island(Exec& exec,
                                     const CoupledTask& task,
                                     BlockJacobiMemory<Exec>& memory,
                                     IslandOutcome& outcome) {
  ResidualEstimator<Exec> estimator(exec, task, memory.estimator);
  estimator.start(outcome);
  if (outcome.reason == StopReason::converged) return estimator.best();
  exec.make_zeros(memory.no_impulse, task.numbers.bodies.offset.size);
  exec.make_zeros(memory.no_velocity, task.numbers.load.size);
  View<const double> r = view_of(memory.no_impulse), v = view_of(memory.no_velocity);
  if (task.guess.size > 0) {
    estimator.find_body_velocity(task.guess);
    r = task.guess;
    v = estimator.body_velocity();
  }
  if (task.options.precision == ContactPrecision::float32) {
    BlockJacobi<Exec, float> coarse(exec, task, estimator, memory.coarse);
    coarse.solve(r, v, outcome);
    if (outcome.reason == StopReason::converged) return estimator.best();
    if (!coarse.has_diverged()) {
      r = coarse.impulse();
      v = coarse.body_velocity();
    }
  }
  BlockJacobi<Exec>(exec, task, estimator, memory.fine).solve(r, v, outcome);
  return estimator.best();
}

}  // namespace tetwarp
