/// @file cell_fields.cpp
/// Fields of tetrahedra for output: volume ratio and stress.
#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <tetwarp/simulate.hpp>

namespace tetwarp {
namespace {
Eigen::Vector3d vector_of(const Point3& point) {
  return {point[0], point[1], point[2]};
}

/// Calls visit(t, F) for every tetrahedron.
template <class Visit>
void for_each_gradient(const Simulator& simulator, std::size_t index, const Visit& visit) {
  const Mesh& mesh = simulator.body(index).mesh;
  const std::vector<Point3> world = simulator.node_positions(index);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    Eigen::Matrix3d rest, now;
    const auto first = static_cast<std::size_t>(mesh.tets[t][0]);
    for (int edge = 0; edge < 3; ++edge) {
      const auto node = static_cast<std::size_t>(mesh.tets[t][static_cast<std::size_t>(edge) + 1]);
      rest.col(edge) = vector_of(mesh.rest_positions[node]) - vector_of(mesh.rest_positions[first]);
      now.col(edge) = vector_of(world[node]) - vector_of(world[first]);
    }
    visit(t, Eigen::Matrix3d(now * rest.inverse()));
  }
}
}  // namespace

std::vector<double> Simulator::cell_jacobians(std::size_t index) const {
  std::vector<double> jacobians(body(index).mesh.tets.size());
  for_each_gradient(*this, index, [&](std::size_t t, const Eigen::Matrix3d& gradient) {
    jacobians[t] = gradient.determinant();
  });
  return jacobians;
}

// With the principal stretches s, the smallest one negative where F is inverted, the strain of the
// corotational law has the principal values s - 1 and the von Mises stress is
// 2 mu sqrt(((s1 - s2)^2 + (s2 - s3)^2 + (s3 - s1)^2) / 2).
std::vector<double> Simulator::cell_stresses(std::size_t index) const {
  const std::vector<double>& mu = body(index).shear_modulus;
  std::vector<double> stresses(body(index).mesh.tets.size());
  if (mu.size() != stresses.size()) return stresses;
  for_each_gradient(*this, index, [&](std::size_t t, const Eigen::Matrix3d& gradient) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares(gradient.transpose() * gradient,
                                                                 Eigen::EigenvaluesOnly);
    Eigen::Vector3d s = squares.eigenvalues().cwiseMax(0).cwiseSqrt();
    if (gradient.determinant() < 0) s[0] = -s[0];
    const double sum = (s[0] - s[1]) * (s[0] - s[1]) + (s[1] - s[2]) * (s[1] - s[2]) +
                       (s[2] - s[0]) * (s[2] - s[0]);
    stresses[t] = 2 * mu[t] * std::sqrt(0.5 * sum);
  });
  return stresses;
}

}  // namespace tetwarp
