/// @file contact_coupled.hpp
/// State of an island of bodies that A couples, and how far it is from a solution.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "host/contact_krylov.hpp"
#include "host/contact_monitor.hpp"
#include "host/contact_run.hpp"
#include "kernels/contact_residual.hpp"

namespace tetwarp {

/// Velocities, impulses and the defect b + J^T r - A v that is left. Vectors are [dofs] or [3
/// slots] of the whole problem; only the island's part is read and written.
///
/// eta is estimated, since no product with A^-1 is at hand: contacts are weighed with D in the
/// place of A, and the energy that belongs to the defect is its size in the norm of the
/// preconditioner times the ratio of energy norm to that norm in the last linear solve.
template <class Exec>
class CoupledIsland {
 public:
  using Vector = std::vector<double>;

  CoupledIsland(Exec& exec,
                const ContactOptions& options,
                const ContactStructure& structure,
                const ContactSystem<double>& system,
                const ContactIsland& island,
                CoarseSpace& coarse)
      : exec_(exec),
        options_(options),
        structure_(structure),
        system_(system),
        island_(island),
        linear_(exec, structure, system, island, coarse),
        constants_(system.constants),
        v_(system.load.size(), 0.0),
        velocity_(system.offset.size(), 0.0),
        free_(system.offset.size(), 0.0),
        impulse_(system.offset.size(), 0.0),
        change_(system.offset.size(), 0.0),
        push_(system.load.size(), 0.0) {
    // Plain metrics of D, without the relaxation of the outer iteration.
    for (ContactConstants<double>& c : constants_) {
      const double normal = c.block[0] / options.relaxation;
      const double tangent = c.tangent_metric / options.relaxation;
      std::fill_n(c.block, 9, 0.0);
      c.block[0] = normal;
      c.block[4] = c.block[8] = c.tangent_metric = tangent;
    }
  }

  const ContactIsland& island() const { return island_; }
  const std::vector<ContactConstants<double>>& constants() const { return constants_; }
  const Vector& velocity() const { return velocity_; }  ///< u = J v + w
  Vector& impulse() { return impulse_; }
  Vector& body_velocity() { return v_; }
  Vector& defect() { return defect_; }  ///< of (v, impulse)
  CoupledSystem<Exec>& linear() { return linear_; }
  const StopRule& rule() const { return rule_; }

  const Vector& best_impulse() const { return best_impulse_; }
  const Vector& best_body_velocity() const { return best_v_; }

  /// The free velocity with its residual; then the velocity that the guess causes.
  /// @param guess  [3 slots], or empty
  void start(const Vector& guess, IslandOutcome& outcome) {
    constexpr double reduction = 0.1;  // the free velocity sets the scale, no more
    defect_ = system_.load;
    solve_linear(reduction, v_);
    find_velocity();
    free_ = velocity_;
    outcome.free = natural(impulse_);
    for (std::int64_t k = 3 * island_.slot_begin; k < 3 * island_.slot_end; ++k) {
      outcome.free_square += square_of(free_[static_cast<std::size_t>(k)]);
    }
    rule_ = {options_.measure, options_.tolerance,
             options_.tolerance * std::sqrt(options_.measure == ContactMeasure::eta
                                                ? outcome.free.eta
                                                : outcome.free_square)};
    if (guess.empty()) return;
    push(guess, impulse_, defect_);
    impulse_ = guess;
    solve_linear(reduction, v_);
    find_velocity();
  }

  /// x += the solution for the defect, which shrinks to `reduction` of it.
  void solve_linear(double reduction, Vector& x) {
    constexpr int most_products = 500;
    norm_ratio_ = linear_.solve(reduction, most_products, defect_, x).norm_ratio;
  }

  /// u from v.
  void find_velocity() {
    exec_.for_each(
        "contact/coupled", island_.contact_count(),
        FromContact<ContactVelocityBody<BodiesView<double>, double>>{
            {system_.bodies_view(structure_), v_.data(), view_of(velocity_)}, island_.slot_begin});
  }

  /// out += J^T (to - from).
  void push(const Vector& to, const Vector& from, Vector& out) {
    for (std::int64_t k = 3 * island_.slot_begin; k < 3 * island_.slot_end; ++k) {
      const auto i = static_cast<std::size_t>(k);
      change_[i] = to[i] - from[i];
    }
    body_relax(exec_, island_.block_begin, island_.block_end,
               BodyPushBody<double>{structure_.block_contacts(), view_of(structure_.dof_start),
                                    view_of(system_.jacobian), view_of(std::as_const(change_)),
                                    view_of(out)});
  }

  /// Judges (v, answer), keeps it if it is the best so far and adds it to the outcome.
  /// @returns at most 1 when done: residual and imbalance over what is allowed
  double judge(const Vector& answer, IslandOutcome& outcome) {
    ContactSums sums = natural(answer);
    missing_ = defect_;
    push(answer, impulse_, missing_);
    sums.eta += square_of(norm_ratio_ * linear_.size_of(missing_));
    const double excess = std::max(rule_.excess_of(sums), imbalance(answer) / options_.tolerance);
    outcome.events.push_back({outcome.outer_iterations, rule_.error_of(sums)});
    if (excess < best_excess_) {
      best_excess_ = excess;
      best_impulse_ = answer;
      best_v_ = v_;
      outcome.sums = sums;
      outcome.reason = excess <= 1 ? StopReason::converged : StopReason::stalled;
    }
    return excess;
  }

 private:
  ContactSums natural(const Vector& impulse) const {
    return contact_residual(
        exec_, island_.slot_begin, island_.slot_end,
        ContactResidualBody<double>{view_of(constants_), switches_of(options_), view_of(impulse),
                                    view_of(velocity_), view_of(free_)});
  }

  /// |A v - J^T r - b| relative to the larger of |b| and |J^T r|.
  double imbalance(const Vector& answer) {
    const double missing = linear_.dot(missing_, missing_);
    if (missing == 0) return 0;
    std::fill(push_.begin(), push_.end(), 0.0);
    push(answer, Vector(answer.size(), 0.0), push_);
    const double scale =
        std::max(linear_.dot(system_.load, system_.load), linear_.dot(push_, push_));
    return std::sqrt(missing / std::max(scale, std::numeric_limits<double>::min()));
  }

  Exec& exec_;
  const ContactOptions& options_;
  const ContactStructure& structure_;
  const ContactSystem<double>& system_;
  const ContactIsland& island_;
  CoupledSystem<Exec> linear_;
  std::vector<ContactConstants<double>> constants_;
  Vector v_, velocity_, free_, impulse_;
  Vector defect_, missing_, change_, push_;
  Vector best_impulse_, best_v_;
  double best_excess_ = std::numeric_limits<double>::infinity();
  double norm_ratio_ = 1;
  StopRule rule_;
};

}  // namespace tetwarp
