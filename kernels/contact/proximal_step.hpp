/// @file proximal_step.hpp
/// Accelerated proximal steps: all contacts solve their laws at once, each with its majorant in
/// place of the influence of the others, from impulses extrapolated beyond the last ones.
///
/// Sources: Nesterov 1983, Beck and Teboulle 2009 (acceleration), O'Donoghue and Candes 2015
/// (restart where a step is directed back).
#pragma once
#include <cstdint>

#include "kernels/contact/majorant.hpp"

namespace tetwarp {

/// State of an iteration, in memory of the device.
struct ProximalState {
  static constexpr int steps_at_once = 8;

  /// Sums at the last step of a run, over contacts: natural_square(); product of the step and the
  /// change of impulses; d . J M^-1 J^T d, d . D d and r . D r, where r are the impulses `ahead`, d
  /// their change in the last step and D the majorant.
  using Sums = PlainSums<5>;

  Sums sums;
  std::int64_t age = 0;  ///< steps from the last restart to the start of the present run

  /// Whether the majorant is too small. The residual then need not diverge: normal impulses are
  /// never negative, so the iteration can oscillate instead. With momentum m, a mode grows if its
  /// product d . J M^-1 J^T d is more than (2 + 2 m) / (1 + 2 m) > 4/3 times d . D d. Changes that
  /// are small against the impulses are ignored, as their products are those of rounding errors.
  static bool has_missed(const Sums& sums) {
    constexpr double harmless = 1.3, least_square = 1e-16;
    return sums.value[2] > harmless * sums.value[3] && sums.value[3] > least_square * sums.value[4];
  }
};

/// One index = one contact. By lanes, which share its blocks.
struct ProximalStepOp {
  using Sum = PlainSums<3>;
  static constexpr int lanes = 4;

  TouchingNodes of;
  View<const ContactConstants<double>> constants, majorant;
  ContactSwitches switches;
  View<const double> node_velocity;  ///< of the nodes, for the impulses `ahead`
  const ProximalState* state;
  int step;              ///< of this run
  View<double> ahead;    ///< in and out, [3 contacts]
  View<double> impulse;  ///< in and out, [3 contacts]
  View<double> past;     ///< work, [contacts][6]: `ahead` and velocities, one step before the last
  View<ProximalState::Sums> terms;  ///< out, at the last step of a run, [contacts]

  TETWARP_HD Sum part(std::int64_t contact, int lane) const {
    Sum u;
    const std::int64_t end = of.rows.block_start[contact + 1];
    for (std::int64_t b = of.rows.block_start[contact] + lane; b < end; b += lanes) {
      of.add_velocity(b, b + 1, node_velocity.data, u.value);
    }
    return u;
  }
  TETWARP_HD void finish(std::int64_t contact, const Sum& moved) const {
    double u[3], r[3];
    for (int a = 0; a < 3; ++a) {
      u[a] = of.rows.offset[3 * contact + a] + moved.value[a];
      r[a] = ahead[3 * contact + a];
    }
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

/// One index = one node: J^T (ahead - before), in frames. By lanes: hundreds of contacts may act on
/// one node, that of a rigid body.
struct NodePushOp {
  using Sum = PlainSums<3>;
  static constexpr int lanes = 32;

  TouchingNodes of;
  View<const double> ahead, before;  ///< [3 contacts]
  View<double> push;                 ///< out

  TETWARP_HD Sum part(std::int64_t node, int lane) const {
    return of.push_part(node, lane, [this](std::int64_t block, int axis) {
      const std::int64_t place = 3 * std::int64_t{of.rows.contact[block]} + axis;
      return ahead[place] - before[place];
    });
  }
  TETWARP_HD void finish(std::int64_t node, const Sum& sum) const {
    for (int i = 0; i < 3; ++i) push[3 * node + i] = sum.value[i];
  }
};

/// A single index, before the first step.
struct ProximalStartOp {
  ProximalState* state;

  TETWARP_HD void operator()(std::int64_t) const { *state = {}; }
};

/// A single index, after a run of steps: the momentum of the next one.
struct ProximalDecideOp {
  ProximalState* state;

  TETWARP_HD void operator()(std::int64_t) const {
    state->age = state->sums.value[1] > 0 ? 0 : state->age + ProximalState::steps_at_once;
  }
};

}  // namespace tetwarp
