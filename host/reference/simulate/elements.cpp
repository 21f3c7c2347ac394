/// @file elements.cpp
/// Strain, stress, force, stiffness and energy of one element.
#include "host/reference/simulate/elements.hpp"

#include "host/reference/linear/polar_rotation.hpp"

namespace tetwarp::reference {
namespace {

Matrix3d strain_of(const Matrix3d& rotation, const Matrix3d& deformation) {
  const Matrix3d stretch = rotation.transpose() * deformation;
  return 0.5 * (stretch + stretch.transpose()) - Matrix3d::Identity();
}

Matrix3d stress_of(const Element& element, const Matrix3d& strain) {
  return 2 * element.mu * strain + element.lambda * strain.trace() * Matrix3d::Identity();
}

}  // namespace

Element element_of(const std::array<int, 4>& nodes, const Matrix34& rest) {
  Matrix3d edges;
  for (int a = 1; a < 4; ++a) edges.col(a - 1) = rest.col(a) - rest.col(0);
  Element element;
  element.nodes = nodes;
  element.volume = edges.determinant() / 6;
  element.gradients.rightCols<3>() = edges.inverse().transpose();
  element.gradients.col(0) = -element.gradients.rightCols<3>().rowwise().sum();
  return element;
}

std::array<double, 2> lame_of(double youngs_modulus, double poissons_ratio) {
  return {
      youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio)),
      youngs_modulus / (2 * (1 + poissons_ratio)),
  };
}

Matrix34 element_force(const Element& element, const Matrix34& positions) {
  const Matrix3d deformation = positions * element.gradients.transpose();
  const Matrix3d rotation = polar_rotation(deformation);
  const Matrix3d stress = stress_of(element, strain_of(rotation, deformation));
  return -element.volume * rotation * stress * element.gradients;
}

Eigen::Matrix<double, 12, 12> element_stiffness(const Element& element, const Matrix34& positions) {
  const Matrix3d rotation = polar_rotation(positions * element.gradients.transpose());
  Eigen::Matrix<double, 12, 12> stiffness;
  for (int column = 0; column < 12; ++column) {
    Matrix34 displacement = Matrix34::Zero();
    displacement(column % 3, column / 3) = 1;
    const Matrix3d turned = rotation.transpose() * displacement * element.gradients.transpose();
    const Matrix3d stress = stress_of(element, 0.5 * (turned + turned.transpose()));
    const Matrix34 force = element.volume * rotation * stress * element.gradients;
    stiffness.col(column) = Eigen::Map<const Eigen::Matrix<double, 12, 1>>(force.data());
  }
  return stiffness;
}

double element_energy(const Element& element, const Matrix34& positions) {
  const Matrix3d deformation = positions * element.gradients.transpose();
  const Matrix3d strain = strain_of(polar_rotation(deformation), deformation);
  return element.volume *
         (element.mu * strain.squaredNorm() + element.lambda / 2 * std::pow(strain.trace(), 2));
}

}  // namespace tetwarp::reference
