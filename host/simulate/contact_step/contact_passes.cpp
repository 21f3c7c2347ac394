/// @file contact_passes.cpp
/// Passes of detection and solution until no pair is newly hit.
#include "host/simulate/contact_step/contact_passes.hpp"

#include <functional>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/simulate/contact_step/added_seconds.hpp"
#include "host/simulate/contact_step/expected_motion.hpp"
#include "host/simulate/solve/general_solver.hpp"
#include "host/simulate/step/step_clock.hpp"

namespace tetwarp {
namespace {

ContactSystemOptions system_options(const Scene& scene,
                                    const ContactStepOptions& options,
                                    std::function<bool(const ContactProgress&)> progress) {
  ContactSystemOptions of;
  of.solver.tolerance = scene.solver.contact_tolerance;
  of.solver.law = scene.solver.pyramid ? FrictionLaw::pyramid : FrictionLaw::cone;
  of.solver.rule = scene.solver.restrictive ? AdhesionRule::restrictive : AdhesionRule::parallel;
  of.solver.backend = options.backend;
  of.solver.device = options.device;
  of.solver.threads = options.threads;
  // Islands that these sweeps do not solve are solved by Newton's method: a few contacts with
  // friction between two bodies, as of a stone on an edge, may take thousands of sweeps, and a
  // factorization for few contacts takes as long as about ten. Very tight tolerances take many
  // sweeps in all scenes, and so do many contacts, see GeneralSolver.
  of.solver.max_sweeps = scene.solver.contact_tolerance < 1e-6 ? GeneralSolver::many_sweeps : 300;
  // Steps of all islands together: a pile of 1,000 stones takes more than 1,000. A step of the
  // simulation that is not solved is divided.
  of.solver.max_newton = 20000;
  // A solver that remembers systems would not go on from a checkpoint bit for bit.
  of.solver.expert.skip.constant_systems = false;
  if (options.progress || options.clock != nullptr) of.solver.progress = std::move(progress);
  of.skips_islands = options.skip.islands;
  of.factors = options.factors;
  return of;
}

}  // namespace

ContactPasses::ContactPasses(const PassParts& parts, const ContactStepOptions& options)
    : parts_(parts),
      options_(options),
      pair_contacts_(parts.surfaces, options.threads),
      system_(parts.surfaces,
              parts.model,
              system_options(parts.scene, options, [this](const ContactProgress&) {
                was_ended_ = was_ended_ || (options_.progress && !options_.progress());
                return !was_ended_ && !is_late();
              })) {}

void ContactPasses::run(bool is_first, BodyStepper& stepper, ContactPart& part) {
  was_ended_ = has_pairs_ = false;
  system_.begin_part();
  const bool is_expected = expect_contacts_of_last_step();
  for (std::size_t pass = 0; pass < parts_.motion.passes() && (pass == 0 || !is_late()); ++pass) {
    const bool was_free = parts_.motion.is_free();
    if (!detect(pass, is_expected, part)) return;
    {
      const AddedSeconds seconds(part.seconds.detection);
      track(is_first);
    }
    const bool is_solved = solve(stepper, part);
    // Without contacts the motion is the free one; a pass that looked at another is followed by one
    // more.
    const bool is_free_again = parts_.history.contacts()->empty() && !was_free;
    if (!is_solved && !is_free_again) return;
  }
  const AddedSeconds seconds(part.seconds.detection);
  parts_.motion.shorten({});
  has_pairs_ = true;  // no detection has searched this motion, so the end check has to
}

/// Whether the step has no time for more solves.
bool ContactPasses::is_late() const {
  return options_.clock != nullptr && options_.clock->is_over();
}

/// Sets the velocities to those without contact, or to those that the contacts of the last step are
/// expected to make. @returns whether they are expected ones
bool ContactPasses::expect_contacts_of_last_step() {
  PartMotion& motion = parts_.motion;
  const std::vector<Point3>& change = parts_.history.change();
  motion.set_free();
  // The axes of a pyramid follow the motion without contact. An expected motion is not the final
  // one, so that it takes a second detection.
  if (!options_.skip.hits || parts_.scene.solver.pyramid || motion.passes() < 2) return false;
  if (change.size() != index_of(parts_.model.block_count())) return false;
  expect_contacts(parts_.model, motion.start(), change, motion.velocity_with_contact());
  return true;
}

/// @returns whether there is something to solve; false also where the motion reaches bodies that
/// sleep
bool ContactPasses::detect(std::size_t pass, bool is_expected, ContactPart& part) {
  const AddedSeconds seconds(part.seconds.detection);
  const std::int64_t added = parts_.detector.find_touches(parts_.motion.move(pass));
  ++part.passes;
  has_pairs_ = has_pairs_ || added > 0;
  part.woken = parts_.detector.reached();
  if (!part.woken.empty()) return false;
  const bool has_records = !parts_.history.tracker().records().empty();
  return added > 0 || (pass == 0 && (is_expected || has_records));
}

void ContactPasses::track(bool is_first) {
  ContactHistory& history = parts_.history;
  std::vector<ReportedContact>& reports =
      pair_contacts_.find(parts_.detector.touches(), parts_.motion.last().start.vertices,
                          history.tracker().start_records());
  history.track(reports, parts_.motion.bodies_at_start(), is_first);
}

/// @returns whether there are new velocities, all finite
bool ContactPasses::solve(BodyStepper& stepper, ContactPart& part) {
  const AddedSeconds seconds(part.seconds.contact);
  PartMotion& motion = parts_.motion;
  ContactHistory& history = parts_.history;
  motion.set_free();
  if (history.contacts()->empty()) return false;
  const ContactSolveOutcome outcome =
      system_.solve(stepper, motion.start(), history.tracker(), *history.contacts(),
                    motion.velocity_with_contact(), &history.change());
  part.converged = outcome.converged;
  part.residual = outcome.residual;
  part.sweeps += outcome.sweeps;
  part.outer_iterations += outcome.outer_iterations;
  part.is_completed = !was_ended_;
  if (options_.clock != nullptr) options_.clock->end_solve();
  return part.is_completed && motion.is_finite();
}

}  // namespace tetwarp
