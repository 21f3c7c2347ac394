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

  /// The velocities without impulses and the scale they set.
  void start(IslandOutcome& outcome) {
    impulse_.assign(system_.offset.size(), 0.0);
    rest_ = system_.load;
    linear_.solve({.share = 0.1}, body_velocity_, rest_);
    find_velocity(free_velocity_);
    outcome.free = outcome.sums =
        exec_.template sum<ContactSums>("contact/residual", island_.slot_begin, island_.slot_end,
                                        CoupledFreeBody{natural(free_velocity_)});
    outcome.reason = StopReason::exhausted;
    best_impulse_ = impulse_;
    best_body_velocity_ = body_velocity_;
    outcome.free_square = 0;
    for (std::int64_t k = 3 * island_.slot_begin; k < 3 * island_.slot_end; ++k) {
      outcome.free_square += square_of(free_velocity_[static_cast<std::size_t>(k)]);
    }
    const double scale =
        options_.measure == ContactMeasure::eta ? outcome.free.eta : outcome.free_square;
    const double tolerance = margin * options_.tolerance;
    rule_ = {options_.measure, tolerance, tolerance * std::sqrt(scale)};
  }

  /// The velocities that impulses cause, from nothing; see body_velocity().
  void find_body_velocity(const Vector& impulse) {
    impulse_ = impulse;
    std::fill(body_velocity_.begin(), body_velocity_.end(), 0.0);
    find_rest();
    linear_.solve({.share = options_.tolerance}, body_velocity_, rest_);
  }

  /// Judges impulses, keeps them if they are the best so far and notes them in the outcome.
  /// @param impulse        [3 slots]
  /// @param body_velocity  [dofs], close to the velocities that the impulses cause; with these the
  ///                       contacts obey their law
  /// @param is_last        false: impulses far from a solution are told so early, and not kept
  /// @returns  at most 1 when done: residual and imbalance over the tolerance
  double judge(const Vector& impulse,
               const Vector& body_velocity,
               bool is_last,
               IslandOutcome& outcome) {
    impulse_ = impulse;
    body_velocity_ = body_velocity;
    find_rest();
    LinearAim aim{.share = 0.1};
    if (options_.measure == ContactMeasure::eta) {
      find_velocity(obedient_velocity_);
      const double allowed = rule_.allowed_at(contact_residual(
          exec_, island_.slot_begin, island_.slot_end, natural(obedient_velocity_)));
      aim.error = aim.seen = allowed / 10;
      if (!is_last) aim.too_far = allowed / 2;
    }
    const double moved =
        linear_.solve(aim, body_velocity_, rest_, [&](const Vector& v) { return seen(v); });
    if (moved > aim.too_far) return 2 * moved / aim.too_far;
    find_velocity(velocity_);
    const ContactSums sums = exec_.template sum<ContactSums>(
        "contact/residual", island_.slot_begin, island_.slot_end,
        CoupledBoundBody{natural(velocity_), view_of(std::as_const(obedient_velocity_))});
    const double excess = std::max(rule_.excess_of(sums), imbalance() / options_.tolerance);
    outcome.events.push_back({outcome.sweeps, rule_.error_of(sums)});
    if (excess < best_excess_) {
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
  static constexpr double margin = 0.8;  ///< of the tolerance: velocities have errors, too

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

  /// One index = one contact: |J v|^2 weighed as eta does.
  struct SeenBody {
    BodiesView<double> bodies;
    View<const ContactConstants<double>> constants;
    const double* body_velocity;

    TETWARP_HD PlainSums<1> operator()(std::int64_t c) const {
      double u[3], still[3];
      bodies.velocity_at(c, body_velocity, u);
      for (int a = 0; a < 3; ++a) still[a] = bodies.offset[3 * c + a];
      return {{normal_weight(constants[c]) * square_of(u[0] - still[0]) +
               tangent_weight(constants[c]) *
                   (square_of(u[1] - still[1]) + square_of(u[2] - still[2]))}};
    }
  };

  /// The size of J v in the weights of eta: springs much stiffer than the body they hold feel
  /// errors that the norm of A does not.
  double seen(const Vector& body_velocity) const {
    return std::sqrt(
        exec_
            .template sum<PlainSums<1>>("contact/residual", island_.slot_begin, island_.slot_end,
                                        SeenBody{system_.bodies_view(structure_),
                                                 view_of(constants_), body_velocity.data()})
            .value[0]);
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
};

}  // namespace tetwarp
