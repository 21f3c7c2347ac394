/// @file lorentz_cone.hpp
/// Algebra of the Lorentz cone x_0 >= |(x_1, x_2)| for interior point methods.
///
/// Cones of one and two dimensions are embedded as vectors with zeros at the end; every operation
/// below keeps these zeros.
/// Source: Alizadeh, Goldfarb 2003.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace tetwarp::lorentz {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

/// x_0^2 - |x_1..|^2: positive inside the cone, 0 on its boundary.
inline double determinant(const Vector& x) {
  const double length = x.tail<2>().norm();
  return (x(0) - length) * (x(0) + length);
}

/// x o y = (x . y, x_0 y_1.. + y_0 x_1..).
inline Vector product(const Vector& x, const Vector& y) {
  Vector result = x(0) * y + y(0) * x;
  result(0) = x.dot(y);
  return result;
}

/// The y with product(x, y) = z.
inline Vector quotient(const Vector& z, const Vector& x) {
  Vector y;
  y(0) = (x(0) * z(0) - x.tail<2>().dot(z.tail<2>())) / determinant(x);
  y.tail<2>() = (z.tail<2>() - y(0) * x.tail<2>()) / x(0);
  return y;
}

/// The largest t for which x + t direction is in the cone; infinity if all are.
/// @pre x inside the cone
inline double distance_to_boundary(const Vector& x, const Vector& direction) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double distance = direction(0) < 0 ? -x(0) / direction(0) : infinity;
  // determinant(x + t direction) = a t^2 + 2 b t + c.
  const double a = determinant(direction), c = determinant(x);
  const double b = 2 * x(0) * direction(0) - x.dot(direction);
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return distance;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  for (const double t : {q / a, c / q}) {
    if (t > 0 && t < distance) distance = t;
  }
  return distance;
}

/// The scaling of Nesterov and Todd for x and y: the symmetric V that maps the cone onto itself
/// with V y = V^-1 x, and its inverse.
struct Scaling {
  Matrix forward;  ///< V
  Matrix inverse;  ///< V^-1
};

/// @pre x and y inside the cone
inline Scaling scaling_of(const Vector& x, const Vector& y) {
  const double norm_x = std::sqrt(determinant(x)), norm_y = std::sqrt(determinant(y));
  const Vector unit_x = x / norm_x;
  Vector unit_y = y / norm_y;
  const double middle = std::sqrt((1 + unit_x.dot(unit_y)) / 2);
  unit_y.tail<2>() *= -1;
  const Vector point = (unit_x + unit_y) / (2 * middle);
  const Eigen::Vector2d across = point.tail<2>();
  Matrix forward = Matrix::Identity();
  forward(0, 0) = point(0);
  forward.bottomRightCorner<2, 2>() += across * across.transpose() / (1 + point(0));
  Matrix inverse = forward;
  forward.topRightCorner<1, 2>() = across.transpose();
  forward.bottomLeftCorner<2, 1>() = across;
  inverse.topRightCorner<1, 2>() = -across.transpose();
  inverse.bottomLeftCorner<2, 1>() = -across;
  const double size = std::sqrt(norm_x / norm_y);
  return {size * forward, inverse / size};
}

}  // namespace tetwarp::lorentz
