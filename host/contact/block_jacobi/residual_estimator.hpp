/// @file coupled.hpp
/// How far impulses on bodies that A couples are from a solution, without a factor of A.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "host/contact/block_jacobi/coupled_system.hpp"
#include "host/contact/sweeps/run.hpp"
#include "kernels/contact/contact_bound.hpp"
#include "kernels/contact/contact_residual_estimate.hpp"
#include "kernels/contact/convergence_test.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

/// What a judge works with.
template <class Exec>
struct EstimatorMemory {
  using Vector = typename Exec::template Vector<double>;

  CoupledSystemMemory<Exec> linear;
  typename Exec::template Vector<ContactConstants<double>> constants;                ///< [slots]
  Vector body_velocity, rest, best_body_velocity;                                    ///< [dofs]
  Vector velocity, consistent_velocity, free_velocity, seen, impulse, best_impulse;  ///< [3 slots]
};

/// Judges the impulses of one coupled island by the velocities they cause, A v = b + J^T r solved
/// by conjugate gradients, and keeps the best pair.
///
/// eta weighs each contact by its own block of J A^-1 J^T, which only a factorization yields, so
/// eta is bounded; see ResidualBoundBody. The measure of FCLIB has no weights and is as exact as
/// the velocities.
template <class Exec>
class ResidualEstimator {
 public:
  using Vector = typename Exec::template Vector<double>;

  /// @param memory  kept by the caller
  ResidualEstimator(Exec& exec,
                    const ContactOptions& options,
                    const ContactNumbers<double>& numbers,
                    const ContactIsland& island,
                    EstimatorMemory<Exec>& memory)
      : exec_(exec),
        options_(options),
        numbers_(numbers),
        island_(island),
        linear_(exec, numbers, island, memory.linear),
        constants_(memory.constants),
        body_velocity_(memory.body_velocity),
        rest_(memory.rest),
        best_body_velocity_(memory.best_body_velocity),
        velocity_(memory.velocity),
        consistent_velocity_(memory.consistent_velocity),
        free_velocity_(memory.free_velocity),
        seen_(memory.seen),
        impulse_(memory.impulse),
        best_impulse_(memory.best_impulse) {
    for (Vector* dofs : {&body_velocity_, &rest_, &best_body_velocity_}) {
      exec.resize(*dofs, numbers.load.size);
    }
    for (Vector* rows :
         {&velocity_, &consistent_velocity_, &free_velocity_, &seen_, &impulse_, &best_impulse_}) {
      exec.resize(*rows, numbers.bodies.offset.size);
    }
    exec.resize(constants_, numbers.constants.size);
    exec.for_each("contact/setup", numbers.constants.size,
                  LowerBlocksBody{numbers.bodies.pairs.pair_start, numbers.constants,
                                  options.relaxation, view_of(constants_)});
  }

  /// The velocities without impulses and the scale they set. Where they break no contact's law,
  /// that is the solution: the outcome has converged.
  void start(IslandOutcome& outcome) {
    be_without_impulses();
    const bool is_still = is_zero(numbers_.load);
    if (is_still) {  // nothing would be learned of A; a push on every contact shows it
      exec_.for_each("contact/setup", island_.contact_count(),
                     FromContact<UnitPushBody>{{view_of(impulse_)}, island_.slot_begin});
      find_rest();
    }
    const LinearProgress progress =
        linear_.solve(view_of(body_velocity_), view_of(rest_),
                      [](const LinearProgress& now) { return is_within(0.1, now); });
    find_velocity(velocity_);
    seen_share_ = progress.moved > 0 ? distance(numbers_.bodies.offset) / progress.moved : 0;
    if (is_still) be_without_impulses();
    outcome.reason = StopReason::exhausted;
    find_free(outcome);
    if (criterion_.error_of(outcome.free) ==
        0) {  // a scale of zero: nothing else could be judged by it
      linear_.solve(view_of(body_velocity_), view_of(rest_),
                    [&](const LinearProgress&) { return is_balanced(); });
      find_free(outcome);
      if (criterion_.error_of(outcome.free) == 0 && is_balanced()) {
        outcome.reason = StopReason::converged;
        outcome.events.push_back({outcome.sweeps, 0.0});
      }
    }
    outcome.sums = outcome.free;
    keep_best();
  }

  /// The velocities that impulses cause, from nothing, to half the digits of the tolerance: more
  /// would cost more than the outer steps that they save; see body_velocity().
  /// @param impulse  [3 slots]
  void find_body_velocity(View<const double> impulse) {
    copy(impulse, impulse_);
    fill(exec_, view_of(body_velocity_), 0.0);
    find_rest();
    const double share = std::sqrt(options_.tolerance);
    linear_.solve(view_of(body_velocity_), view_of(rest_),
                  [&](const LinearProgress& now) { return is_within(share, now); });
  }

  /// Judges impulses and keeps them if they are the best so far.
  /// @param impulse        [3 slots]
  /// @param body_velocity  [dofs], close to the velocities that the impulses cause; with these the
  ///                       contacts obey their law
  /// @param is_last        false: impulses far from a solution are told so early
  /// @returns  at most 1 when done: residual and imbalance over the tolerance
  double estimate(View<const double> impulse,
                  View<const double> body_velocity,
                  bool is_last,
                  IslandOutcome& outcome) {
    copy(impulse, impulse_);
    copy(body_velocity, body_velocity_);
    find_rest();
    find_velocity(consistent_velocity_);
    copy(view_of(std::as_const(consistent_velocity_)), seen_);
    ContactSums sums = bounded_sums();
    double excess = criterion_.excess_of(sums), doubt = 0, moved = 0;
    linear_.solve(view_of(body_velocity_), view_of(rest_), [&](const LinearProgress& progress) {
      sums = bounded_sums();
      excess = criterion_.excess_of(sums);
      if (options_.measure == ContactMeasure::fclib) return is_within(0.1, progress);
      // What is left moves the contacts as much as the free motion did, or the last steps.
      const double step = std::sqrt(square_of(progress.moved) - square_of(moved));
      const double apart = distance(view_of(std::as_const(seen_)));
      const double share = std::max(step > 0 ? apart / step : 0, seen_share_);
      doubt = share * progress.left / criterion_.allowed_at(sums);
      copy(view_of(std::as_const(velocity_)), seen_);
      moved = progress.moved;
      const bool is_bad = !is_last && excess > 0.8;  // soon over 1, or only after many steps below
      const bool is_good = excess + doubt <= 1 && is_balanced();
      return is_bad || is_good || doubt <= settled * excess;
    });
    const bool is_settled = is_last || excess + doubt <= 1 || doubt <= settled * excess;
    excess += is_settled ? doubt : std::min(doubt, excess);
    if (is_settled) {
      sums.eta = square_of(std::sqrt(sums.eta) + doubt * criterion_.allowed_at(sums));
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

  /// v of the impulses judged last, [dofs].
  View<const double> body_velocity() const { return view_of(body_velocity_); }

  /// The best pair judged: r, [3 slots], and v, [dofs], of the whole problem; set in the island.
  View<const double> best_impulse() const { return view_of(best_impulse_); }
  View<const double> best_body_velocity() const { return view_of(best_body_velocity_); }

 private:
  static constexpr double margin = 0.8;   ///< of the tolerance: velocities have errors, too
  static constexpr double settled = 0.1;  ///< doubt that leaves an excess worth its name

  /// |A v - J^T r - b| relative to the larger of |b| and |J^T r|.
  double imbalance() const {
    const PlainSums<3> sums = exec_.template sum<PlainSums<3>>(
        "contact/residual", island_.block_begin, island_.block_end,
        BalanceBody{numbers_.block_contacts, numbers_.system.dof_start, numbers_.bodies.jacobian,
                    numbers_.load, view_of(impulse_), view_of(rest_)});
    const double scale = std::max(sums.value[1], sums.value[2]);
    return std::sqrt(sums.value[0] / std::max(scale, std::numeric_limits<double>::min()));
  }

  bool is_balanced() const { return imbalance() <= options_.tolerance; }

  /// What the velocities at hand, those without impulses, leave to the contacts.
  void find_free(IslandOutcome& outcome) {
    find_velocity(free_velocity_);
    outcome.free =
        exec_.template sum<ContactSums>("contact/residual", island_.slot_begin, island_.slot_end,
                                        FreeResidualBoundBody{natural(view_of(free_velocity_))});
    outcome.free_square = exec_
                              .template sum<PlainSums<1>>(
                                  "contact/residual", 3 * island_.slot_begin, 3 * island_.slot_end,
                                  SquareBody<double>{view_of(std::as_const(free_velocity_))})
                              .value[0];
    const double scale =
        options_.measure == ContactMeasure::eta ? outcome.free.eta : outcome.free_square;
    const double tolerance = margin * options_.tolerance;
    criterion_ = {options_.measure, tolerance, tolerance * std::sqrt(scale)};
  }

  /// b + J^T r - A v.
  void find_rest() {
    body_relax(exec_, island_.block_begin, island_.block_end,
               BodyDefectBody<double>{numbers_.system, numbers_.block_contacts,
                                      numbers_.bodies.jacobian, numbers_.load, view_of(impulse_),
                                      view_of(body_velocity_), view_of(rest_)});
  }

  /// u = J v + w.
  void find_velocity(Vector& velocity) {
    using Body = ContactVelocityBody<BodiesView<double>, double>;
    const Body body{numbers_.bodies, view_of(body_velocity_).data, view_of(velocity)};
    exec_.for_each("contact/residual", island_.contact_count(),
                   FromContact<Body>{body, island_.slot_begin});
  }

  /// From other velocities to those at hand, in the weights of eta: springs much stiffer than the
  /// body they hold feel errors that the norm of A does not.
  double distance(View<const double> velocity) const {
    return std::sqrt(
        exec_
            .template sum<PlainSums<1>>(
                "contact/residual", island_.slot_begin, island_.slot_end,
                DistanceBody{view_of(constants_), view_of(velocity_).data, velocity.data})
            .value[0]);
  }

  /// Of the impulses and the velocities of the bodies at hand, against the consistent velocities.
  ContactSums bounded_sums() {
    find_velocity(velocity_);
    return exec_.template sum<ContactSums>(
        "contact/residual", island_.slot_begin, island_.slot_end,
        ResidualBoundBody{natural(view_of(velocity_)),
                          view_of(std::as_const(consistent_velocity_))});
  }

  static bool is_within(double share, const LinearProgress& progress) {
    return progress.left <= share * progress.moved;
  }

  /// The natural map of the impulses at hand.
  ContactResidualBody<double> natural(View<const double> velocity) const {
    return {view_of(constants_), switches_of(options_), view_of(impulse_), velocity,
            view_of(free_velocity_)};
  }

  void copy(View<const double> from, Vector& to) { exec_.copy("contact/mix", from, view_of(to)); }

  void keep_best() {
    copy(view_of(std::as_const(impulse_)), best_impulse_);
    copy(view_of(std::as_const(body_velocity_)), best_body_velocity_);
  }

  /// No impulses, no velocities; the load is what is left.
  void be_without_impulses() {
    fill(exec_, view_of(impulse_), 0.0);
    fill(exec_, view_of(body_velocity_), 0.0);
    copy(numbers_.load, rest_);
  }

  bool is_zero(View<const double> dofs) const {
    return exec_
               .template sum<PlainSums<1>>("contact/setup", island_.dof_begin, island_.dof_end,
                                           NonzeroBody<double>{dofs})
               .value[0] == 0;
  }

  Exec& exec_;
  const ContactOptions& options_;
  ContactNumbers<double> numbers_;
  const ContactIsland& island_;
  CoupledSystem<Exec> linear_;
  typename Exec::template Vector<ContactConstants<double>>& constants_;
  Vector &body_velocity_, &rest_, &best_body_velocity_, &velocity_, &consistent_velocity_,
      &free_velocity_, &seen_, &impulse_, &best_impulse_;
  StopCriterion criterion_;
  double best_excess_ = std::numeric_limits<double>::infinity();
  double seen_share_ = 0;  ///< distance() per size in the norm of A, of smooth motion
};

}  // namespace tetwarp
