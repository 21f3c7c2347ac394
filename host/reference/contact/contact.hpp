/// @file contact.hpp
/// Back end `reference` of the contact solver.
#pragma once
#include <tetwarp/contact.hpp>

namespace tetwarp {

/// Solves a contact problem with dense matrices in float64, serially.
///
/// Problems of up to 8 contacts with the pyramid or without friction, and with at most 60,000
/// combinations of states, are solved by enumeration of these combinations; all others by projected
/// Gauss-Seidel in the order of the contacts, down to eta = 1e-12 or up to `max_sweeps`. The
/// tolerance affects the status only; method, precision, skips, threads and device have no effect.
/// If no velocity satisfies all contacts, the status is `infeasible`; a global problem is then
/// solved with a recovery speed of 0, and the residual reported is that of the problem as given.
/// @throws ContactProblemError  the problem fails check_problem(), or A is not positive definite
///
/// Cost: memory and time of a sweep grow with the square of the contacts.
/// Source: Gascon 2010, section 4.3: for the pyramid normal, tangent 1 and tangent 2 in sequence.
/// The problem of one contact with the cone is solved exactly.
ContactSolution solve_contacts_reference(const ContactProblem& problem,
                                         const ContactOptions& options = {});

}  // namespace tetwarp
