/// @file contact_system.hpp
/// ContactSystem: the contact problem of a step from the system of its bodies, and its solution.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/step/cpu/rest_factors.hpp"
#include "host/simulate/step/stepper.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

struct ContactSystemOptions {
  ContactOptions solver;
  double recovery_fraction = 0.2;  ///< existing penetration is undone at most at this fraction of
                                   ///< the smaller body's size per second
  bool skips_islands = true;       ///< coupling islands without contacts are not solved again
  std::shared_ptr<RestFactors> factors = {};  ///< of elastic bodies, or null: own ones
};

/// How the solves of a step went.
struct ContactSolveOutcome {
  bool converged = true;
  double residual = 0;  ///< eta, the largest
  std::int64_t sweeps = 0, outer_iterations = 0;
  std::int64_t islands = 0;  ///< contact islands: coupling islands joined by contacts
};

class ContactSystem {
 public:
  ContactSystem(const SceneSurfaces& scene,
                const Model& model,
                const ContactSystemOptions& options);
  ~ContactSystem();

  /// Begins a part of a step: the first solve starts from the impulses of the records, those that
  /// follow start from the impulses of the one before.
  void begin_part();

  /// Solves the coupling islands that have contacts, together with their contacts; the others keep
  /// their velocities.
  /// @param stepper   after its solve(); its system is copied to the host only if an island is
  ///                  solved from it there
  /// @param state     at the start of the step
  /// @param tracker   its step has begun; contacts in the order of its last begin_step()
  /// @param contacts  what begin_step() returned
  /// @param velocity  in: of all blocks without contact; out: with contact, [block_count]
  /// @param change    in: by how much contacts changed the velocities in the last step or pass, or
  ///                  empty; out: the same of this one, [block_count]. It saves outer iterations;
  ///                  the results depend on it within the tolerance, so it is part of the state of
  ///                  a simulation. Null: not used
  ContactSolveOutcome solve(BodyStepper& stepper,
                            const ModelState& state,
                            const ContactTracker& tracker,
                            const std::vector<TrackedContact>& contacts,
                            std::vector<Point3>& velocity,
                            std::vector<Point3>* change = nullptr);

  /// Gives the velocities of the last solve() to the stepper; those that its device has already are
  /// not copied there.
  void set_velocities(const std::vector<Point3>& velocity, BodyStepper& stepper) const;

  /// Impulses and velocities of all contacts of the last solve(), in their order; for
  /// ContactTracker::end_step().
  const ContactSolution& solution() const;
  /// J^T r of the last solve() on prescribed blocks, 0 on others [block_count].
  const std::vector<Point3>& block_impulses() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
