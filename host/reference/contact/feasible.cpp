/// @file feasible.cpp
/// Whether some velocity satisfies all contacts.
#include "host/reference/contact/feasible.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>
#include <vector>

#include "host/reference/contact/dense.hpp"
#include "host/reference/linear/least_norm.hpp"

namespace tetwarp::reference {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {
/// min |matrix x - right| over x >= 0; returns the smallest |matrix x - right|.
/// Source: Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23.
double nonnegative_least_squares(const MatrixXd& matrix, const VectorXd& right) {
  VectorXd x = VectorXd::Zero(matrix.cols());
  std::vector<Index> passive;
  // In exact arithmetic the method terminates; with rounding errors it may cycle.
  for (Index step = 0; step < 10 * matrix.cols(); ++step) {
    const VectorXd slope = matrix.transpose() * (right - matrix * x);
    Index entering = -1;
    double steepest = 1e-12 * right.norm();
    for (Index i = 0; i < x.size(); ++i) {
      const double steepness = slope(i) / matrix.col(i).norm();
      if (x(i) > 0 || !(steepness > steepest)) continue;
      steepest = steepness;
      entering = i;
    }
    if (entering < 0) break;
    passive.push_back(entering);
    for (;;) {
      MatrixXd columns(matrix.rows(), static_cast<Index>(passive.size()));
      for (Index k = 0; k < columns.cols(); ++k) {
        columns.col(k) = matrix.col(passive[static_cast<std::size_t>(k)]);
      }
      const VectorXd target = least_norm_solution(columns, right);
      double length = 1;
      for (Index k = 0; k < target.size(); ++k) {
        const double old = x(passive[static_cast<std::size_t>(k)]);
        if (target(k) <= 0) length = std::min(length, old / (old - target(k)));
      }
      std::vector<Index> remaining;
      for (Index k = 0; k < target.size(); ++k) {
        const Index i = passive[static_cast<std::size_t>(k)];
        x(i) += length * (target(k) - x(i));
        if (target(k) > 0 || x(i) > 1e-14 * x.maxCoeff()) {
          remaining.push_back(i);
        } else {
          x(i) = 0;
        }
      }
      if (remaining.size() == passive.size()) break;
      passive = std::move(remaining);
      if (passive.empty()) break;
    }
  }
  return (matrix * x - right).norm();
}
}  // namespace

bool is_feasible(const DenseContacts& contacts) {
  constexpr double vanishing = 1e-6;
  const Index count = contacts.contact_count();
  MatrixXd normals(count, count);
  VectorXd speeds(count);
  for (Index i = 0; i < count; ++i) {
    speeds(i) = contacts.free_velocity(3 * i);
    for (Index j = 0; j < count; ++j) normals(i, j) = contacts.delassus(3 * i, 3 * j);
  }
  if (!(speeds.array() < 0).any()) return true;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> spectrum(0.5 * (normals + normals.transpose()));
  const VectorXd roots = spectrum.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  // Farkas: infeasible if and only if impulses d >= 0 exist with B d = 0 and q . d < 0.
  MatrixXd certificate(count + 1, count);
  certificate.topRows(count) = roots.asDiagonal() * spectrum.eigenvectors().transpose();
  certificate.row(count) = -speeds.transpose() * (roots.maxCoeff() / speeds.norm());
  VectorXd right = VectorXd::Zero(count + 1);
  right(count) = 1;
  return nonnegative_least_squares(certificate, right) > vanishing;
}

}  // namespace tetwarp::reference
