/// @file contact.hpp
/// Back end `reference` of the contact solver.
#pragma once
#include <tetwarp/contact.hpp>

namespace tetwarp {

/// Solves a contact problem by dense matrices in float64, one contact after the other.
///
/// Up to 8 contacts are solved by enumeration of their states, where the law is the pyramid or
/// there is no friction and the states are no more than 60,000; all others by projected
/// Gauss-Seidel in the order of the contacts. It goes on to eta = 1e-12 or `max_sweeps`, whatever
/// `tolerance` asks; method, precision, skips, threads and device have no effect.
/// Where no velocity keeps all contacts apart, the status is `infeasible`; a global problem is then
/// solved with a recovery speed of 0, and the residual reported is that of the problem as given.
/// @throws ContactProblemError  see check_problem(); a system that is not positive definite
///
/// Cost: memory and time of a sweep grow with the square of the contacts.
/// Source: Gascon 2010, section 4.3, with n, t, b in sequence for the pyramid; the local cone is
/// solved exactly.
ContactSolution solve_contacts_reference(const ContactProblem& problem,
                                         const ContactOptions& options = {});

}  // namespace tetwarp
