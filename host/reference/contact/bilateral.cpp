/// @file bilateral.cpp
/// Elimination of bilateral rows: with S = G A^-1 G^T + R, G their Jacobian and R their
/// compliances, G v + R lambda = c gives lambda = S^+ (c - G (v without lambda)), S^+ the
/// pseudoinverse.
#include "host/reference/contact/bilateral.hpp"

#include "host/reference/contact/dense.hpp"
#include "host/reference/linear/least_norm.hpp"

namespace tetwarp::reference {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void eliminate_bilateral(const ContactProblem& problem,
                         const Eigen::LLT<MatrixXd>& system,
                         const MatrixXd& jacobian,
                         const VectorXd& offset,
                         DenseContacts& contacts) {
  constexpr double rounding = 1e-12;
  const BilateralRows& rows = problem.bilateral;
  const auto count = static_cast<Index>(rows.row_count());
  MatrixXd own = MatrixXd::Zero(count, system.rows());
  VectorXd target = VectorXd::Zero(count);
  MatrixXd compliance = MatrixXd::Zero(count, count);
  for (Index row = 0; row < count; ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (std::int64_t e = rows.jacobian.row_start[r]; e < rows.jacobian.row_start[r + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      own(row, rows.jacobian.column[entry]) += rows.jacobian.value[entry];
    }
    if (!rows.target.empty()) target(row) = rows.target[r];
    if (!rows.compliance.empty()) compliance(row, row) = rows.compliance[r];
  }
  const MatrixXd response = system.solve(own.transpose());
  // Scaled to a unit diagonal, so that rows in m/s and rad/s count alike in the rank.
  const MatrixXd softness = own * response + compliance;
  const VectorXd scale = softness.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * softness * scale.asDiagonal();
  const auto solve = [&](const MatrixXd& right) -> MatrixXd {
    return scale.asDiagonal() * least_norm_solution(scaled, scale.asDiagonal() * right, rounding);
  };
  contacts.free_bilateral = solve(target - own * contacts.free_body_velocity);
  contacts.bilateral_change = solve(-own * contacts.body_change);
  contacts.free_body_velocity += response * contacts.free_bilateral;
  contacts.body_change += response * contacts.bilateral_change;
  const VectorXd before = contacts.delassus.diagonal();
  contacts.delassus = jacobian * contacts.body_change;
  contacts.free_velocity = jacobian * contacts.free_body_velocity + offset;
  // Rows that bilateral rows fix: what is left of their diagonal is rounding.
  for (Index row = 0; row < before.size(); ++row) {
    if (contacts.delassus(row, row) > rounding * before(row)) continue;
    contacts.delassus.row(row).setZero();
    contacts.delassus.col(row).setZero();
  }
}

}  // namespace tetwarp::reference
