/// @file tet_force.hpp
/// Stage "forces" of a step: rotation, stress and forces of linear corotational tetrahedra.
///
/// With F = sum x_a g_a^T and R its rotation, strain e = sym(R^T F) - 1 and stress 2 mu e + lambda
/// tr(e): f_a = -V R stress g_a is the exact gradient of V (mu |e|^2 + lambda / 2 tr(e)^2). Source:
/// Hauth and Strasser 2004.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/body/tet_rotation.hpp"

namespace tetwarp {

/// What the system matrix takes from a tetrahedron: its stiffness block of corners a and b is
/// volume_lambda ga gb^T + volume_mu (gb ga^T + (ga . gb) 1) with the turned gradients ga = R g_a.
struct TetTurned {
  double gradient[12];   ///< R g_a of corners 0 to 3 [1/m]
  double volume_lambda;  ///< [N m]
  double volume_mu;      ///< [N m]
  double gamma;          ///< damping [s]
  double unused;         ///< fills the struct to 128 bytes
};
/// Forces on the four corners, three numbers each [N].
struct TetForce {
  double corner[12];
};

/// Constants of tetrahedra, one array per number.
struct TetConstants {
  View<const std::int32_t> corner;                     ///< [4][tets] nodes
  View<const double> gradient;                         ///< [9][tets] g_1, g_2, g_3 [1/m]
  View<const double> volume_lambda, volume_mu, gamma;  ///< [tets]
  std::int64_t count = 0;
};

/// F = sum (x_a - x_0) g_a^T.
/// @param x  corners, [4][3]
/// @param g  g_1 to g_3, [3][3]
template <class Real>
TETWARP_HD void deformation_gradient(const Real* x, const Real* g, Real* f) {
  for (int i = 0; i < 3; ++i) {
    const Real d1 = x[3 + i] - x[i], d2 = x[6 + i] - x[i], d3 = x[9 + i] - x[i];
    for (int j = 0; j < 3; ++j) f[3 * i + j] = d1 * g[j] + d2 * g[3 + j] + d3 * g[6 + j];
  }
}

/// Energy V (mu |e|^2 + lambda / 2 tr(e)^2).
/// @param f, r  F and R
template <class Real>
TETWARP_HD Real corotated_energy(const Real* f, const Real* r, Real volume, Real lambda, Real mu) {
  const Real half = Real(0.5);
  Real s[9], square = Real(0.0), trace = Real(0.0);
  product3_transposed(r, f, s);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Real strain = half * (s[3 * i + j] + s[3 * j + i]) - Real(i == j ? 1.0 : 0.0);
      square = square + strain * strain;
      if (i == j) trace = trace + strain;
    }
  }
  return volume * (mu * square + half * lambda * trace * trace);
}

/// @param f, r     F and R
/// @param g        g_1 to g_3
/// @param turned   out: R g_a of corners 0 to 3, [4][3]
/// @param force    out: on corners 0 to 3, [4][3]
template <class Real>
TETWARP_HD void corotated_forces(
    const Real* f, const Real* r, const Real* g, Real lambda, Real mu, Real* turned, Real* force) {
  Real s[9], stress[9], turned_stress[9];
  product3_transposed(r, f, s);
  const Real one = Real(1.0);
  const Real trace = s[0] + s[4] + s[8] - Real(3.0);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) stress[3 * i + j] = mu * (s[3 * i + j] + s[3 * j + i]);
  }
  for (int i = 0; i < 9; i += 4) stress[i] = Real(2.0) * mu * (s[i] - one) + lambda * trace;
  product3(r, stress, turned_stress);
  for (int a = 1; a < 4; ++a) {
    multiply3(r, g + 3 * (a - 1), turned + 3 * a);
    multiply3(turned_stress, g + 3 * (a - 1), force + 3 * a);
  }
  for (int i = 0; i < 3; ++i) {
    turned[i] = -(turned[3 + i] + turned[6 + i] + turned[9 + i]);
    force[i] = force[3 + i] + force[6 + i] + force[9 + i];
    for (int a = 1; a < 4; ++a) force[3 * a + i] = -force[3 * a + i];
  }
}

/// One index = one tetrahedron. Writes its own entries; any order.
struct TetForceOp {
  TetConstants tets;
  View<const double> position;         ///< [nodes][3]
  View<const std::uint8_t> has_moved;  ///< [nodes] since the stage ran before
  bool skips;                          ///< leaves out tetrahedra whose nodes have not moved
  View<TetTurned> turned;              ///< in: of the stage before; out
  View<TetForce> force;                ///< out
  View<std::uint8_t> has_turned;       ///< out: whether an entry of `turned` has other bits
  View<std::uint8_t> is_skipped;       ///< out

  TETWARP_HD bool is_at_rest(std::int64_t t) const {
    bool moves = false;
    for (int a = 0; a < 4; ++a) moves |= has_moved[tets.corner[a * tets.count + t]] != 0;
    return skips && !moves;
  }
  /// @param gradient  turned gradients, `stride` numbers apart
  TETWARP_HD void store(std::int64_t t,
                        const double* gradient,
                        const double* forces,
                        int stride) const {
    TetTurned& own = turned[t];
    bool turns = false;
    for (int k = 0; k < 12; ++k) {
      const double value = gradient[k * stride];
      double& entry = own.gradient[k];
      turns |= entry != value;
      entry = value;
      force[t].corner[k] = forces[k * stride];
    }
    has_turned[t] = turns;
    is_skipped[t] = 0;
  }
  TETWARP_HD void skip(std::int64_t t) const {
    has_turned[t] = 0;
    is_skipped[t] = 1;
  }
  TETWARP_HD void operator()(std::int64_t t) const {
    if (is_at_rest(t)) return skip(t);
    double x[12], g[9], f[9], r[9], gradients[12], forces[12];
    for (int a = 0; a < 4; ++a) {
      const double* corner = position.data + 3 * std::int64_t{tets.corner[a * tets.count + t]};
      for (int i = 0; i < 3; ++i) x[3 * a + i] = corner[i];
    }
    for (int k = 0; k < 9; ++k) g[k] = tets.gradient[k * tets.count + t];
    deformation_gradient(x, g, f);
    tet_rotation(f, r);
    corotated_forces(f, r, g, tets.volume_lambda[t], tets.volume_mu[t], gradients, forces);
    store(t, gradients, forces, 1);
  }
};

/// Forces and turned gradients of all tetrahedra.
template <class Exec>
void tet_forces(Exec& exec, const char* label, const TetForceOp& op) {
  exec.for_each(label, op.tets.count, op);
}

}  // namespace tetwarp
