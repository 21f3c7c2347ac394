/// @file contact_coupled_newton.hpp
/// Contacts of bodies that A couples, by Newton steps whose linear systems need products with A
/// alone: for bodies of many elements.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "host/contact_coupled.hpp"
#include "kernels/contact_tangent.hpp"

namespace tetwarp {

/// Alternates two things. The state (velocity, multipliers) gives every contact a tangent: a spring
/// and its anchor. The bodies then move to where these springs and A balance, which also yields the
/// next multipliers. Rows that must not move get stiff springs with multipliers, so their metric
/// does not matter in the end; the linear systems need be solved only roughly.
///
/// Source: augmented Lagrangian Newton for contact (Alart, Curnier 1991), with inexact steps.
template <class Exec>
class CoupledNewton {
 public:
  using Vector = std::vector<double>;

  CoupledNewton(Exec& exec, const ContactOptions& options, CoupledIsland<Exec>& island)
      : exec_(exec),
        switches_(switches_of(options)),
        island_(island),
        tangents_(island.constants().size()),
        before_(island.impulse().size()),
        answer_(island.impulse().size()),
        step_(island.body_velocity().size()) {}

  /// @param guess  [3 slots] to start from, or empty
  IslandOutcome solve(const Vector& guess) {
    constexpr int most_steps = 60;
    IslandOutcome outcome;
    outcome.methods = {"newton_krylov"};
    island_.start(guess, outcome);
    double reduction = 0.1;
    double last = std::numeric_limits<double>::infinity();
    while (outcome.outer_iterations < most_steps) {
      take_step(reduction);
      ++outcome.outer_iterations;
      const double excess = island_.judge(answer_, outcome);
      if (excess <= 1) break;
      // Rough steps that no longer help need better linear solutions.
      if (excess > 0.6 * last) reduction = std::max(0.3 * reduction, 1e-6);
      last = excess;
    }
    return outcome;
  }

 private:
  template <class Body>
  void for_contacts(const Body& body) {
    exec_.for_each("contact/newton", island_.island().contact_count(),
                   FromContact<Body>{body, island_.island().slot_begin});
  }

  /// v, multipliers, the defect of both, and the law's own answer to them.
  void take_step(double reduction) {
    const ContactIsland& range = island_.island();
    for_contacts(ContactTangentBody<double>{
        view_of(island_.constants()), switches_, view_of(island_.velocity()),
        view_of(std::as_const(island_.impulse())), view_of(tangents_)});
    island_.linear().set_tangents(tangents_);
    // From the defect of (v, multipliers) to that of (v, anchors).
    for (std::int64_t c = range.slot_begin; c < range.slot_end; ++c) {
      std::copy_n(tangents_[static_cast<std::size_t>(c)].anchor, 3, answer_.begin() + 3 * c);
    }
    island_.push(answer_, island_.impulse(), island_.defect());
    std::fill(step_.begin(), step_.end(), 0.0);
    island_.solve_linear(reduction, step_);
    for (std::size_t d = 0; d < step_.size(); ++d) island_.body_velocity()[d] += step_[d];
    before_ = island_.velocity();
    island_.find_velocity();
    // What is left of the defect belongs to (v + step, anchor - S J step).
    for (std::int64_t c = range.slot_begin; c < range.slot_end; ++c) {
      const auto row = static_cast<std::size_t>(3 * c);
      const ContactTangent<double>& tangent = tangents_[static_cast<std::size_t>(c)];
      double moved[3], pull[3], u[3];
      for (std::size_t a = 0; a < 3; ++a) {
        u[a] = island_.velocity()[row + a];
        moved[a] = u[a] - before_[row + a];
      }
      tangent.apply(moved, pull);
      for (std::size_t a = 0; a < 3; ++a) {
        answer_[row + a] = island_.impulse()[row + a] = tangent.anchor[a] - pull[a];
      }
      solve_contact(island_.constants()[static_cast<std::size_t>(c)], switches_, u,
                    answer_.data() + row);
    }
  }

  Exec& exec_;
  ContactSwitches switches_;
  CoupledIsland<Exec>& island_;
  std::vector<ContactTangent<double>> tangents_;
  Vector before_, answer_, step_;
};

}  // namespace tetwarp
