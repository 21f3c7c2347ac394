/// @file coupled_system.cpp
/// The bound of the error of a solve by conjugate gradients.
#include "host/contact/block_jacobi/coupled_system.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace tetwarp {

/// The steps of conjugate gradients give the tridiagonal matrix of the Lanczos process; its
/// eigenvalues are the Ritz values.
void GradientError::update_smallest() {
  const auto count = static_cast<Eigen::Index>(steps_.size());
  Eigen::VectorXd diagonal(count), beside(count);
  double carried = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto [factor, shrink] = steps_[static_cast<std::size_t>(k)];
    diagonal(k) = 1 / factor + carried;
    carried = shrink / factor;
    beside(k) = std::sqrt(shrink) / factor;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside.head(count - 1), Eigen::EigenvaluesOnly);
  if (solver.eigenvalues()(0) > 0) smallest_ = std::min(smallest_, solver.eigenvalues()(0));
}

double GradientError::left_factor() {
  update_smallest();
  const double shift = smallest_ / 2;
  double bound = 1 / shift;
  for (const Step& step : steps_) {
    const double excess = bound - step.factor;
    bound = excess / (shift * excess + step.shrink);
  }
  return bound;
}

}  // namespace tetwarp
