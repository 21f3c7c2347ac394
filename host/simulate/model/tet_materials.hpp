/// @file tet_materials.hpp
/// Moduli and masses of the tetrahedra of an elastic body.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Symmetric 4x4 masses of the nodes of a tetrahedron: 00 01 02 03 11 12 13 22 23 33 [kg].
using TetMass = std::array<double, 10>;

/// Of a uniform density: mass (1 + delta_ab) / 20.
TetMass uniform_mass(double mass);

/// Moduli and masses of tetrahedra. The elements in `tets` from `first_tet` on are those of the
/// body.
struct TetMaterials {
  std::vector<double> lambda, mu;  ///< [Pa]
  std::vector<TetMass> mass;
};
TetMaterials uniform_materials(const BodyPart& part, const ModelTets& tets, std::size_t first_tet);

}  // namespace tetwarp
