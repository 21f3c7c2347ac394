/// @file block_jacobi.hpp
/// Contacts of bodies that A couples: a block-Jacobi iteration (outer) around sweeps (inner).
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "host/contact/block_jacobi/coupled_task.hpp"
#include "host/contact/block_jacobi/residual_estimator.hpp"
#include "kernels/contact/anderson.hpp"
#include "kernels/contact/contact_accelerators.hpp"
#include "kernels/contact/contact_pipeline.hpp"
#include "kernels/contact/coupled_iteration.hpp"
#include "kernels/contact/touching_rows.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

/// Sweeps per outer iteration. If no two contacts share a body (one color), one sweep solves them.
inline int sweeps_per_step(const ContactOptions& options, const ContactIsland& island) {
  return island.color_end - island.color_begin > 2 ? options.expert.inner_sweeps : 1;
}

/// The iteration of coupled_iteration.hpp with M^-1 = omega D^-1, D the diagonal blocks of A.
///
/// It is a proximal gradient step in the metric D / omega. It converges if omega times the largest
/// eigenvalue of D^-1 A is below 2. That eigenvalue is at most the number of nodes of an element,
/// so that 0.5 suits tetrahedra. If A couples no blocks and omega is 1, one iteration is exact.
/// Source: Otaduy et al. 2009 (iterative constraint anticipation); relaxation and acceleration
/// (Anderson, or nonlinear conjugate gradients, on v) are ours.
template <class Exec>
class BlockJacobi {
 public:
  template <class U>
  using Vector = typename Exec::template Vector<U>;

  /// Sums that the host reads together.
  struct Sums {
    PlainSums<1> defect;
    PlainSums<2> error;
  };
  struct Memory {
    Vector<double> impulse, velocity;   ///< [3 slots]
    Vector<double> now, image, defect;  ///< [dofs]
    Vector<double> weights;             ///< diagonal of A, for norms of v
    Vector<double> mixed;               ///< columns of the accelerator
    Vector<Sums> sums;

    Memory& resize(Exec& exec, const CoupledTask& task) {
      const std::int64_t rows = task.numbers.bodies.offset.size, dofs = task.numbers.load.size;
      for (Vector<double>* values : {&impulse, &velocity}) exec.make_zeros(*values, rows);
      for (Vector<double>* values : {&now, &image, &defect}) exec.make_zeros(*values, dofs);
      const std::int64_t size = task.island.dof_end - task.island.dof_begin;
      exec.make_zeros(weights, size);
      exec.make_zeros(mixed, AndersonMixer<Exec, double>::columns * size);
      exec.make_zeros(sums, 1);
      return *this;
    }
    ContactState<double> state() {
      return {view_of(impulse), view_of(velocity), view_of(image), view_of(defect), {}, {}};
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
        memory_(memory.resize(exec, task)),
        pipeline_(exec,
                  task.numbers,
                  task.color_start,
                  task.island,
                  switches_of(task.options),
                  memory_.state()),
        now_(view_of(memory_.now)),
        image_(view_of(memory_.image)) {
    const ContactNumbers<double>& numbers = task.numbers;
    body_relax(
        exec_, task.island.block_begin, task.island.block_end,
        DiagonalOp<double>{numbers.system.dof_start, numbers.diagonal_value, numbers.system.values,
                           task.island.dof_begin, view_of(memory_.weights)});
  }

  /// Iterates until the estimated residual is within the tolerance or a limit of the task is
  /// reached.
  /// @param impulse        to start from, [3 slots]
  /// @param body_velocity  to start from, [dofs]
  void solve(View<const double> impulse, View<const double> body_velocity, IslandOutcome& outcome) {
    exec_.copy("contact/mix", impulse, view_of(memory_.impulse));
    exec_.copy("contact/mix", body_velocity, now_);
    outcome_ = &outcome;
    switch (task_.options.method) {
      case ContactMethod::gauss_seidel:
        return iterate<PlainSteps<Exec, double>>("outer_jacobi");
      case ContactMethod::nonlinear_cg:
        return iterate<ConjugateDirection<Exec, double>>("outer_nonlinear_cg");
      default:
        return iterate<AndersonMixer<Exec, double>>("outer_anderson");
    }
  }

  // What iterate_coupled() calls, which says what they do.
  using Next = CoupledControl::Next;
  Exec& exec() { return exec_; }
  View<double> now() const { return of_island(now_); }
  View<double> image() const { return of_island(image_); }
  View<const double> weights() const { return view_of(std::as_const(memory_.weights)); }
  View<double> mixed() const { return view_of(memory_.mixed); }
  /// The error of every fourth iterate; on a device of those where the host reads.
  std::optional<CoupledError> find_error(const CoupledOutcome& progress) {
    pipeline_.use_body_velocity(image_);
    pipeline_.step_bodies(now_, task_.options.expert.relaxation);
    const std::int64_t done = progress.outer_iterations;
    if (done % 4 != 0 || !exec_.is_sync_point(done)) return {};
    Sums* const sums = view_of(memory_.sums).data;
    exec_.sum_to("contact/relax", 0, now().size,
                 MoveSquareOp{of_island(view_of(memory_.defect)), now(), image()}, &sums->defect);
    pipeline_.find_velocities(now_);
    sum_error(pipeline_.impulse(), of_slots(view_of(memory_.velocity)));
    const Sums found = exec_.load(sums);
    return CoupledError::of(found.defect.value[0], found.error.value[0], found.error.value[1]);
  }
  static void keep(double) {}
  double excess(const CoupledOutcome& progress) { return estimate(progress, false); }
  Next limit(const CoupledOutcome&) const {
    return task_.is_over() ? Next::is_stopped : Next::proceeds;
  }
  void solve_contacts(double, CoupledOutcome& progress) {
    const int count = sweeps_per_step(task_.options, task_.island);
    for (int sweep = 0; sweep < count; ++sweep) pipeline_.sweep({});
    progress.sweeps += count;
  }
  void take_image() { std::swap(now_, image_); }

 private:
  template <class T>
  View<T> of_island(View<T> dofs) const {
    return part_of(dofs, task_.island.dof_begin, task_.island.dof_end);
  }
  template <class T>
  View<T> of_slots(View<T> rows) const {
    return part_of(rows, 3 * task_.island.slot_begin, 3 * task_.island.slot_end);
  }
  void sum_error(View<const double> impulse, View<const double> velocity) {
    exec_.sum_to("contact/residual", 0, task_.island.contact_count(),
                 TouchErrorOp{pipeline_.constants(), switches_of(task_.options), impulse, velocity,
                              of_slots(estimator_.free_velocity())},
                 &view_of(memory_.sums).data->error);
  }

  template <class Accelerator>
  void iterate(const char* name) {
    outcome_->methods = {name};
    exec_.make_zeros(memory_.velocity, task_.numbers.bodies.offset.size);  // no impulses
    sum_error(of_slots(View<const double>(view_of(memory_.velocity))),
              of_slots(estimator_.free_velocity()));
    const double alone = exec_.load(view_of(memory_.sums).data).error.value[0];
    const CoupledControl control({.tolerance = task_.options.tolerance,
                                  .natural_alone = alone,
                                  .patience = std::numeric_limits<std::int64_t>::max()});
    CoupledOutcome progress;
    progress.outer_iterations = outcome_->outer_iterations;
    progress.sweeps = outcome_->sweeps;
    const Next end = iterate_coupled<Accelerator>(*this, control, task_.max_iterations, progress);
    if (end != Next::converges) estimate(progress, true);
    outcome_->outer_iterations = progress.outer_iterations;
    outcome_->sweeps = progress.sweeps;
    outcome_->contact_updates = progress.sweeps * task_.island.contact_count();
  }

  /// An estimate costs as much as 5 to 30 iterations.
  double estimate(const CoupledOutcome& progress, bool is_last) {
    outcome_->sweeps = progress.sweeps;
    return estimator_.estimate(view_of(std::as_const(memory_.impulse)), now_, is_last, *outcome_);
  }

  Exec& exec_;
  const CoupledTask& task_;
  ResidualEstimator<Exec>& estimator_;
  Memory& memory_;
  ContactPipeline<Exec, double> pipeline_;
  View<double> now_, image_;  ///< v and v', swapped in each iteration
  IslandOutcome* outcome_ = nullptr;
};

/// Memory of solve_coupled_island(), kept from island to island.
template <class Exec>
struct BlockJacobiMemory {
  EstimatorMemory<Exec> estimator;
  typename BlockJacobi<Exec>::Memory iteration;
  typename Exec::template Vector<double> no_impulse, no_velocity;
};

/// Solves one coupled island from task.guess.
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
  BlockJacobi<Exec>(exec, task, estimator, memory.iteration).solve(r, v, outcome);
  return estimator.best();
}

}  // namespace tetwarp
