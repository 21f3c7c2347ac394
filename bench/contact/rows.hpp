/// @file rows.hpp
/// Rows of tetwarp_bench_contact and their counters.
#pragma once
#include "bench/contact/cases.hpp"

namespace tetwarp::bench {

/// Registers the row of a case. It solves once and checks the result with check_solution(), or with
/// check_report() where a result of the same method and problem has been checked before and the
/// kind is not ContactKind::method; a wrong
/// result is refused and not timed. A result that is not converged is timed and counted as such;
/// then the rows of the same method with tighter tolerances are left out. The time is the median
/// over solves. Counters [ms where not stated]:
///
///   low, high, min, kept, discarded, busy, contended       see Timing
///   processor                       least processor time of all threads
///   setup, solve                    of the last timed solve
///   converged                       1 or 0
///   eta, fclib, penetration [m/s]   of the timed result
///   error                           eta or fclib, the one that the tolerance bounds
///   contacts, colors, islands, sweeps, outer_iterations, newton_iterations, updates
///   updates_per_second              contacts x sweeps per second of solving
///   rows_skipped, springs_skipped, bodies_skipped, islands_stopped, updates_skipped
void add_contact_row(const ContactCase& row);

}  // namespace tetwarp::bench
