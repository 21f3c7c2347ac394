/// @file contact_measure.hpp
/// Rows of Google Benchmark from contact cases: checked, timed, counted.
#pragma once
#include "bench/contact_cases.hpp"

namespace tetwarp::bench {

/// Registers a row. Run, it solves once and has judge() look at the result, where it already has at
/// one of the same method and problem judge_report(): a wrong one is refused and not timed. One
/// that says itself that it did not converge is timed and counted as such; then tighter tolerances
/// of the same method are left out. The row's time is the median over solves. Its counters [ms
/// where not said]:
///
///   low, high, min, kept, discarded, busy, contended       see Timing
///   setup, solve                    of the last timed solve
///   converged                       1 or 0
///   eta, fclib, penetration [m/s]   of the timed result
///   error                           the one of both that the tolerance bounds
///   contacts, colors, islands, sweeps, outer_iterations, newton_iterations, updates
///   updates_per_second              contacts x sweeps per second of solving
///   rows_skipped, springs_skipped, bodies_skipped, islands_stopped, updates_skipped
void register_contact_row(const ContactCase& row);

}  // namespace tetwarp::bench
