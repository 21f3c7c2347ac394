/// @file least_norm.hpp
/// Linear systems whose matrix may be singular or not square.
#pragma once
#include <Eigen/Core>

namespace tetwarp::reference {

/// Of the matrices x with the least |matrix x - right| the one of least norm, column by column.
/// @param threshold  pivots below this share of the largest count as 0; 0: by rounding
Eigen::MatrixXd least_norm_solution(const Eigen::MatrixXd& matrix,
                                    const Eigen::MatrixXd& right,
                                    double threshold = 0);

}  // namespace tetwarp::reference
