/// @file tet_strain.hpp
/// Stage "fields" of the warp, per tetrahedron: deformation gradient and strain, once per step.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/tet_gradient.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// The deformation gradient F = d deformed / d rest of one tetrahedron in world axes, its
/// determinant and the Green-Lagrange strain.
struct TetStrain {
  float jacobian;     ///< det F: negative when inverted
  float gradient[9];  ///< F, row major
  float strain[6];    ///< (F^T F - I) / 2: XX YY ZZ XY YZ XZ
};

/// @param backward  the inverse of F
TETWARP_HD TetStrain strain_of(const Matrix3& backward) {
  const Matrix3 gradient = inverse(backward);
  const Matrix3 square = transposed(gradient) * gradient;
  TetStrain strain;
  strain.jacobian = static_cast<float>(determinant(gradient));
  for (int row = 0; row < 3; ++row) {
    const int next = (row + 1) % 3;
    for (int column = 0; column < 3; ++column) {
      strain.gradient[3 * row + column] = static_cast<float>(gradient.at[row][column]);
    }
    strain.strain[row] = static_cast<float>((square.at[row][row] - 1) / 2);
    strain.strain[3 + row] = static_cast<float>(square.at[row][next] / 2);
  }
  return strain;
}

/// One index = one tetrahedron; any order. Tetrahedra that are flat or bad get zeros.
struct TetStrainOp {
  View<const TetSetup> setups;
  GridAxes axes;
  View<TetStrain> strains;

  TETWARP_HD void operator()(std::int64_t t) const {
    const TetSetup& setup = setups[t];
    TetStrain strain = {};
    if (setup.tet_class == TetClass::regular || setup.tet_class == TetClass::inverted) {
      strain = strain_of(backward_gradient(setup, axes));
    }
    strains[t] = strain;
  }
};

/// Gradient, Jacobian determinant and Green-Lagrange strain of every tetrahedron.
///
/// @param exec     where to run
/// @param setups   from tet_setup(), shape [tet_count]
/// @param axes     of source and output grid
/// @param strains  out, shape [tet_count]
///
/// Determinism: within 2^-23 relative of the gradient between back ends. Cost: 64 bytes written and
/// about 150 operations per tetrahedron.
/// Source: the definitions of continuum mechanics.
template <class Exec>
void tet_strain(Exec& exec,
                View<const TetSetup> setups,
                const GridAxes& axes,
                View<TetStrain> strains) {
  exec.for_each("warp/fields", strains.size, TetStrainOp{setups, axes, strains});
}

}  // namespace tetwarp
