/// @file block_assemble.hpp
/// Stage "assembly" of a step: each 3x3 block of A sums what elements contribute to it, in index
/// order.
///
/// A = M (1 + dt alpha) + (dt^2 + dt gamma) K + (dt^2 k + dt c) J^T J + dt^2 K of turning arms.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/body/edge_spring.hpp"
#include "kernels/body/point_spring.hpp"
#include "kernels/body/system_lists.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {

/// Entries that are multiples of the unit matrix and do not change, as ModelScalarBlocks.
struct ScalarEntries {
  View<const std::int32_t> column;  ///< node
  View<const double> mass, mass_alpha, bend, bend_gamma;
};

struct RigidConstants {
  View<const double> mass, alpha;  ///< [rigid]
  View<const double> inertia;      ///< [rigid][9] of RigidMidpointOp
};

/// Contributions of elements, computed by the stages before.
struct ElementResults {
  View<const TetTurned> tets;
  View<const TetForce> tet_forces;
  View<const std::uint8_t> tet_has_turned;
  View<const EdgePull> edges;
  View<const double> edge_gamma;
  View<const std::uint8_t> edge_has_turned;
  View<const SpringConstants> springs;
  View<const SpringPull> spring_pulls;
};

/// Three numbers; executors with vectors use another type with the same functions.
struct Triple {
  double v[3] = {};

  TETWARP_HD static Triple loaded(const double* from) { return {{from[0], from[1], from[2]}}; }
  TETWARP_HD void store(double* to) const {
    for (int i = 0; i < 3; ++i) to[i] = v[i];
  }
  /// *this += a x + b y.
  TETWARP_HD void add(const Triple& a, double x, const Triple& b, double y) {
    for (int i = 0; i < 3; ++i) v[i] += a.v[i] * x + b.v[i] * y;
  }
};

/// Sum of stiffness blocks of tetrahedra.
template <class Column>
struct TetBlockSum {
  Column column[3];
  double shear = 0;  ///< multiple of the unit matrix

  /// Adds (dt^2 + dt gamma) K_ab of a tetrahedron.
  TETWARP_HD void add(const TetTurned& tet, int a, int b, double dt) {
    const double scale = dt * (dt + tet.gamma);
    const double lambda = scale * tet.volume_lambda, mu = scale * tet.volume_mu;
    const double *ga = tet.gradient + 3 * a, *gb = tet.gradient + 3 * b;
    const Column along = Column::loaded(ga), across = Column::loaded(gb);
    for (int j = 0; j < 3; ++j) column[j].add(along, lambda * gb[j], across, mu * ga[j]);
    shear += mu * dot3(ga, gb);
  }
  /// Writes a column-major block.
  TETWARP_HD void store(double* block) const {
    for (int j = 0; j < 3; ++j) column[j].store(block + 3 * j);
    for (int j = 0; j < 3; ++j) block[4 * j] += shear;
  }
};

/// Adds `scale` times the stiffness of an edge to a block.
TETWARP_HD void add_edge_block(const EdgePull& edge, double scale, double* block) {
  for (int j = 0, at = 0; j < 3; ++j) {
    for (int i = j; i < 3; ++i, ++at) {
      block[3 * j + i] += scale * edge.block[at];
      if (i != j) block[3 * i + j] += scale * edge.block[at];
    }
  }
}

/// Adds factor J_i^T J_j of a spring, and what its turning arm adds, to a column-major block.
TETWARP_HD void add_spring_block(const SpringConstants& spring,
                                 const SpringPull& pull,
                                 int slot_i,
                                 int slot_j,
                                 double dt,
                                 double* block) {
  const SlotJacobian row = slot_jacobian(spring, pull, slot_i);
  const SlotJacobian column = slot_jacobian(spring, pull, slot_j);
  for (int j = 0; j < 3; ++j) {
    // Column j of J_j is -weight lever x e_j or weight e_j.
    const double axis[3] = {j == 0 ? 1.0 : 0.0, j == 1 ? 1.0 : 0.0, j == 2 ? 1.0 : 0.0};
    double moved[3] = {axis[0], axis[1], axis[2]}, back[3];
    if (column.lever != nullptr) cross3(axis, column.lever, moved);
    apply_transposed(row, moved, back);
    for (int i = 0; i < 3; ++i) block[3 * j + i] += pull.factor * column.weight * back[i];
  }
  if (slot_i != slot_j || column.lever == nullptr) return;
  double on_point[3];
  for (int i = 0; i < 3; ++i) on_point[i] = column.weight * pull.impulse[i];
  add_arm_block(column.lever, on_point, dt, block);
}

/// One index = one block on or above the diagonal. Writes it and its mirror image; any order.
template <class Column>
struct BlockAssembleOpOf {
  SystemRows rows;
  ElementResults from;
  ScalarEntries scalars;
  RigidConstants rigid;
  double time_step;
  bool skips;  ///< leaves out blocks whose elements have not changed since they were assembled
  View<double> values;            ///< in, out: column-major blocks, [places][9]
  View<std::uint8_t> is_skipped;  ///< out, [upper blocks]

  TETWARP_HD bool is_at_rest(const UpperBlock& own, std::int64_t k) const {
    if (own.rigid >= 0 || !rows.springs.blocks.is_empty(k)) return false;
    const ItemLists &tets = rows.tets.blocks, &edges = rows.edges.blocks;
    bool turns = false;
    for (std::int64_t i = tets.begin(k); i < tets.end(k); ++i) {
      turns |= from.tet_has_turned[tets.item[i] >> 4] != 0;
    }
    for (std::int64_t i = edges.begin(k); i < edges.end(k); ++i) {
      turns |= from.edge_has_turned[edges.item[i] >> 2] != 0;
    }
    return !turns;
  }
  TETWARP_HD void add_constant(const UpperBlock& own, double* block) const {
    const double dt = time_step;
    if (own.scalar >= 0) {
      const double sum = scalars.mass[own.scalar] + dt * scalars.mass_alpha[own.scalar] +
                         dt * (dt * scalars.bend[own.scalar] + scalars.bend_gamma[own.scalar]);
      for (int i = 0; i < 3; ++i) block[4 * i] += sum;
    }
    if (own.rigid < 0) return;
    const std::int64_t b = own.rigid / 2;
    const double damped = 1 + dt * rigid.alpha[b];
    for (int i = 0; i < 9; ++i) {
      const double linear = i % 4 == 0 ? rigid.mass[b] : 0;
      block[i] += damped * (own.rigid % 2 == 0 ? linear : rigid.inertia[9 * b + i]);
    }
  }
  TETWARP_HD void operator()(std::int64_t k) const {
    const UpperBlock own = rows.upper[k];
    is_skipped[k] = skips && is_at_rest(own, k);
    if (is_skipped[k]) return;
    double block[9];
    TetBlockSum<Column> elastic;
    const ItemLists& tets = rows.tets.blocks;
    for (std::int64_t i = tets.begin(k); i < tets.end(k); ++i) {
      const unsigned item = tets.item[i];
      elastic.add(from.tets[item >> 4], item >> 2 & 3, item & 3, time_step);
    }
    elastic.store(block);
    add_constant(own, block);
    const ItemLists& edges = rows.edges.blocks;
    for (std::int64_t i = edges.begin(k); i < edges.end(k); ++i) {
      const unsigned item = edges.item[i];
      const std::int64_t edge = item >> 2;
      const double scale = time_step * (time_step + from.edge_gamma[edge]);
      const bool is_diagonal = (item >> 1 & 1) == (item & 1);
      add_edge_block(from.edges[edge], is_diagonal ? scale : -scale, block);
    }
    const ItemLists& springs = rows.springs.blocks;
    for (std::int64_t i = springs.begin(k); i < springs.end(k); ++i) {
      const unsigned item = springs.item[i];
      add_spring_block(from.springs[item >> 6], from.spring_pulls[item >> 6], item >> 3 & 7,
                       item & 7, time_step, block);
    }
    double* const at = values.data + 9 * std::int64_t{own.place};
    double* const mirror = values.data + 9 * std::int64_t{own.mirror};
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        at[3 * j + i] = block[3 * j + i];
        mirror[3 * i + j] = block[3 * j + i];
      }
    }
  }
};

using BlockAssembleOp = BlockAssembleOpOf<Triple>;

/// All blocks of the system.
template <class Exec>
void block_assemble(Exec& exec, const char* label, const BlockAssembleOp& op) {
  exec.for_each(label, op.rows.upper.size, op);
}

}  // namespace tetwarp
