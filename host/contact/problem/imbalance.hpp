/// @file imbalance.hpp
/// How far body velocities and impulses are from A v = b + J^T r.
#pragma once
#include <span>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// sum += matrix x, in the order of the stored entries.
void add_product(const SparseMatrix& matrix, std::span<const double> x, std::vector<double>& sum);

/// |A v - J^T r - b| / max(|b|, |J^T r|); 0 in local form.
/// @param impulse        r, [3 contacts]
/// @param body_velocity  v, [dofs]
double imbalance(const ContactProblem& problem,
                 std::span<const double> impulse,
                 std::span<const double> body_velocity);

}  // namespace tetwarp
