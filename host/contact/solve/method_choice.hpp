/// @file method_choice.hpp
/// Whether sweeps or Newton's method continue an island that does not converge at once. Decided by
/// counted operations and measured residuals, never by a clock: the same choice on every machine.
#pragma once
#include <cstdint>

#include <tetwarp/choices.hpp>

#include "host/contact/newton/newton_system.hpp"

namespace tetwarp {

/// Sweeps that take about as long as one step of Newton's method: the contacts' derivatives and
/// products, and the factorization.
double sweeps_per_newton_step(const NewtonCost& cost, std::int64_t contacts);

/// Sweeps to half of the allowed error if the error continues to drop at its rate over the last
/// sweeps; infinity if it did not drop. Half, because the rate of sweeps usually falls.
/// @param before  error over allowed error before these sweeps
/// @param after   the same after them, > 1
double sweeps_left(double before, double after, std::int64_t sweeps);

/// By how many sweeps a Newton step counts where the choice is between both. Where a factorization
/// fills more than that of a chain of bodies, contacts hold each other in more than one direction:
/// such packings take the more steps, hundreds with friction, the more it fills.
/// @param sweeps_per_step  of sweeps_per_newton_step()
double newton_worth(double sweeps_per_step);

/// Whether to leave sweeps for a series of Newton steps that cost as much as `worth` sweeps: the
/// sweeps that are left would cost more, and the series, should it fail, at most two fifths of all
/// sweeps. No more are counted as left than ten times those spent.
/// @param spent  sweeps so far
/// @param left   of sweeps_left()
bool prefers_newton(double worth, std::int64_t spent, double left);

/// Which accelerated sweeps continue an island: conjugate directions or Anderson's method.
class SweepChoice {
 public:
  /// @param first  the present sweeps
  explicit SweepChoice(ContactMethod first = ContactMethod::nonlinear_cg) : current_(first) {}

  ContactMethod current() const { return current_; }

  /// Chooses the next sweeps: the other ones after the present ones have been slow three times in a
  /// row, unless the other ones were slower when they last ran.
  /// @param spent  sweeps so far
  /// @param left   of sweeps_left(), by the present ones
  void note(std::int64_t spent, double left);

 private:
  ContactMethod current_;
  int slow_ = 0;           ///< slow sweeps in a row
  double other_left_ = 0;  ///< of the other ones, when they last ran
};

}  // namespace tetwarp
