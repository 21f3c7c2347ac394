/// @file proximal_step.hpp
/// Accelerated proximal steps: every contact solves its law as if the others had no influence
/// beyond the majorant, all at once, from impulses that run ahead of the last ones.
///
/// Sources: Nesterov 1983, Beck and Teboulle 2009 (acceleration), O'Donoghue and Candes 2015
/// (restart where a step points back).
#pragma once
#include <cstdint>

#include "kernels/two_level/majorant.hpp"

namespace tetwarp {

/// Of an iteration, in memory of the device.
struct ProximalState {
  static constexpr int steps_at_once = 8;

  PlainSums<2> sums;     ///< at the last step: natural_square(); product of the step and the change
  std::int64_t age = 0;  ///< steps since the last restart, up to the present run of steps
};

/// One index = one contact.
struct ProximalStepBody {
  TouchingNodes of;
  View<const ContactConstants<double>> constants, majorant;
  ContactSwitches switches;
  View<const double> node_velocity;  ///< with the impulses `ahead`
  const ProximalState* state;
  int step;                  ///< of this run
  View<double> ahead;        ///< in and out, [3 contacts]
  View<double> impulse;      ///< in and out, [3 contacts]
  View<PlainSums<2>> terms;  ///< out of the last step of a run, [contacts]

  TETWARP_HD void operator()(std::int64_t contact) const {
    double u[3], r[3];
    for (int a = 0; a < 3; ++a) {
      u[a] = of.rows.offset[3 * contact + a];
      r[a] = ahead[3 * contact + a];
    }
    of.add_velocity(of.rows.block_start[contact], of.rows.block_start[contact + 1],
                    node_velocity.data, u);
    const ContactConstants<double>& own = constants[contact];
    const bool is_last = step + 1 == ProximalState::steps_at_once;
    PlainSums<2> sums;
    if (is_last) {
      sums.value[0] = natural_square(own, switches, normal_weight(own), tangent_weight(own), r, u);
    }
    solve_contact(majorant[contact], switches, u, r);
    const double age = static_cast<double>(state->age + step), momentum = age / (age + 3);
    for (int a = 0; a < 3; ++a) {
      const double change = r[a] - impulse[3 * contact + a];
      sums.value[1] += majorant[contact].block[4 * a] * (ahead[3 * contact + a] - r[a]) * change;
      ahead[3 * contact + a] = r[a] + momentum * change;
      impulse[3 * contact + a] = r[a];
    }
    if (is_last) terms[contact] = sums;
  }
};

/// One index = one node: J^T (ahead - before) in frames.
struct NodePushBody {
  TouchingNodes of;
  View<const double> ahead, before;  ///< [3 contacts]
  View<double> push;                 ///< out

  TETWARP_HD void operator()(std::int64_t node) const {
    const auto change = [this](std::int64_t block, int axis) {
      const std::int64_t place = 3 * std::int64_t{of.rows.contact[block]} + axis;
      return ahead[place] - before[place];
    };
    of.push_of(node, change, push.data + 3 * node);
  }
};

/// A single index, before the first step.
struct ProximalStartBody {
  ProximalState* state;

  TETWARP_HD void operator()(std::int64_t) const { *state = {}; }
};

/// A single index, after a run of steps: the momentum of the next one.
struct ProximalDecideBody {
  ProximalState* state;

  TETWARP_HD void operator()(std::int64_t) const {
    state->age = state->sums.value[1] > 0 ? 0 : state->age + ProximalState::steps_at_once;
  }
};

}  // namespace tetwarp
