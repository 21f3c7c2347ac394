/// @file tet_materials.cpp
/// Moduli of E and nu, and masses, of tetrahedra of a uniform material.
#include "host/simulate/model/tet_materials.hpp"

#include <algorithm>

namespace tetwarp {

TetMass uniform_mass(double mass) {
  const double off = mass / 20, on = mass / 10;
  return {on, off, off, off, on, off, off, on, off, on};
}

TetMaterials uniform_materials(const BodyPart& part, const ModelTets& tets, std::size_t first_tet) {
  const auto [youngs, poisson, density] = part.body.material;
  const double lambda = youngs * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const double mu = youngs / (2 * (1 + poisson));
  TetMaterials materials;
  for (std::size_t t = 0; t < part.geometry.tets.size(); ++t) {
    const auto& fractions = part.geometry.tet_fraction;
    const double fraction = fractions.empty() ? 1 : fractions[t];
    const double stiff_fraction = std::max(fraction, 0.02);
    materials.lambda.push_back(lambda * stiff_fraction);
    materials.mu.push_back(mu * stiff_fraction);
    materials.mass.push_back(uniform_mass(density * tets.volume[first_tet + t] * fraction));
  }
  return materials;
}

}  // namespace tetwarp
