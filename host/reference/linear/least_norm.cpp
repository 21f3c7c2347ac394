/// @file least_norm.cpp
/// By a complete orthogonal decomposition.
#include "host/reference/linear/least_norm.hpp"

#include <Eigen/QR>

namespace tetwarp::reference {

Eigen::MatrixXd least_norm_solution(const Eigen::MatrixXd& matrix,
                                    const Eigen::MatrixXd& right,
                                    double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  if (threshold > 0) decomposition.setThreshold(threshold);
  return decomposition.compute(matrix).solve(right);
}

}  // namespace tetwarp::reference
