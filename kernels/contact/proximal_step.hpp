/// @file proximal_step.hpp
/// Accelerated proximal steps: every contact solves its law as if the others had no influence
/// beyond the majorant, all at once, from impulses that run ahead of the last ones.
///
/// Sources: Nesterov 1983, Beck and Teboulle 2009 (acceleration), O'Donoghue and Candes 2015
/// (restart where a step points back).
#pragma once
#include <cstdint>

#include "kernels/contact/majorant.hpp"

namespace tetwarp {

/// Of an iteration, in memory of the device.
struct ProximalState {
  static constexpr int steps_at_once = 8;

  /// At the last step: natural_square(); product of the step and the change; d . J M^-1 J^T d,
  /// d . D d and r . D r, d the change of the impulses `ahead` r since the step before and D the
  /// majorant.
  using Sums = PlainSums<5>;

  Sums sums;
  std::int64_t age = 0;  ///< steps since the last restart, up to the present run of steps

  /// Whether the majorant is too small. The impulses need not diverge then: as none along a normal
  /// may be negative, they can go to and fro for ever. With momentum m, a mode grows whose product
  /// is more than (2 + 2 m) / (1 + 2 m) > 4/3 times that of the majorant. The products of changes
  /// that are small beside the impulses are those of roundings.
  static bool has_missed(const Sums& sums) {
    constexpr double harmless = 1.3, least_square = 1e-16;
    return sums.value[2] > harmless * sums.value[3] && sums.value[3] > least_square * sums.value[4];
  }
};

/// One index = one contact.
struct ProximalStepBody {
  TouchingNodes of;
  View<const ContactConstants<double>> constants, majorant;
  ContactSwitches switches;
  View<const double> node_velocity;  ///< with the impulses `ahead`
  const ProximalState* state;
  int step;              ///< of this run
  View<double> ahead;    ///< in and out, [3 contacts]
  View<double> impulse;  ///< in and out, [3 contacts]
  View<double> past;     ///< work, [contacts][6]: `ahead` and velocities at the last step but one
  View<ProximalState::Sums> terms;  ///< out of the last step of a run, [contacts]

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
    ProximalState::Sums sums;
    if (step + 2 == ProximalState::steps_at_once) keep(contact, r, u);
    if (is_last) {
      sums.value[0] = natural_square(own, switches, normal_weight(own), tangent_weight(own), r, u);
      add_curvature(contact, r, u, sums);
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

 private:
  TETWARP_HD void keep(std::int64_t contact, const double* r, const double* u) const {
    for (int a = 0; a < 3; ++a) {
      past[6 * contact + a] = r[a];
      past[6 * contact + 3 + a] = u[a];
    }
  }
  TETWARP_HD void add_curvature(std::int64_t contact,
                                const double* r,
                                const double* u,
                                ProximalState::Sums& sums) const {
    const ContactConstants<double>& own = majorant[contact];
    for (int a = 0; a < 3; ++a) {
      const double change = r[a] - past[6 * contact + a];
      const bool has_own = a == 0 || switches.pyramid;  // as solve_contact() takes it
      const double weight = has_own ? own.block[4 * a] : own.tangent_metric;
      sums.value[2] += change * (u[a] - past[6 * contact + 3 + a]);
      sums.value[3] += change * change * weight;
      sums.value[4] += r[a] * r[a] * weight;
    }
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
