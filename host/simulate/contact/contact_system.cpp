#include "host/simulate/contact/contact_system.hpp"
#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

#include <algorithm>
#include <cmath>

#include "host/simulate/contact/contact_islands.hpp"
#include "host/simulate/contact/contact_laws.hpp"
#include "host/simulate/contact/contact_rows.hpp"
#include "host/simulate/contact/contact_shares.hpp"
#include "host/simulate/contact/resident_two_level.hpp"
#include "host/simulate/contact/soft_islands.hpp"
#include "host/simulate/contact/solver_islands.hpp"
#include "host/simulate/resident_contacts.hpp"

namespace tetwarp {

struct ContactSystem::State {
  State(const SceneSurfaces& surfaces, const Model& of, const ContactSystemOptions& given)
      : scene(surfaces),
        model(of),
        options(given),
        frames(frames_of_bodies(surfaces, of)),
        islands(of),
        soft_islands(of, given.solver, given.factors),
        solver_islands(given.solver) {}

  void set_laws(const ContactTracker& tracker,
                const std::vector<TrackedContact>& contacts,
                const std::vector<Point3>& velocity);
  void set_bond(const TrackedContact& contact, std::size_t c);
  void take_impulses(const ContactShare& share,
                     std::span<const double> impulse,
                     std::span<const double> velocity);
  void solve_soft(BodyStepper& stepper,
                  const ModelState& state,
                  const std::vector<Point3>& change,
                  std::vector<Point3>& velocity,
                  ContactSolveOutcome& outcome);
  void solve_other(BodyStepper& stepper,
                   std::vector<Point3>& velocity,
                   ContactSolveOutcome& outcome);
  void add_block_impulses();
  bool stop_fast_turns(std::vector<Point3>& velocity);
  double recovery_speed(const ContactKey& key) const;
  bool iterates_two_levels() const;

  const SceneSurfaces& scene;
  const Model& model;
  ContactSystemOptions options;
  std::vector<std::int32_t> frames;  ///< [bodies, then obstacles]
  ContactRows rows;
  ContactIslands islands;
  ContactProblem laws;  ///< friction, offsets, adhesion, guess; no matrices
  ContactShares shares;
  SoftIslands soft_islands;
  SolverIslands solver_islands;
  bool is_resident = false;  ///< all velocities that contacts have changed are on the device
  ResidentTwoLevel* resident_soft = nullptr;   ///< or null: none there
  ResidentContacts* resident_other = nullptr;  ///< or null: none there
  std::vector<double> prescribed;  ///< [3 contacts] J_p v_p of prescribed velocities v_p
  std::vector<double> recovered;   ///< [contacts] normal offset that was added to slow recovery, or
                                   ///< because only a bond is left
  ContactSolution solution;
  std::vector<Point3> impulses;         ///< [block_count]
  std::vector<Point3> velocity_before;  ///< without contact, [block_count]
};

/// Whether the options leave the choice of the method.
bool ContactSystem::State::iterates_two_levels() const {
  return options.solver.backend != Backend::reference &&
         options.solver.method == ContactMethod::automatic &&
         options.solver.coupling == ContactCoupling::automatic &&
         options.solver.measure == ContactMeasure::eta;
}

double ContactSystem::State::recovery_speed(const ContactKey& key) const {
  return options.recovery_fraction *
         std::min(scene.body_size[index_of(key.body_a)], scene.body_size[index_of(key.body_b)]);
}

/// A contact that is not reported is a bond of surfaces that do not touch. As far as its ends are
/// apart sideways, these pass each other without pushing. One whose normal has turned away, so that
/// its ends seem to overlap, does nothing along it: pushing would oppose what does touch there.
void ContactSystem::State::set_bond(const TrackedContact& contact, std::size_t c) {
  double way = std::hypot(contact.gap[1], contact.gap[2]);
  if (contact.gap[0] < 0) way += scene.surfaces.thickness - 2 * contact.gap[0];
  if (contact.gap[0] <= 0) laws.adhesion.stiffness[c] = 0;
  recovered[c] = std::max(recovered[c], way / laws.adhesion.time_step);
}

/// The laws of all contacts. Adds the velocities of prescribed blocks to the offsets, and limits
/// the normal ones, from which existing penetration is undone within the step.
void ContactSystem::State::set_laws(const ContactTracker& tracker,
                                    const std::vector<TrackedContact>& contacts,
                                    const std::vector<Point3>& velocity) {
  tracker.fill(laws);
  const double time_step = laws.adhesion.time_step;
  prescribed.assign(3 * contacts.size(), 0);
  recovered.assign(contacts.size(), 0);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    for (std::int32_t e = rows.start[c]; e < rows.start[c + 1]; ++e) {
      const std::int32_t block = rows.block[index_of(e)];
      if (model.prescribed[index_of(block)] == 0) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i) {
          prescribed[3 * c + k] +=
              rows.value[index_of(e)][3 * k + i] * velocity[index_of(block)][i];
        }
      }
    }
    const TrackedContact& contact = contacts[c];
    const double closing = contact.gap[0] / time_step, limit = -recovery_speed(contact.key);
    const bool rebounds = contact.rebound_speed > 0 && -contact.rebound_speed <= closing;
    if (closing < limit && !rebounds) {
      const double slowest =
          contact.rebound_speed > 0 ? std::min(limit, -contact.rebound_speed) : limit;
      recovered[c] = std::max(slowest - closing, 0.0);
    }
    if (!contact.is_reported) set_bond(contact, c);
    laws.velocity_offset[3 * c] += recovered[c];
    for (std::size_t k = 0; k < 3; ++k) {
      laws.velocity_offset[3 * c + k] += prescribed[3 * c + k];
    }
    laws.adhesion.gap[3 * c] += time_step * prescribed[3 * c];
  }
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
  resident_soft = nullptr;
  if (shares.soft.is_empty()) return;
  const TwoLevelOutcome solved = soft_islands.solve(
      stepper, {state, islands, rows, shares.soft.islands, shares.soft.contacts, laws, change},
      velocity);
  outcome.outer_iterations += solved.outer_iterations;
  outcome.sweeps += solved.sweeps;
  if (solved.is_stopped) {
    outcome.converged = false;
    return;
  }
  if (!solved.is_result) {
    shares.other.take(shares.soft);
    return shares.soft.clear(islands.count());
  }
  outcome.converged = solved.converged;
  outcome.residual = solved.residual;
  take_impulses(shares.soft, soft_islands.impulse(), soft_islands.contact_velocity());
  resident_soft = soft_islands.resident();
}

void ContactSystem::State::solve_other(BodyStepper& stepper,
                                       std::vector<Point3>& velocity,
                                       ContactSolveOutcome& outcome) {
  resident_other = nullptr;
  if (shares.other.is_empty()) return;
  solution.report = solver_islands.solve(stepper, islands, rows, shares.other.islands,
                                         shares.other.contacts, laws, velocity);
  take_impulses(shares.other, solver_islands.impulse(), solver_islands.contact_velocity());
  resident_other = solver_islands.resident();
  const ContactReport& report = solution.report;
  outcome.converged = outcome.converged && solution.converged();
  outcome.residual = std::max(outcome.residual, report.residual.eta);
  outcome.sweeps += report.sweeps;
  outcome.outer_iterations += report.outer_iterations;
}

void ContactSystem::State::add_block_impulses() {
  impulses.assign(index_of(model.block_count()), Point3{0, 0, 0});
  for (std::size_t c = 0; c + 1 < rows.start.size(); ++c) {
    const double* const r = solution.impulse.data() + 3 * c;
    if (r[0] == 0 && r[1] == 0 && r[2] == 0) continue;
    for (std::int32_t e = rows.start[c]; e < rows.start[c + 1]; ++e) {
      Point3& own = impulses[index_of(rows.block[index_of(e)])];
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          own[i] += rows.value[index_of(e)][3 * axis + i] * r[axis];
        }
      }
    }
  }
}

/// Contacts are linear in the velocities of a step. A body with corners that has no room between
/// others can satisfy them by turning many times within the step, at any speed. One that contacts
/// turn by more than half a turn stands still instead, without impulses. @returns whether one does
bool ContactSystem::State::stop_fast_turns(std::vector<Point3>& velocity) {
  const double most = std::acos(-1.0) / laws.adhesion.time_step;
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
  for (std::size_t c = 0; c + 1 < rows.start.size(); ++c) {
    const auto blocks = rows.blocks_of(c);
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

ContactSolveOutcome ContactSystem::solve(BodyStepper& stepper,
                                         const ModelState& state,
                                         const ContactTracker& tracker,
                                         const std::vector<TrackedContact>& contacts,
                                         std::vector<Point3>& velocity,
                                         std::vector<Point3>* change) {
  State& s = *state_;
  static const std::vector<Point3> none;
  s.velocity_before = velocity;
  set_contact_rows(s.scene, s.model, s.frames, state, contacts, s.options.solver.threads, s.rows);
  s.islands.join(s.rows);
  s.set_laws(tracker, contacts, velocity);
  s.shares.divide(s.islands, s.iterates_two_levels(), s.options.skips_islands);
  s.solution.report = {};
  s.solution.impulse.assign(3 * contacts.size(), 0);
  s.solution.velocity = s.laws.velocity_offset;  // of contacts that act on no unknown
  ContactSolveOutcome outcome;
  outcome.islands = s.islands.contact_island_count();
  const std::vector<Point3>& last_change =
      change != nullptr && change->size() == velocity.size() ? *change : none;
  s.solve_soft(stepper, state, last_change, velocity, outcome);
  s.solve_other(stepper, velocity, outcome);
  s.is_resident = (s.shares.soft.is_empty() || s.resident_soft != nullptr) &&
                  (s.shares.other.is_empty() || s.resident_other != nullptr);
  if (s.stop_fast_turns(velocity)) outcome.converged = false;
  if (change != nullptr) *change = differences(velocity, s.velocity_before);
  s.add_block_impulses();
  // The tracker reads gaps from the velocities: without what slows recovery.
  for (std::size_t c = 0; c < contacts.size(); ++c) s.solution.velocity[3 * c] -= s.recovered[c];
  return outcome;
}

void ContactSystem::set_velocities(const std::vector<Point3>& velocity,
                                   BodyStepper& stepper) const {
  const State& s = *state_;
  if (!s.is_resident) return stepper.set_velocities(velocity);
  if (s.resident_soft != nullptr) s.resident_soft->set_velocities();
  if (s.resident_other != nullptr) s.resident_other->set_velocities();
}

const ContactSolution& ContactSystem::solution() const {
  return state_->solution;
}
const std::vector<Point3>& ContactSystem::block_impulses() const {
  return state_->impulses;
}

}  // namespace tetwarp
