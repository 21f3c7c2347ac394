/// @file row_load.hpp
/// Stage "assembly" of a step: the right-hand side b = M v0 + dt F of each row. It has no term of
/// damping that is linear in the velocity: the terms with v0 cancel.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/body/block_assemble.hpp"

namespace tetwarp {

struct LoadInput {
  double gravity[3];                    ///< [m/s^2]
  View<const double> force;             ///< of loads, [blocks][3]
  View<const double> position;          ///< [nodes][3]
  View<const double> velocity;          ///< [blocks][3] at the start of the step
  View<const double> angular_momentum;  ///< [rigid][3]
  View<const double> node_mass;         ///< [nodes]
  std::int64_t node_count;
  View<const std::uint8_t> is_asleep;  ///< 1: the block is asleep, its b is 0; or empty
};

/// One index = one row, prescribed ones included. Writes its own numbers; any order.
struct RowLoadOp {
  SystemRows rows;
  ElementResults from;
  ScalarEntries scalars;
  RigidConstants rigid;
  LoadInput input;
  double time_step;
  View<double> load;  ///< out, [rows][3]

  TETWARP_HD void add_scalars(std::int64_t node, double* b) const {
    if (rows.scalar_start.size == 0) return;
    for (std::int64_t e = rows.scalar_start[node]; e < rows.scalar_start[node + 1]; ++e) {
      const std::int64_t other = scalars.column[e];
      for (int i = 0; i < 3; ++i) {
        b[i] += scalars.mass[e] * input.velocity[3 * other + i] -
                time_step * scalars.bend[e] * input.position[3 * other + i];
      }
    }
  }
  TETWARP_HD void add_elements(std::int64_t row, double* b) const {
    double force[3] = {};
    const ItemLists& tets = rows.tets.rows;
    for (std::int64_t k = tets.begin(row); k < tets.end(row); ++k) {
      const double* own = from.tet_forces[tets.item[k] >> 2].corner + 3 * (tets.item[k] & 3);
      for (int i = 0; i < 3; ++i) force[i] += own[i];
    }
    const ItemLists& edges = rows.edges.rows;
    for (std::int64_t k = edges.begin(row); k < edges.end(row); ++k) {
      const double sign = edges.item[k] % 2 == 0 ? 1 : -1;
      for (int i = 0; i < 3; ++i) force[i] += sign * from.edges[edges.item[k] >> 1].force[i];
    }
    for (int i = 0; i < 3; ++i) b[i] += time_step * force[i];
    const ItemLists& springs = rows.springs.rows;
    for (std::int64_t k = springs.begin(row); k < springs.end(row); ++k) {
      const unsigned item = springs.item[k];
      const SpringPull& pull = from.spring_pulls[item >> 3];
      double impulse[3];
      apply_transposed(slot_jacobian(from.springs[item >> 3], pull, item & 7), pull.impulse,
                       impulse);
      for (int i = 0; i < 3; ++i) b[i] += impulse[i];
    }
  }
  TETWARP_HD void operator()(std::int64_t row) const {
    const std::int64_t block = rows.block_of[row];
    if (input.is_asleep.size > 0 && input.is_asleep[block] != 0) {
      for (int i = 0; i < 3; ++i) load[3 * row + i] = 0;
      return;
    }
    double b[3], mass = 0;
    for (int i = 0; i < 3; ++i) b[i] = time_step * input.force[3 * block + i];
    if (block < input.node_count) {
      mass = input.node_mass[block];
      add_scalars(block, b);
    } else {
      const std::int64_t body = (block - input.node_count) / 2;
      const bool is_linear = (block - input.node_count) % 2 == 0;
      if (is_linear) mass = rigid.mass[body];
      for (int i = 0; i < 3; ++i) {
        b[i] +=
            is_linear ? mass * input.velocity[3 * block + i] : input.angular_momentum[3 * body + i];
      }
    }
    for (int i = 0; i < 3; ++i) b[i] += time_step * mass * input.gravity[i];
    add_elements(row, b);
    for (int i = 0; i < 3; ++i) load[3 * row + i] = b[i];
  }
};

}  // namespace tetwarp
