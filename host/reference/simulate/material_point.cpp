/// @file material_point.cpp
/// The nearest point of a simplex, and whether a surface encloses a point.
#include "host/reference/simulate/material_point.hpp"

#include <cmath>
#include <numbers>

#include "host/reference/linear/least_norm.hpp"

namespace tetwarp::reference {

// The point of the corners' plane, line or space nearest to x has weights w with
// E^T E (w_1 ..) = E^T (x - c_0), E the edges from c_0. Where none is negative it is the answer,
// otherwise the nearest point lies on one of the simplices without one corner.
NearestPoint nearest_of_simplex(const MatrixXd& corners, const Vector3d& x) {
  const Eigen::Index count = corners.cols();
  const MatrixXd edges = corners.rightCols(count - 1).colwise() - corners.col(0);
  NearestPoint result;
  result.weights = VectorXd::Ones(count);
  if (count > 1) {
    result.weights.tail(count - 1) = least_norm_solution(edges, x - corners.col(0));
    result.weights(0) = 1 - result.weights.tail(count - 1).sum();
  }
  if (count == 1 || result.weights.minCoeff() >= 0) {
    result.distance = count == 4 ? 0 : (corners * result.weights - x).norm();
    return result;
  }
  result = NearestPoint{};
  for (Eigen::Index left_out = 0; left_out < count; ++left_out) {
    MatrixXd face(3, count - 1);
    face << corners.leftCols(left_out), corners.rightCols(count - 1 - left_out);
    const NearestPoint on_face = nearest_of_simplex(face, x);
    if (on_face.distance >= result.distance) continue;
    result.distance = on_face.distance;
    result.weights = VectorXd::Zero(count);
    result.weights.head(left_out) = on_face.weights.head(left_out);
    result.weights.tail(count - 1 - left_out) = on_face.weights.tail(count - 1 - left_out);
  }
  return result;
}

bool is_enclosed(const std::vector<std::array<std::int32_t, 3>>& triangles,
                 const std::vector<Vector3d>& points,
                 const Vector3d& x) {
  double angle = 0;  // the sum of the solid angles under which the triangles are seen
  for (const auto& triangle : triangles) {
    Matrix3d m;
    for (int c = 0; c < 3; ++c) {
      m.col(c) = points[static_cast<std::size_t>(triangle[static_cast<std::size_t>(c)])] - x;
    }
    const double a = m.col(0).norm(), b = m.col(1).norm(), c = m.col(2).norm();
    angle += 2 * std::atan2(m.determinant(), a * b * c + m.col(0).dot(m.col(1)) * c +
                                                 m.col(1).dot(m.col(2)) * a +
                                                 m.col(2).dot(m.col(0)) * b);
  }
  return angle > 2 * std::numbers::pi;
}

}  // namespace tetwarp::reference
