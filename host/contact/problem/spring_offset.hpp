/// @file spring_offset.hpp
/// Normal springs whose gap is not dt w_n, because w_n also holds restitution or other terms.
///
/// With o_n = gap_n / dt - w_n the normal law is 0 <= nu_n perpendicular to u_n >= 0, nu_n = r_n +
/// kappa_n (u_n + o_n). The constant kappa_n o_n is moved into the load: for
///
///     r' = r + kappa_n o_n,  b' = b - J_n^T kappa_n o_n
///
/// velocities and nu_n are the same and the law is that of o_n = 0, which all solvers have.
#pragma once
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// o_n of each contact [m/s]; empty where all are 0 up to rounding, without gaps, and in local
/// form.
std::vector<double> normal_offsets(const ContactProblem& problem);

/// kappa_n o_n of each contact [N s]; empty where all are 0.
std::vector<double> spring_preloads(const ContactProblem& problem);

/// The problem with load b' and o_n = 0; its impulse guess is r'.
/// @param preloads  spring_preloads(problem), not empty
ContactProblem with_preloads(ContactProblem problem, const std::vector<double>& preloads);

/// Adds `sign` times the preloads to the normal impulses.
void add_preloads(const std::vector<double>& preloads, double sign, std::vector<double>& impulse);

}  // namespace tetwarp
