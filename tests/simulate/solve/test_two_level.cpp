/// The two-level iteration of contacts of deformable bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "host/base/point3.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/stack_steps.hpp"

namespace tetwarp::test {
namespace {

/// eta of a factorization of A, which the iteration does not have, is what the tolerance bounds.
TEST(TwoLevelContact, ResidualIsWithinTheTolerance) {
  for (const double youngs : {1e4, 1e6, 1e8}) {
    for (const double adhesion : {0.0, 4e7}) {
      const HandScene scene = stack_scene(youngs);
      for (const double tolerance : {1e-3, 1e-5, 1e-8}) {
        SCOPED_TRACE(testing::Message() << youngs << " " << adhesion << " " << tolerance);
        ContactSystemOptions options;
        options.recovery_fraction = 1e9;
        options.solver.tolerance = tolerance;

        for (const StackStep& step : run_stack(scene, options, adhesion, nullptr)) {
          EXPECT_TRUE(step.outcome.converged);
          EXPECT_LE(step.outcome.residual, tolerance);
          EXPECT_LE(step.residual.eta, 1.5 * tolerance);
        }
      }
    }
  }
}

/// Newton's method needs no sweeps and a few steps, whatever the stiffness is. Adhesive springs are
/// part of its equations.
TEST(TwoLevelContact, SheetsWithoutFrictionAreSolvedByNewtonsMethod) {
  for (const double stiffness : {1e3, 1e5, 1e7}) {
    for (const double adhesion : {0.0, 4e7}) {
      const HandScene scene = sheet_scene(stiffness);
      for (const double tolerance : {1e-4, 1e-7}) {
        SCOPED_TRACE(testing::Message() << stiffness << " " << adhesion << " " << tolerance);
        ContactSystemOptions options;
        options.recovery_fraction = 1e9;
        options.solver.tolerance = tolerance;

        for (const StackStep& step : run_stack(scene, options, adhesion, nullptr, 0)) {
          EXPECT_TRUE(step.outcome.converged);
          EXPECT_LE(step.residual.eta, 1.5 * tolerance);
          EXPECT_EQ(step.outcome.sweeps, 0);
          EXPECT_LE(step.outcome.outer_iterations, 15);
        }
      }
    }
  }
}

/// Where a factorization takes longer than a few outer iterations, Newton's method follows these.
TEST(TwoLevelContact, WideSheetsFollowByNewtonsMethod) {
  for (const double adhesion : {0.0, 4e7}) {
    SCOPED_TRACE(adhesion);
    const HandScene scene = sheet_scene(1e7, 24);
    ContactSystemOptions options;
    options.recovery_fraction = 1e9;
    options.solver.tolerance = 1e-6;

    for (const StackStep& step : run_stack(scene, options, adhesion, nullptr, 0)) {
      EXPECT_TRUE(step.outcome.converged);
      EXPECT_LE(step.residual.eta, 1.5e-6);
      EXPECT_LE(step.outcome.outer_iterations, 400);
    }
  }
}

/// Of bodies that springs join M is far from A, whose residual counts. Few contacts are solved with
/// W = J A^-1 J^T.
TEST(TwoLevelContact, TiedBodiesMeetTheTolerance) {
  for (const double youngs : {1e4, 1e6, 1e8}) {
    for (const double spring : {1e2, 1e4}) {
      for (const double adhesion : {0.0, 4e7}) {
        SCOPED_TRACE(testing::Message() << youngs << " " << spring << " " << adhesion);
        const HandScene scene = tied_scene(youngs, spring);
        ContactSystemOptions options;
        options.recovery_fraction = 1e9;
        options.solver.tolerance = 1e-5;

        for (const StackStep& step : run_stack(scene, options, adhesion, nullptr)) {
          EXPECT_TRUE(step.outcome.converged);
          EXPECT_LE(step.residual.eta, 1.5e-5);
          EXPECT_EQ(step.outcome.outer_iterations, 0);
        }
      }
    }
  }
}

/// With the same A columns of W are kept: other contacts later give the bits of a new system.
TEST(TwoLevelContact, ColumnsOfContactsAreKeptForTheSameMatrixAlone) {
  const HandScene scene = tied_scene(1e6, 1e4);
  ContactSystemOptions options;
  options.recovery_fraction = 1e9;
  ContactTrackerOptions tracking;
  tracking.materials[0].friction = 0.4;
  tracking.touch_distance = 1e-9;
  const auto stepper = make_cpu_stepper(scene.model, {.linear_tolerance = 1e-10});
  ContactSystem kept(scene.surfaces, scene.model, options);
  const ModelState& state = scene.model.start;
  for (const double steps : {3.0, 1.0, 3.0}) {
    stepper->set_state(state);
    stepper->solve(input_for(scene.model, steps * stack_step, {3, 1, -9.81}));
    for (const std::size_t count : {9u, 26u, 17u}) {
      HandScene part = scene;
      part.touches.resize(count);
      ContactTracker tracker(tracking);
      const auto contacts = part.begin(tracker, state, steps * stack_step);
      const auto solve = [&](ContactSystem& system) {
        std::vector<Point3> velocity;
        stepper->get_velocities(velocity);
        system.begin_part();
        const auto outcome = system.solve(*stepper, state, tracker, contacts, velocity);
        EXPECT_TRUE(outcome.converged);
        EXPECT_EQ(outcome.outer_iterations, 0);
        return velocity;
      };
      ContactSystem fresh(scene.surfaces, scene.model, options);
      EXPECT_EQ(solve(kept), solve(fresh));
    }
  }
}

/// What the iteration calls converged is so by a factorization of A, with friction, however stiff
/// the sheet is.
TEST(TwoLevelContact, SheetsWithFrictionAreNotCalledConvergedTooEarly) {
  for (const double stiffness : {1e3, 1e5}) {
    SCOPED_TRACE(stiffness);
    const HandScene scene = sheet_scene(stiffness, 12);  // with too many contacts for W
    ContactSystemOptions options;
    options.recovery_fraction = 1e9;
    options.solver.tolerance = 1e-4;

    std::int64_t converged = 0;
    for (const StackStep& step : run_stack(scene, options, 0, nullptr)) {
      if (!step.outcome.converged) continue;
      ++converged;
      EXPECT_LE(step.residual.eta, 1.5e-4);
    }
    EXPECT_GE(converged, 3);
  }
}

/// Sweeps over groups keep the velocities of all touched nodes consistent with the impulses.
TEST(TwoLevelContact, GroupsOfSeveralBodiesMeetTheTolerance) {
  const HandScene scene = tower_scene();
  for (const double adhesion : {0.0, 4e7}) {
    for (const double tolerance : {1e-4, 1e-7}) {
      SCOPED_TRACE(testing::Message() << adhesion << " " << tolerance);
      ContactSystemOptions options;
      options.recovery_fraction = 1e9;
      options.solver.tolerance = tolerance;

      for (const StackStep& step : run_stack(scene, options, adhesion, nullptr)) {
        EXPECT_TRUE(step.outcome.converged);
        EXPECT_LE(step.residual.eta, 1.5 * tolerance);
        EXPECT_LT(step.outcome.sweeps, 2000) << step.outcome.outer_iterations;
      }
    }
  }
}

TEST(TwoLevelContact, GroupsGiveTheSameBitsOnAnyNumberOfThreads) {
  const HandScene scene = tower_scene();
  ContactSystemOptions one, three;
  one.solver.threads = 1;
  three.solver.threads = 3;

  const auto a = run_stack(scene, one, 4e7, nullptr), b = run_stack(scene, three, 4e7, nullptr);

  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(a[n].velocity, b[n].velocity);
    EXPECT_EQ(a[n].outcome.sweeps, b[n].outcome.sweeps);
  }
}

/// The factors at rest of bodies that are pressed flat are far from those of their systems.
TEST(TwoLevelContact, BodiesPressedFlatMeetTheTolerance) {
  for (const double height : {0.3, 0.1}) {
    for (const StackStep& step : run_stack(tower_scene(height), {}, 0, nullptr)) {
      EXPECT_TRUE(step.outcome.converged);
      EXPECT_LE(step.residual.eta, 1.5e-6);
      EXPECT_LT(step.outcome.outer_iterations, 150);
    }
  }
}

TEST(TwoLevelContact, AgreesWithTheContactSolver) {
  const HandScene scene = stack_scene(1e5);
  ContactSystemOptions options;
  options.solver.tolerance = 1e-9;

  const auto own = run_stack(scene, options, 0, nullptr);
  options.solver.expert.coupling = ContactCoupling::condensed;
  const auto solver = run_stack(scene, options, 0, nullptr);

  for (std::size_t n = 0; n < own.size(); ++n) {
    for (std::size_t i = 0; i < own[n].velocity.size(); ++i) {
      EXPECT_LT(distance(own[n].velocity[i], solver[n].velocity[i]), 1e-6);
    }
  }
}

/// Where contacts stay open the impulses are zero, and the linear solve is as exact as it was.
TEST(TwoLevelContact, KeepsVelocitiesWhereContactsStayOpen) {
  HandScene scene = stack_scene(1e5);
  for (Touch& touch : scene.touches) {
    touch.point_b.local[2] += touch.body_b == scene.model.rigid.body[1] ? -1 : 1;
  }
  const auto stepper = make_cpu_stepper(scene.model, {.linear_tolerance = 1e-4});
  ContactSystem system(scene.surfaces, scene.model, {});
  ContactTracker tracker;
  stepper->solve(input_for(scene.model, stack_step, {3, 1, -9.81}));
  const auto contacts = scene.begin(tracker, scene.model.start, stack_step);
  std::vector<Point3> velocity;
  stepper->get_velocities(velocity);
  const std::vector<Point3> free = velocity;

  const ContactSolveOutcome outcome =
      system.solve(*stepper, scene.model.start, tracker, contacts, velocity);

  EXPECT_TRUE(outcome.converged);
  EXPECT_EQ(outcome.outer_iterations, 0);
  EXPECT_EQ(velocity, free);
}

/// A start from the change of the step before saves iterations and changes results within the
/// tolerance.
TEST(TwoLevelContact, StartsFromTheChangeOfTheStepBefore) {
  const HandScene scene = stack_scene(1e6);
  ContactSystemOptions options;
  options.solver.tolerance = 1e-6;
  std::vector<Point3> change;

  const auto fresh = run_stack(scene, options, 0, nullptr);
  const auto started = run_stack(scene, options, 0, &change);

  EXPECT_EQ(change.size(), static_cast<std::size_t>(scene.model.block_count()));
  std::int64_t fresh_count = 0, started_count = 0;
  for (std::size_t n = 0; n < fresh.size(); ++n) {
    fresh_count += fresh[n].outcome.outer_iterations;
    started_count += started[n].outcome.outer_iterations;
    for (std::size_t i = 0; i < fresh[n].velocity.size(); ++i) {
      EXPECT_LT(distance(fresh[n].velocity[i], started[n].velocity[i]), 1e-4);
    }
  }
  EXPECT_LT(started_count, fresh_count);
}

/// Passes of a part of a step solve for more and more contacts: impulses found so far stay.
TEST(TwoLevelContact, StartsFromTheImpulsesOfTheSolveBefore) {
  const HandScene scene = stack_scene(1e6);
  const auto stepper = make_cpu_stepper(scene.model, {.linear_tolerance = 1e-10});
  ContactSystem system(scene.surfaces, scene.model, {});
  ContactTracker tracker;
  stepper->solve(input_for(scene.model, stack_step, {3, 1, -9.81}));
  std::vector<Point3> free, change;
  stepper->get_velocities(free);
  const auto solve = [&] {
    const auto contacts = scene.begin(tracker, scene.model.start, stack_step);
    std::vector<Point3> velocity = free;
    return system.solve(*stepper, scene.model.start, tracker, contacts, velocity, &change);
  };

  const ContactSolveOutcome first = solve(), again = solve();
  system.begin_part();
  change.clear();
  const ContactSolveOutcome fresh = solve();

  EXPECT_GT(first.outer_iterations, 1);
  EXPECT_EQ(again.outer_iterations, 0);
  EXPECT_EQ(fresh.outer_iterations, first.outer_iterations);
}

TEST(TwoLevelContact, TakesFewerOuterIterationsThanBlockJacobi) {
  const HandScene scene = stack_scene(1e6);
  ContactSystemOptions options;
  options.solver.tolerance = 1e-4;

  const auto own = run_stack(scene, options, 0, nullptr);
  options.solver.expert.coupling = ContactCoupling::iterated;
  const auto jacobi = run_stack(scene, options, 0, nullptr);

  std::int64_t own_count = 0, jacobi_count = 0;
  for (std::size_t n = 0; n < own.size(); ++n) {
    own_count += own[n].outcome.outer_iterations;
    jacobi_count += jacobi[n].outcome.outer_iterations;
  }
  EXPECT_LT(2 * own_count, jacobi_count);
}

}  // namespace
}  // namespace tetwarp::test
