/// @file residual_estimator.hpp
/// Residual of impulses on an island whose blocks A couples, without a factorization of A.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "host/contact/block_jacobi/coupled_system.hpp"
#include "host/contact/block_jacobi/coupled_task.hpp"
#include "host/contact/sweeps/run.hpp"
#include "kernels/contact/contact_bound.hpp"
#include "kernels/contact/contact_residual_estimate.hpp"
#include "kernels/contact/convergence_test.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

template <class Exec>
struct EstimatorMemory {
  using Vector = typename Exec::template Vector<double>;

  CoupledSystemMemory<Exec> system;
  typename Exec::template Vector<ContactConstants<double>> constants;  ///< [slots]
  Vector body_velocity, defect, best_body_velocity;                    ///< [dofs]
  Vector velocity, consistent_velocity, free_velocity, previous_velocity, impulse,
      best_impulse;  ///< [3 slots]
};

/// Estimates the residual of impulses on one coupled island from the velocities that they cause
/// (A v = b + J^T r, solved by conjugate gradients), and keeps the best pair.
///
/// eta weighs each contact by its own block of J A^-1 J^T, which only a factorization yields, so
/// eta is bounded; see ResidualBoundOp. The FCLIB error has no weights; its accuracy is that of
/// the velocities.
template <class Exec>
class ResidualEstimator {
 public:
  using Vector = typename Exec::template Vector<double>;

  /// @param task    kept by the caller
  /// @param memory  kept by the caller
  ResidualEstimator(Exec& exec, const CoupledTask& task, EstimatorMemory<Exec>& memory)
      : exec_(exec),
        task_(task),
        options_(task.options),
        numbers_(task.numbers),
        island_(task.island),
        system_(exec, task.numbers, task.island, memory.system),
        memory_(memory) {
    for (Vector* dofs : {&memory.body_velocity, &memory.defect, &memory.best_body_velocity}) {
      exec.make_zeros(*dofs, numbers_.load.size);
    }
    for (Vector* rows : {&memory.velocity, &memory.consistent_velocity, &memory.free_velocity,
                         &memory.previous_velocity, &memory.impulse, &memory.best_impulse}) {
      exec.make_zeros(*rows, numbers_.bodies.offset.size);
    }
    exec.make_zeros(memory.constants, numbers_.constants.size);
    exec.for_each("contact/setup", numbers_.constants.size,
                  LowerBlocksOp{numbers_.bodies.pairs.pair_start, numbers_.constants,
                                options_.expert.relaxation, view_of(memory.constants)});
  }

  /// Solves for the velocities without impulses, which set the scale of the residual. If they
  /// satisfy the law of every contact, they are the solution: outcome.reason becomes `converged`.
  void start(IslandOutcome& outcome) {
    clear_impulses();
    const bool is_at_rest = is_zero(numbers_.load);
    if (is_at_rest) {
      // A zero load gives no estimate of the eigenvalues of A; unit impulses on all contacts do.
      exec_.for_each("contact/setup", island_.contact_count(),
                     FromIndex<UnitPushOp>{{view_of(memory_.impulse)}, island_.slot_begin});
      find_defect();
    }
    const LinearProgress progress =
        solve_system([](const LinearProgress& now) { return is_within(0.1, now); });
    find_velocity(memory_.velocity);
    contact_share_ = progress.moved > 0 ? distance(numbers_.bodies.offset) / progress.moved : 0;
    if (is_at_rest) clear_impulses();
    outcome.reason = StopReason::exhausted;
    find_free(outcome);
    if (criterion_.error_of(outcome.free) == 0) {  // no scale for a relative residual
      solve_system([&](const LinearProgress&) { return is_balanced(); });
      find_free(outcome);
      if (criterion_.error_of(outcome.free) == 0 && is_balanced()) {
        outcome.reason = StopReason::converged;
        outcome.events.push_back({outcome.sweeps, 0.0});
      }
    }
    outcome.sums = outcome.free;
    keep_best();
  }

  /// Solves for the body velocities of the impulses, starting from zero, to half the digits of the
  /// tolerance: more digits would cost more than the outer iterations that they save.
  /// @param impulse  [3 slots]
  void find_body_velocity(View<const double> impulse) {
    copy(impulse, memory_.impulse);
    fill(exec_, view_of(memory_.body_velocity), 0.0);
    find_defect();
    const double share = std::sqrt(options_.tolerance);
    solve_system([&](const LinearProgress& now) { return is_within(share, now); });
  }

  /// Estimates the residual of impulses and keeps them if they are the best so far.
  /// @param impulse        [3 slots]
  /// @param body_velocity  [dofs], close to those of the impulses; with these velocities the
  ///                       contacts satisfy their law
  /// @param is_last        false: may return early with a rough value above 1
  /// @return  at most 1 if converged: the larger of residual and imbalance, over the tolerance
  double estimate(View<const double> impulse,
                  View<const double> body_velocity,
                  bool is_last,
                  IslandOutcome& outcome) {
    copy(impulse, memory_.impulse);
    copy(body_velocity, memory_.body_velocity);
    find_defect();
    find_velocity(memory_.consistent_velocity);
    copy(view_of(std::as_const(memory_.consistent_velocity)), memory_.previous_velocity);
    ContactSums sums = bounded_sums();
    // `uncertainty` bounds what the remaining error of v can add to `excess`.
    double excess = criterion_.excess_of(sums), uncertainty = 0, moved = 0;
    solve_system([&](const LinearProgress& progress) {
      sums = bounded_sums();
      excess = criterion_.excess_of(sums);
      if (options_.measure == ContactMeasure::fclib) return is_within(0.1, progress);
      // Assumes that the remaining error, per its norm in A, changes the contact velocities at most
      // as much as the last steps or the free motion did.
      const double step = std::sqrt(square_of(progress.moved) - square_of(moved));
      const double apart = distance(view_of(std::as_const(memory_.previous_velocity)));
      const double share = std::max(step > 0 ? apart / step : 0, contact_share_);
      uncertainty = share * progress.left / criterion_.allowed_at(sums);
      copy(view_of(std::as_const(memory_.velocity)), memory_.previous_velocity);
      moved = progress.moved;
      // Above 0.8 the excess soon passes 1, or falls below it only after many steps.
      const bool is_bad = !is_last && excess > 0.8;
      const bool is_good = excess + uncertainty <= 1 && is_balanced();
      return is_bad || is_good || uncertainty <= settled * excess;
    });
    const bool is_settled = is_last || excess + uncertainty <= 1 || uncertainty <= settled * excess;
    excess += is_settled ? uncertainty : std::min(uncertainty, excess);
    if (is_settled) {
      sums.eta = square_of(std::sqrt(sums.eta) + uncertainty * criterion_.allowed_at(sums));
    }
    excess = std::max(excess, imbalance() / options_.tolerance);
    outcome.events.push_back({outcome.sweeps, criterion_.error_of(sums)});
    if (is_settled && excess < best_excess_) {
      best_excess_ = excess;
      keep_best();
      outcome.sums = sums;
      outcome.reason = excess <= 1 ? StopReason::converged : StopReason::exhausted;
    }
    return excess;
  }

  /// v of the impulses of the last call, [dofs].
  View<const double> body_velocity() const { return view_of(memory_.body_velocity); }

  /// u without impulses, [3 slots].
  View<const double> free_velocity() const { return view_of(std::as_const(memory_.free_velocity)); }
  /// The pair with the smallest residual so far; views of `memory`.
  CoupledSolution best() const {
    return {view_of(std::as_const(memory_.best_impulse)),
            view_of(std::as_const(memory_.best_body_velocity))};
  }

 private:
  static constexpr double margin = 0.8;   ///< share of the tolerance; the rest is for errors of v
  static constexpr double settled = 0.1;  ///< uncertainty per excess at which the solve may stop

  /// |A v - J^T r - b| relative to the larger of |b| and |J^T r|.
  double imbalance() const {
    const PlainSums<3> sums = exec_.template sum<PlainSums<3>>(
        "contact/residual", island_.block_begin, island_.block_end,
        BalanceOp{numbers_.block_contacts, numbers_.system.dof_start, numbers_.bodies.jacobian,
                  numbers_.load, view_of(memory_.impulse), view_of(memory_.defect)});
    const double scale = std::max(sums.value[1], sums.value[2]);
    return std::sqrt(sums.value[0] / std::max(scale, std::numeric_limits<double>::min()));
  }

  bool is_balanced() const { return imbalance() <= options_.tolerance; }

  /// Residual of zero impulses at the current velocities, and the stop criterion that follows.
  void find_free(IslandOutcome& outcome) {
    find_velocity(memory_.free_velocity);
    const View<const double> free = view_of(std::as_const(memory_.free_velocity));
    outcome.free =
        exec_.template sum<ContactSums>("contact/residual", island_.slot_begin, island_.slot_end,
                                        FreeResidualBoundOp{natural(free)});
    outcome.free_square =
        exec_
            .template sum<PlainSums<1>>("contact/residual", 3 * island_.slot_begin,
                                        3 * island_.slot_end, SquareOp<double>{free})
            .value[0];
    const double scale =
        options_.measure == ContactMeasure::eta ? outcome.free.eta : outcome.free_square;
    const double tolerance = margin * options_.tolerance;
    criterion_ = {options_.measure, tolerance, tolerance * std::sqrt(scale)};
  }

  /// Sets the defect to b + J^T r - A v.
  void find_defect() {
    body_relax(
        exec_, island_.block_begin, island_.block_end,
        BodyDefectOp<double>{numbers_.system, numbers_.block_contacts, numbers_.bodies.jacobian,
                             numbers_.load, view_of(memory_.impulse),
                             view_of(memory_.body_velocity), view_of(memory_.defect)});
  }

  /// Continues the solve of A v = b + J^T r; see CoupledSystem::solve().
  template <class Enough>
  LinearProgress solve_system(const Enough& is_enough) {
    return system_.solve(
        view_of(memory_.body_velocity), view_of(memory_.defect),
        [&](const LinearProgress& progress) { return is_enough(progress) || task_.is_over(); });
  }

  /// u = J v + w.
  void find_velocity(Vector& velocity) {
    using Body = ContactVelocityOp<BodiesView<double>, double>;
    const Body body{numbers_.bodies, view_of(memory_.body_velocity).data, view_of(velocity)};
    exec_.for_each("contact/residual", island_.contact_count(),
                   FromIndex<Body>{body, island_.slot_begin});
  }

  /// Distance of `velocity` from the current contact velocities in the weights of eta. The norm of
  /// A does not bound it: springs much stiffer than their body magnify small errors.
  double distance(View<const double> velocity) const {
    return std::sqrt(
        exec_
            .template sum<PlainSums<1>>("contact/residual", island_.slot_begin, island_.slot_end,
                                        DistanceOp{view_of(memory_.constants),
                                                   view_of(memory_.velocity).data, velocity.data})
            .value[0]);
  }

  /// Bounds of the residual of the current impulses and body velocities.
  ContactSums bounded_sums() {
    find_velocity(memory_.velocity);
    ContactSums sums = exec_.template sum<ContactSums>(
        "contact/residual", island_.slot_begin, island_.slot_end,
        ResidualBoundOp{natural(view_of(std::as_const(memory_.velocity))),
                        view_of(std::as_const(memory_.consistent_velocity))});
    // The share of the diagonal blocks of A; the responses have the relaxation as a factor.
    sums.magnitude =
        exec_
            .template sum<PlainSums<1>>(
                "contact/residual", island_.block_begin, island_.block_end,
                BodyMagnitudeOp<double>{numbers_.block_contacts, numbers_.system.dof_start,
                                        numbers_.bodies.jacobian, numbers_.bodies.response,
                                        view_of(std::as_const(memory_.impulse))})
            .value[0] /
        options_.expert.relaxation;
    return sums;
  }

  static bool is_within(double share, const LinearProgress& progress) {
    return progress.left <= share * progress.moved;
  }

  /// The natural map of the current impulses.
  ContactResidualOp<double> natural(View<const double> velocity) const {
    return {view_of(memory_.constants), switches_of(options_), view_of(memory_.impulse), velocity,
            view_of(memory_.free_velocity)};
  }

  void copy(View<const double> from, Vector& to) { exec_.copy("contact/mix", from, view_of(to)); }

  void keep_best() {
    copy(view_of(std::as_const(memory_.impulse)), memory_.best_impulse);
    copy(view_of(std::as_const(memory_.body_velocity)), memory_.best_body_velocity);
  }

  /// Impulses and velocities become zero; the defect is the load.
  void clear_impulses() {
    fill(exec_, view_of(memory_.impulse), 0.0);
    fill(exec_, view_of(memory_.body_velocity), 0.0);
    copy(numbers_.load, memory_.defect);
  }

  bool is_zero(View<const double> dofs) const {
    return exec_
               .template sum<PlainSums<1>>("contact/setup", island_.dof_begin, island_.dof_end,
                                           NonzeroOp<double>{dofs})
               .value[0] == 0;
  }

  Exec& exec_;
  const CoupledTask& task_;
  const ContactOptions& options_;
  const ContactNumbers<double>& numbers_;
  const ContactIsland& island_;
  CoupledSystem<Exec> system_;
  EstimatorMemory<Exec>& memory_;
  StopCriterion criterion_;
  double best_excess_ = std::numeric_limits<double>::infinity();
  double contact_share_ = 0;  ///< |J v| in the weights of eta per |v| in the norm of A, free motion
};

}  // namespace tetwarp
