/// @file contact_coupled.hpp
/// How far impulses on bodies that A couples are from a solution, without a factor of A.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "host/contact_linear.hpp"
#include "host/contact_monitor.hpp"
#include "host/contact_pipeline.hpp"
#include "host/contact_run.hpp"
#include "kernels/contact_bound.hpp"

namespace tetwarp {

/// Judges the impulses of one coupled island by the velocities they cause, A v = b + J^T r solved
/// by conjugate gradients, and keeps the best pair.
///
/// eta weighs each contact by its own block of J A^-1 J^T, which only a factorization yields, so
/// eta is bounded; see CoupledBoundBody. The measure of FCLIB has no weights and is as exact as the
/// velocities.
template <class Exec>
class CoupledJudge {
 public:
  using Vector = std::vector<double>;

  CoupledJudge(Exec& exec,
               const ContactOptions& options,
               const ContactStructure& structure,
               const ContactSystem<double>& system,
               const ContactIsland& island)
      : exec_(exec),
        options_(options),
        structure_(structure),
        system_(system),
        island_(island),
        linear_(exec, structure, system, island),
        constants_(system.constants),
        body_velocity_(system.load.size(), 0.0),
        velocity_(system.offset.size(), 0.0),
        obedient_velocity_(system.offset.size(), 0.0),
        free_velocity_(system.offset.size(), 0.0) {
    // There the blocks are those of omega J D^-1 J^T. Diagonal blocks of A^-1 are at least those of
    // D^-1; as a whole A^-1 is at least D^-1 over the largest eigenvalue of D^-1 A, which is below
    // 2 / omega where the outer iteration converges.
    for (std::size_t s = 0; s < constants_.size(); ++s) {
      const bool is_one_block = structure.pair_start[s + 1] - structure.pair_start[s] == 1;
      const double factor = is_one_block ? 1 / options.relaxation : 0.5;
      for (double& entry : constants_[s].block) entry *= factor;
      constants_[s].tangent_metric *= factor;
    }
  }

  /// The velocities without impulses and the scale they set. Where they break no contact's law,
  /// that is the solution: the outcome has converged.
  void start(IslandOutcome& outcome) {
    impulse_.assign(system_.offset.size(), 0.0);
    rest_ = system_.load;
    const auto is_zero = [](double value) { return value == 0; };
    const bool is_still =
        std::all_of(rest_.begin() + island_.dof_begin, rest_.begin() + island_.dof_end, is_zero);
    if (is_still) {  // nothing would be learned of A; a push on every contact shows it
      for (std::size_t row = 0; row < impulse_.size(); row += 3) impulse_[row] = 1;
      find_rest();
    }
    const LinearProgress progress = linear_.solve(
        body_velocity_, rest_, [](const LinearProgress& now) { return is_within(0.1, now); });
    find_velocity(velocity_);
    seen_share_ = progress.moved > 0 ? distance(system_.offset) / progress.moved : 0;
    if (is_still) {
      impulse_.assign(system_.offset.size(), 0.0);
      body_velocity_.assign(system_.load.size(), 0.0);
      rest_ = system_.load;
    }
    outcome.reason = StopReason::exhausted;
    find_free(outcome);
    if (rule_.error_of(outcome.free) == 0) {  // a scale of zero: nothing else could be judged by it
      linear_.solve(body_velocity_, rest_, [&](const LinearProgress&) { return is_balanced(); });
      find_free(outcome);
      if (rule_.error_of(outcome.free) == 0 && is_balanced()) {
        outcome.reason = StopReason::converged;
        outcome.events.push_back({outcome.sweeps, 0.0});
      }
    }
    outcome.sums = outcome.free;
    best_impulse_ = impulse_;
    best_body_velocity_ = body_velocity_;
  }

  /// The velocities that impulses cause, from nothing, to half the digits of the tolerance: more
  /// would cost more than the outer steps that they save; see body_velocity().
  void find_body_velocity(const Vector& impulse) {
    impulse_ = impulse;
    std::fill(body_velocity_.begin(), body_velocity_.end(), 0.0);
    find_rest();
    const double share = std::sqrt(options_.tolerance);
    linear_.solve(body_velocity_, rest_,
                  [&](const LinearProgress& now) { return is_within(share, now); });
  }

  /// Judges impulses and keeps them if they are the best so far.
  /// @param impulse        [3 slots]
  /// @param body_velocity  [dofs], close to the velocities that the impulses cause; with these the
  ///                       contacts obey their law
  /// @param is_last        false: impulses far from a solution are told so early
  /// @returns  at most 1 when done: residual and imbalance over the tolerance
  double judge(const Vector& impulse,
               const Vector& body_velocity,
               bool is_last,
               IslandOutcome& outcome) {
    impulse_ = impulse;
    body_velocity_ = body_velocity;
    find_rest();
    find_velocity(obedient_velocity_);
    Vector seen = obedient_velocity_;
    ContactSums sums = bounded_sums();
    double excess = rule_.excess_of(sums), doubt = 0, moved = 0;
    linear_.solve(body_velocity_, rest_, [&](const LinearProgress& progress) {
      sums = bounded_sums();
      excess = rule_.excess_of(sums);
      if (options_.measure == ContactMeasure::fclib) return is_within(0.1, progress);
      // What is left moves the contacts as much as the free motion did, or the last steps.
      const double step = std::sqrt(square_of(progress.moved) - square_of(moved));
      const double share = std::max(step > 0 ? distance(seen) / step : 0, seen_share_);
      doubt = share * progress.left / rule_.allowed_at(sums);
      seen = velocity_;
      moved = progress.moved;
      const bool is_bad = !is_last && excess > 0.8;  // soon over 1, or only after many steps below
      const bool is_good = excess + doubt <= 1 && is_balanced();
      return is_bad || is_good || doubt <= settled * excess;
    });
    const bool is_settled = is_last || excess + doubt <= 1 || doubt <= settled * excess;
    excess += is_settled ? doubt : std::min(doubt, excess);
    if (is_settled) {
      sums.eta = square_of(std::sqrt(sums.eta) + doubt * rule_.allowed_at(sums));
    }
    excess = std::max(excess, imbalance() / options_.tolerance);
    outcome.events.push_back({outcome.sweeps, rule_.error_of(sums)});
    if (is_settled && excess < best_excess_) {
      best_excess_ = excess;
      best_impulse_ = impulse_;
      best_body_velocity_ = body_velocity_;
      outcome.sums = sums;
      outcome.reason = excess <= 1 ? StopReason::converged : StopReason::exhausted;
    }
    return excess;
  }

  /// v of the impulses judged last, [dofs].
  const Vector& body_velocity() const { return body_velocity_; }

  /// The best pair judged: r, [3 slots], and v, [dofs], of the whole problem; set in the island.
  const Vector& best_impulse() const { return best_impulse_; }
  const Vector& best_body_velocity() const { return best_body_velocity_; }

 private:
  static constexpr double margin = 0.8;   ///< of the tolerance: velocities have errors, too
  static constexpr double settled = 0.1;  ///< doubt that leaves an excess worth its name

  /// One index = one block: squares of rest, load and J^T r.
  struct BalanceBody {
    BlockContacts contacts;
    View<const std::int64_t> dof_start;
    View<const double> jacobian, load, impulse, rest;

    TETWARP_HD PlainSums<3> operator()(std::int64_t b) const {
      PlainSums<3> sums;
      const std::int64_t size = dof_start[b + 1] - dof_start[b];
      for (std::int64_t k = 0; k < size; ++k) {
        double push = 0;
        for (std::int64_t p = contacts.start[b]; p < contacts.start[b + 1]; ++p) {
          const double* r = impulse.data + 3 * std::int64_t{contacts.contact[p]};
          const double* j = jacobian.data + contacts.value[p] + k;
          push += j[0] * r[0] + j[size] * r[1] + j[2 * size] * r[2];
        }
        sums.value[0] += square_of(rest[dof_start[b] + k]);
        sums.value[1] += square_of(load[dof_start[b] + k]);
        sums.value[2] += square_of(push);
      }
      return sums;
    }
  };

  /// |A v - J^T r - b| relative to the larger of |b| and |J^T r|.
  double imbalance() const {
    const PlainSums<3> sums = exec_.template sum<PlainSums<3>>(
        "contact/residual", island_.block_begin, island_.block_end,
        BalanceBody{structure_.block_contacts(), view_of(structure_.dof_start),
                    view_of(system_.jacobian), view_of(system_.load), view_of(impulse_),
                    view_of(rest_)});
    const double scale = std::max(sums.value[1], sums.value[2]);
    return std::sqrt(sums.value[0] / std::max(scale, std::numeric_limits<double>::min()));
  }

  bool is_balanced() const { return imbalance() <= options_.tolerance; }

  /// What the velocities at hand, those without impulses, leave to the contacts.
  void find_free(IslandOutcome& outcome) {
    find_velocity(free_velocity_);
    outcome.free =
        exec_.template sum<ContactSums>("contact/residual", island_.slot_begin, island_.slot_end,
                                        CoupledFreeBody{natural(free_velocity_)});
    outcome.free_square = 0;
    for (std::int64_t k = 3 * island_.slot_begin; k < 3 * island_.slot_end; ++k) {
      outcome.free_square += square_of(free_velocity_[static_cast<std::size_t>(k)]);
    }
    const double scale =
        options_.measure == ContactMeasure::eta ? outcome.free.eta : outcome.free_square;
    const double tolerance = margin * options_.tolerance;
    rule_ = {options_.measure, tolerance, tolerance * std::sqrt(scale)};
  }

  /// b + J^T r - A v.
  void find_rest() {
    body_relax(exec_, island_.block_begin, island_.block_end,
               BodyDefectBody<double>{structure_.system(view_of(system_.system)),
                                      structure_.block_contacts(), view_of(system_.jacobian),
                                      view_of(system_.load), view_of(std::as_const(impulse_)),
                                      view_of(std::as_const(body_velocity_)), view_of(rest_)});
  }

  /// u = J v + w.
  void find_velocity(Vector& velocity) const {
    using Body = ContactVelocityBody<BodiesView<double>, double>;
    const Body body{system_.bodies_view(structure_), body_velocity_.data(), view_of(velocity)};
    exec_.for_each("contact/residual", island_.contact_count(),
                   FromContact<Body>{body, island_.slot_begin});
  }

  /// One index = one contact: squared difference of two velocities, weighed as eta does.
  struct DistanceBody {
    View<const ContactConstants<double>> constants;
    const double *a, *b;

    TETWARP_HD PlainSums<1> operator()(std::int64_t c) const {
      const double* x = a + 3 * c;
      const double* y = b + 3 * c;
      return {{normal_weight(constants[c]) * square_of(x[0] - y[0]) +
               tangent_weight(constants[c]) * (square_of(x[1] - y[1]) + square_of(x[2] - y[2]))}};
    }
  };

  /// From other velocities to those at hand, in the weights of eta: springs much stiffer than the
  /// body they hold feel errors that the norm of A does not.
  double distance(const Vector& velocity) const {
    return std::sqrt(exec_
                         .template sum<PlainSums<1>>(
                             "contact/residual", island_.slot_begin, island_.slot_end,
                             DistanceBody{view_of(constants_), velocity_.data(), velocity.data()})
                         .value[0]);
  }

  /// Of the impulses and the velocities of the bodies at hand, against the obedient velocities.
  ContactSums bounded_sums() {
    find_velocity(velocity_);
    return exec_.template sum<ContactSums>(
        "contact/residual", island_.slot_begin, island_.slot_end,
        CoupledBoundBody{natural(velocity_), view_of(std::as_const(obedient_velocity_))});
  }

  static bool is_within(double share, const LinearProgress& progress) {
    return progress.left <= share * progress.moved;
  }

  /// The natural map of the impulses at hand.
  ContactResidualBody<double> natural(const Vector& velocity) const {
    return {view_of(constants_), switches_of(options_), view_of(impulse_), view_of(velocity),
            view_of(free_velocity_)};
  }

  Exec& exec_;
  const ContactOptions& options_;
  const ContactStructure& structure_;
  const ContactSystem<double>& system_;
  const ContactIsland& island_;
  CoupledLinear<Exec> linear_;
  std::vector<ContactConstants<double>> constants_;
  Vector body_velocity_, velocity_, obedient_velocity_, free_velocity_, impulse_, rest_;
  StopRule rule_;
  Vector best_impulse_, best_body_velocity_;
  double best_excess_ = std::numeric_limits<double>::infinity();
  double seen_share_ = 0;  ///< distance() per size in the norm of A, of smooth motion
};

}  // namespace tetwarp
