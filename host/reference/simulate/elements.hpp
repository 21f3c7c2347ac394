/// @file elements.hpp
/// Corotational linear tetrahedra: with F = sum x_a g_a^T and R the rotation of its polar
/// decomposition, strain e = sym(R^T F) - 1, stress s = 2 mu e + lambda tr(e) 1, force
/// f_a = -V R s g_a, energy V (mu |e|^2 + lambda/2 tr(e)^2).
#pragma once
#include "host/reference/simulate/vectors.hpp"

namespace tetwarp::reference {

struct Element {
  std::array<int, 4> nodes{};  ///< of all nodes of the scene
  Matrix34 gradients;          ///< columns g_a [1/m]
  double volume = 0;           ///< [m^3]
  double lambda = 0, mu = 0;   ///< [Pa]
};

/// Gradients and volume of a tetrahedron at rest, columns of `rest` its nodes.
Element element_of(const std::array<int, 4>& nodes, const Matrix34& rest);

/// lambda and mu of E and nu.
std::array<double, 2> lame_of(double youngs_modulus, double poissons_ratio);

/// Forces on the nodes, columns; `positions` are those of the nodes now.
Matrix34 element_force(const Element& element, const Matrix34& positions);

/// -d force / d positions with R held, for unknowns ordered x y z of node 0, of node 1, ...
Eigen::Matrix<double, 12, 12> element_stiffness(const Element& element, const Matrix34& positions);

double element_energy(const Element& element, const Matrix34& positions);

}  // namespace tetwarp::reference
