/// @file method_choice.hpp
/// Whether sweeps or Newton's method continue an island that does not converge at once. Decided by
/// counted operations and measured residuals, never by a clock: the same choice on every machine.
#pragma once
#include <cstdint>

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

/// Whether to leave sweeps for a series of Newton steps that cost as much as `worth` sweeps. The
/// slower the sweeps converge, the earlier: after a third of that cost at the earliest, at the
/// latest after all of it, and in between not while they promise to converge sooner.
/// @param spent  sweeps so far
/// @param left   of sweeps_left()
bool prefers_newton(double worth, std::int64_t spent, double left);

}  // namespace tetwarp
