/// @file friction_cone.hpp
/// The projection on the cone of Coulomb's friction, and its derivative.
#pragma once
#include <Eigen/Core>

namespace tetwarp {

/// The point of { |x_t| <= mu x_n } nearest to x.
/// @param friction    mu
/// @param derivative  out: an element of the generalized derivative, symmetric; null: not wanted
inline Eigen::Vector3d project_on_cone(const Eigen::Vector3d& x,
                                       double friction,
                                       Eigen::Matrix3d* derivative = nullptr) {
  const double tangent = x.tail<2>().norm();
  // The polar cone first: without friction the cone is a ray, and x of an open contact is outside.
  if (friction * tangent <= -x(0)) {
    if (derivative != nullptr) derivative->setZero();
    return Eigen::Vector3d::Zero();
  }
  if (tangent <= friction * x(0)) {
    if (derivative != nullptr) derivative->setIdentity();
    return x;
  }
  const double share = 1 / (1 + friction * friction);
  const double normal = (friction * tangent + x(0)) * share;
  const double shrink = friction * normal / tangent;
  if (derivative != nullptr) {
    const Eigen::Vector2d slide = x.tail<2>() / tangent;
    Eigen::Vector3d edge(1, friction * slide(0), friction * slide(1));
    *derivative = share * edge * edge.transpose();
    derivative->bottomRightCorner<2, 2>() +=
        shrink * (Eigen::Matrix2d::Identity() - slide * slide.transpose());
  }
  return {normal, shrink * x(1), shrink * x(2)};
}

}  // namespace tetwarp
