/// @file hexahedron.hpp
/// Trilinear maps of the reference and their inverse, by continuation along a straight line from
/// the center, in float64. Independent of kernels/.
#pragma once
#include <Eigen/Dense>
#include <array>
#include <cstddef>

#include "host/reference/warp/exact_geometry.hpp"

namespace tetwarp::reference {

/// Eight corners in VTK's order.
using HexCorners = std::array<Quanta, 8>;

/// x(u) = sum of eight columns, each times a product of powers 0 or 1 of u, v and w.
class Trilinear {
 public:
  explicit Trilinear(const HexCorners& corners) {
    constexpr int place[8] = {0, 1, 3, 2, 4, 5, 7, 6};  // bits u, v, w of VTK's corners
    for (std::size_t a = 0; a < 8; ++a) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        coefficients_(static_cast<Eigen::Index>(axis), place[a]) =
            static_cast<double>(corners[a][axis]) / one_voxel;
      }
    }
    for (int bit = 1; bit < 8; bit *= 2) {  // takes differences along one axis after the other
      for (int power = 0; power < 8; ++power) {
        if (power & bit) coefficients_.col(power) -= coefficients_.col(power ^ bit);
      }
    }
  }

  Eigen::Vector3d at(const Eigen::Vector3d& u) const { return coefficients_ * powers(u, -1); }

  Eigen::Matrix3d gradient(const Eigen::Vector3d& u) const {
    Eigen::Matrix3d result;
    for (int axis = 0; axis < 3; ++axis) result.col(axis) = coefficients_ * powers(u, axis);
    return result;
  }

  /// Local coordinates of x, limited to [-0.25, 1.25].
  Eigen::Vector3d inverse(const Eigen::Vector3d& x) const {
    Eigen::Vector3d u = Eigen::Vector3d::Constant(0.5);
    const Eigen::Vector3d center = at(u);
    constexpr int stations = 8, corrections = 4;
    for (int station = 1; station <= stations; ++station) {
      const Eigen::Vector3d target =
          center + (x - center) * (static_cast<double>(station) / stations);
      for (int n = 0; n < corrections; ++n) u += gradient(u).partialPivLu().solve(target - at(u));
    }
    return u.cwiseMax(-0.25).cwiseMin(1.25);
  }

 private:
  /// The eight products, or their derivatives by coordinate `by`; -1: no derivative.
  static Eigen::Matrix<double, 8, 1> powers(const Eigen::Vector3d& u, int by) {
    Eigen::Matrix<double, 8, 1> result;
    for (int power = 0; power < 8; ++power) {
      result(power) = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const bool has = (power >> axis & 1) != 0;
        if (axis == by) {
          result(power) *= has ? 1 : 0;
        } else if (has) {
          result(power) *= u(axis);
        }
      }
    }
    return result;
  }

  Eigen::Matrix<double, 3, 8> coefficients_;
};

}  // namespace tetwarp::reference
