/// @file contact_system.cpp
/// Sends islands to their solvers, and takes impulses and velocities from them.
#include "host/simulate/solve/contact_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/solve/condensed/condensed_solver.hpp"
#include "host/simulate/solve/deformable_solver.hpp"
#include "host/simulate/solve/general_solver.hpp"
#include "host/simulate/solve/problem/contact_islands.hpp"
#include "host/simulate/solve/problem/contact_shares.hpp"
#include "host/simulate/solve/problem/step_laws.hpp"
#include "host/simulate/solve/problem/step_rows.hpp"
#include "host/simulate/solve/two_level/resident_two_level.hpp"
#include "host/simulate/step/resident_contacts.hpp"

namespace tetwarp {

struct ContactSystem::State {
  State(const SceneSurfaces& surfaces, const Model& of, const ContactSystemOptions& given)
      : scene(surfaces),
        model(of),
        options(given),
        rows(surfaces, of, given.solver.threads),
        islands(surfaces, of),
        laws(surfaces, given.recovery_fraction),
        factors(given.factors ? given.factors : std::make_shared<RestFactors>(of)),
        deformable_solver(surfaces, of, given.solver, factors),
        condensed_solver(given.solver, islands, *factors),
        general_solver(given.solver) {}

  void take_impulses(const ContactShare& share,
                     std::span<const double> impulse,
                     std::span<const double> velocity);
  void solve_soft(BodyStepper& stepper,
                  const ModelState& state,
                  const std::vector<Point3>& change,
                  std::vector<Point3>& velocity,
                  ContactSolveOutcome& outcome);
  void take_condensed(const CondensedSolver::Limits& limits,
                      BodyStepper& stepper,
                      ContactShare& share);
  bool solve_condensed(BodyStepper& stepper,
                       ContactShare& share,
                       std::vector<Point3>& velocity,
                       ContactSolveOutcome& outcome);
  void condense_cheap(BodyStepper& stepper,
                      std::vector<Point3>& velocity,
                      ContactSolveOutcome& outcome);
  bool condense_all(BodyStepper& stepper,
                    std::vector<Point3>& velocity,
                    ContactSolveOutcome& outcome);
  void solve_other(BodyStepper& stepper,
                   std::vector<Point3>& velocity,
                   ContactSolveOutcome& outcome);
  bool is_rounding(const std::vector<Point3>& velocity) const;
  bool stop_fast_turns(std::vector<Point3>& velocity);
  bool iterates_two_levels() const;

  const SceneSurfaces& scene;
  const Model& model;
  ContactSystemOptions options;
  StepRows rows;
  ContactIslands islands;
  StepLaws laws;
  ContactShares shares;
  std::shared_ptr<RestFactors> factors;
  DeformableSolver deformable_solver;
  CondensedSolver condensed_solver;
  GeneralSolver general_solver;
  bool is_resident = false;  ///< all velocities that contacts have changed are on the device
  ContactSolution solution;
  std::vector<Point3> impulses;            ///< [block_count]
  std::vector<Point3> velocity_before;     ///< without contact, [block_count]
  std::vector<Point3> condensed_velocity;  ///< of CondensedSolver, [block_count]
  bool has_condensing_failed = false;      ///< in this solve, at first
};

/// Whether the options leave the choice of the method.
bool ContactSystem::State::iterates_two_levels() const {
  return options.solver.backend != Backend::reference &&
         options.solver.method == ContactMethod::automatic &&
         options.solver.expert.coupling == ContactCoupling::automatic &&
         options.solver.measure == ContactMeasure::eta;
}

void ContactSystem::State::take_impulses(const ContactShare& share,
                                         std::span<const double> impulse,
                                         std::span<const double> velocity) {
  for (std::size_t k = 0; k < share.contacts.size(); ++k) {
    const std::size_t c = index_of(share.contacts[k]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      solution.impulse[3 * c + axis] = impulse[3 * k + axis];
      solution.velocity[3 * c + axis] = velocity[3 * k + axis];
    }
  }
}

void ContactSystem::State::solve_soft(BodyStepper& stepper,
                                      const ModelState& state,
                                      const std::vector<Point3>& change,
                                      std::vector<Point3>& velocity,
                                      ContactSolveOutcome& outcome) {
  if (shares.soft.is_empty()) return;
  const CoupledOutcome solved =
      deformable_solver.solve(stepper,
                              {state, islands, rows.sides(), rows.rows(), shares.soft.islands,
                               shares.soft.contacts, laws.problem(), change},
                              rows, velocity);
  outcome.outer_iterations += solved.outer_iterations;
  outcome.sweeps += solved.sweeps;
  if (!solved.converged && !solved.is_stopped && deformable_solver.resident() == nullptr &&
      condense_all(stepper, velocity, outcome)) {
    return;
  }
  if (!solved.is_result && solved.is_stopped) {
    outcome.converged = false;
    return;
  }
  if (!solved.is_result) {
    shares.other.take(shares.soft);  // the host has all rows
    return shares.soft.clear(islands.count());
  }
  outcome.converged = solved.converged;
  outcome.residual = std::max(outcome.residual, solved.residual);
  take_impulses(shares.soft, deformable_solver.impulse(), deformable_solver.contact_velocity());
}

/// Moves islands of the two-level iteration to a share of CondensedSolver.
void ContactSystem::State::take_condensed(const CondensedSolver::Limits& limits,
                                          BodyStepper& stepper,
                                          ContactShare& share) {
  condensed_solver.take(limits, stepper.system().rows, rows.rows(), laws.problem(), shares.soft,
                        share);
}

/// @returns whether a share of CondensedSolver has converged; else it is given back, and nothing
///          changes
bool ContactSystem::State::solve_condensed(BodyStepper& stepper,
                                           ContactShare& share,
                                           std::vector<Point3>& velocity,
                                           ContactSolveOutcome& outcome) {
  condensed_velocity = velocity;
  const ContactReport* const report = condensed_solver.solve(
      stepper.system(), rows.rows(), laws.problem(), share, condensed_velocity);
  if (report == nullptr || report->status != ContactStatus::converged) {
    shares.soft.take(share);
    share.clear(islands.count());
    return false;
  }
  velocity = condensed_velocity;
  outcome.residual = std::max(outcome.residual, report->residual.eta);
  outcome.sweeps += report->sweeps;
  take_impulses(share, condensed_solver.impulse(), condensed_solver.contact_velocity());
  return true;
}

/// Before the two-level iteration: by CondensedSolver, what costs it little.
void ContactSystem::State::condense_cheap(BodyStepper& stepper,
                                          std::vector<Point3>& velocity,
                                          ContactSolveOutcome& outcome) {
  has_condensing_failed = false;
  if (shares.soft.is_empty()) return;
  take_condensed(CondensedSolver::at_first, stepper, shares.condensed);
  if (shares.condensed.is_empty()) return;
  has_condensing_failed = !solve_condensed(stepper, shares.condensed, velocity, outcome);
}

/// Where the two-level iteration has failed: by CondensedSolver, if it takes all of its islands.
bool ContactSystem::State::condense_all(BodyStepper& stepper,
                                        std::vector<Point3>& velocity,
                                        ContactSolveOutcome& outcome) {
  if (has_condensing_failed) return false;
  ContactShare all;
  take_condensed(CondensedSolver::later, stepper, all);
  const bool is_all = shares.soft.is_empty();
  if (is_all && solve_condensed(stepper, all, velocity, outcome)) {
    shares.condensed.take(all);
    return true;
  }
  if (!is_all) shares.soft.take(all);
  return false;
}

void ContactSystem::State::solve_other(BodyStepper& stepper,
                                       std::vector<Point3>& velocity,
                                       ContactSolveOutcome& outcome) {
  if (shares.other.is_empty()) return;
  solution.report = general_solver.solve(stepper, islands, rows.rows(), shares.other.islands,
                                         shares.other.contacts, laws.problem(), velocity);
  take_impulses(shares.other, general_solver.impulse(), general_solver.contact_velocity());
  const ContactReport& report = solution.report;
  outcome.converged = outcome.converged && (solution.converged() || is_rounding(velocity));
  outcome.residual = std::max(outcome.residual, report.residual.eta);
  outcome.sweeps += report.sweeps;
  outcome.outer_iterations += report.outer_iterations;
}

/// Whether the contacts of the contact solver change velocities and approach by so little, relative
/// to the velocities of the bodies, that rounding of these exceeds the tolerance of eta, which is
/// relative to both. At most 1e-10, however tight the tolerance is.
bool ContactSystem::State::is_rounding(const std::vector<Point3>& velocity) const {
  double speed = 0, change = 0;
  for (std::int32_t b = 0; b < model.block_count(); ++b) {
    const bool is_angular = b >= model.node_count && (b - model.node_count) % 2 == 1;
    const std::int32_t island = islands.of_block(b);
    if (is_angular || island < 0 || shares.other.islands[index_of(island)] == 0) continue;
    const Point3 &after = velocity[index_of(b)], &before = velocity_before[index_of(b)];
    speed = std::max(speed, norm(after));
    change = std::max(change, norm(minus(after, before)));
  }
  constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();
  const double least = std::min(rounding / options.solver.tolerance, 1e-10) * speed;
  return change <= least && std::ranges::all_of(shares.other.contacts, [&](std::int32_t c) {
           return solution.velocity[3 * index_of(c)] >= -least;
         });
}

/// Stops rigid bodies that contacts turn by more than half a turn in the step: they stand still,
/// without impulses. The laws are linear in the velocities, and velocities that turn a body with
/// corners many times in a step can satisfy them where it has no room. @returns whether one stops
bool ContactSystem::State::stop_fast_turns(std::vector<Point3>& velocity) {
  const double most = std::acos(-1.0) / laws.problem().adhesion.time_step;
  std::vector<std::uint8_t> is_stopped;
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    const std::size_t block = index_of(model.node_count + 2 * r);
    const CollisionBody& parts = scene.surfaces.bodies[index_of(model.rigid.body[index_of(r)])];
    const Point3 &turn = velocity[block + 1], &before = velocity_before[block + 1];
    if (model.prescribed[block] != 0 || parts.first_triangle == parts.triangle_end) continue;
    if (!(norm(turn) > most && norm(minus(turn, before)) > most)) continue;
    velocity[block] = velocity[block + 1] = {0, 0, 0};
    is_stopped.resize(velocity.size(), 0);
    is_stopped[block] = 1;
  }
  if (is_stopped.empty()) return false;
  is_resident = false;
  rows.set_all();
  for (std::size_t c = 0; c < rows.sides().size(); ++c) {
    const auto blocks = rows.rows().blocks_of(c);
    if (std::ranges::any_of(blocks, [&](std::int32_t b) { return is_stopped[index_of(b)] != 0; })) {
      std::fill_n(solution.impulse.begin() + static_cast<std::ptrdiff_t>(3 * c), 3, 0.0);
    }
  }
  return true;
}

ContactSystem::ContactSystem(const SceneSurfaces& scene,
                             const Model& model,
                             const ContactSystemOptions& options)
    : state_(std::make_unique<State>(scene, model, options)) {}

ContactSystem::~ContactSystem() = default;

void ContactSystem::begin_part() {
  state_->laws.forget_impulses();
}

ContactSolveOutcome ContactSystem::solve(BodyStepper& stepper,
                                         const ModelState& state,
                                         const ContactTracker& tracker,
                                         const std::vector<TrackedContact>& contacts,
                                         std::vector<Point3>& velocity,
                                         std::vector<Point3>* change) {
  State& s = *state_;
  static const std::vector<Point3> none;
  s.velocity_before = velocity;
  s.rows.begin(state, contacts);
  s.islands.join(s.rows.sides());
  s.shares.divide(s.islands, s.iterates_two_levels(), s.options.skips_islands);
  const bool is_on_device = s.deformable_solver.begin(stepper, s.shares.soft);
  if (is_on_device) {
    s.rows.set_for_host(s.shares.soft.contacts);
  } else {
    s.rows.set_all();
  }
  s.laws.set(tracker, contacts, s.rows, velocity);
  s.solution.report = {};
  s.solution.impulse.assign(3 * contacts.size(), 0);
  s.solution.velocity = s.laws.problem().velocity_offset;  // of contacts that act on no unknown
  ContactSolveOutcome outcome;
  outcome.islands = s.islands.contact_island_count();
  const std::vector<Point3>& last_change =
      change != nullptr && change->size() == velocity.size() ? *change : none;
  if (!is_on_device) s.condense_cheap(stepper, velocity, outcome);
  s.solve_soft(stepper, state, last_change, velocity, outcome);
  s.solve_other(stepper, velocity, outcome);
  s.is_resident = s.shares.condensed.is_empty() &&
                  (s.shares.soft.is_empty() || s.deformable_solver.resident() != nullptr) &&
                  (s.shares.other.is_empty() || s.general_solver.resident() != nullptr);
  if (s.stop_fast_turns(velocity)) outcome.converged = false;
  s.laws.keep_impulses(contacts, s.solution.impulse);
  if (change != nullptr) *change = differences(velocity, s.velocity_before);
  s.rows.prescribed_impulses(s.solution.impulse, s.impulses);
  // The tracker computes gaps from these velocities: they are without the limit of recovery.
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    s.solution.velocity[3 * c] -= s.laws.recovered()[c];
  }
  return outcome;
}

void ContactSystem::set_velocities(const std::vector<Point3>& velocity,
                                   BodyStepper& stepper) const {
  const State& s = *state_;
  if (!s.is_resident) return stepper.set_velocities(velocity);
  if (!s.shares.soft.is_empty()) s.deformable_solver.resident()->set_velocities();
  if (!s.shares.other.is_empty()) s.general_solver.resident()->set_velocities();
}

const ContactSolution& ContactSystem::solution() const {
  return state_->solution;
}
const std::vector<Point3>& ContactSystem::block_impulses() const {
  return state_->impulses;
}

}  // namespace tetwarp
