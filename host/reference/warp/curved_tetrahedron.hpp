/// @file curved_tetrahedron.hpp
/// Quadratic maps of the reference, by the shape functions of ten nodes, and their inverse, by
/// continuation from straight to curved edges, in float64. Independent of kernels/.
#pragma once
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "host/reference/warp/exact_geometry.hpp"

namespace tetwarp::reference {

/// Corners, then middles of the edges in VTK's order.
using TenQuanta = std::array<Quanta, 10>;

constexpr Eigen::Index edge_ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

/// Whether all middle nodes are within a quantum of the middles of their edges along each axis.
inline bool has_straight_edges(const TenQuanta& nodes) {
  for (std::size_t e = 0; e < 6; ++e) {
    const Quanta& a = nodes[static_cast<std::size_t>(edge_ends[e][0])];
    const Quanta& b = nodes[static_cast<std::size_t>(edge_ends[e][1])];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double middle = (static_cast<double>(a[axis]) + static_cast<double>(b[axis])) / 2;
      if (std::abs(static_cast<double>(nodes[4 + e][axis]) - middle) > 1) return false;
    }
  }
  return true;
}

/// x = sum of ten nodes times shape functions of the four barycentric coordinates L, which are
/// L (2 L - 1) of corners and 4 L L' of the middles of edges.
class QuadraticTetrahedron {
 public:
  using Nodes = Eigen::Matrix<double, 3, 10>;

  explicit QuadraticTetrahedron(const Nodes& nodes) : nodes_(nodes) {}
  explicit QuadraticTetrahedron(const TenQuanta& nodes) {
    for (std::size_t n = 0; n < 10; ++n) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        nodes_(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(n)) =
            static_cast<double>(nodes[n][axis]) / one_voxel;
      }
    }
  }

  Eigen::Vector3d at(const Eigen::Vector4d& l) const {
    Eigen::Matrix<double, 10, 1> shape;
    for (Eigen::Index a = 0; a < 4; ++a) shape(a) = l(a) * (2 * l(a) - 1);
    for (Eigen::Index e = 0; e < 6; ++e) {
      shape(4 + e) = 4 * l(edge_ends[e][0]) * l(edge_ends[e][1]);
    }
    return nodes_ * shape;
  }

  /// Derivatives by L_1, L_2, L_3, with L_0 = 1 - L_1 - L_2 - L_3.
  Eigen::Matrix3d gradient(const Eigen::Vector4d& l) const {
    Eigen::Matrix<double, 10, 4> by = Eigen::Matrix<double, 10, 4>::Zero();
    for (Eigen::Index a = 0; a < 4; ++a) by(a, a) = 4 * l(a) - 1;
    for (Eigen::Index e = 0; e < 6; ++e) {
      by(4 + e, edge_ends[e][0]) = 4 * l(edge_ends[e][1]);
      by(4 + e, edge_ends[e][1]) = 4 * l(edge_ends[e][0]);
    }
    const Eigen::Matrix<double, 3, 4> all = nodes_ * by;
    return all.rightCols<3>().colwise() - all.col(0);
  }

  /// Coordinates of x, if the map has them: found within 2^-24 of x, in the tetrahedron or a
  /// quarter beyond it, where the map has the orientation of the corners.
  /// @param straight  those of x in the tetrahedron of the corners
  std::optional<Eigen::Vector4d> inverse(const Eigen::Vector3d& x,
                                         const Eigen::Vector4d& straight) const {
    Nodes unbent = nodes_;
    for (Eigen::Index e = 0; e < 6; ++e) {
      unbent.col(4 + e) = (nodes_.col(edge_ends[e][0]) + nodes_.col(edge_ends[e][1])) / 2;
    }
    Eigen::Vector4d l = straight;
    constexpr int stations = 16, corrections = 6;
    for (int station = 1; station <= stations; ++station) {
      const double share = static_cast<double>(station) / stations;
      const QuadraticTetrahedron bent(Nodes(unbent + share * (nodes_ - unbent)));
      for (int n = 0; n < corrections; ++n) {
        const Eigen::Vector3d step = bent.gradient(l).partialPivLu().solve(x - bent.at(l));
        l += Eigen::Vector4d(-step.sum(), step(0), step(1), step(2));
      }
    }
    const double turned = gradient(l).determinant();
    const double turned_straight = QuadraticTetrahedron(unbent).gradient(straight).determinant();
    const bool is_sound = (at(l) - x).cwiseAbs().maxCoeff() <= 0x1p-24 && l.minCoeff() >= -0.25 &&
                          turned * turned_straight > 0;
    if (!is_sound) return std::nullopt;
    return l;
  }

 private:
  Nodes nodes_;
};

}  // namespace tetwarp::reference
