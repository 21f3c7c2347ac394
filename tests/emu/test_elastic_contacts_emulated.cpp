/// Contacts of elastic bodies, solved where back end cuda steps them, against those on the host.
#include <gtest/gtest.h>

#include <cstdio>

#include "host/base/point3.hpp"
#include "tests/emu/device_calls.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/mixed_contacts.hpp"
#include "tests/simulate/stack_scenes.hpp"

namespace tetwarp::test {
namespace {

struct ElasticStep {
  ContactSolveOutcome outcome;
  std::vector<Point3> velocity;
  std::vector<double> impulse;
  simt::CopiedBytes copied;  ///< by ContactSystem::solve() and set_velocities()
  DeviceCalls calls{""};     ///< of them
};

/// Steps of a stack that is pushed sideways.
std::vector<ElasticStep> run_stack(const HandScene& scene,
                                   Backend backend,
                                   ContactSystemOptions options,
                                   double adhesion = 0) {
  options.solver.backend = backend;
  options.recovery_fraction = 1e9;
  const StepperOptions stepping = {.linear_tolerance = 1e-12};
  const auto stepper = backend == Backend::cuda ? make_cuda_stepper(scene.model, stepping)
                                                : make_cpu_stepper(scene.model, stepping);
  ContactSystem system(scene.surfaces, scene.model, options);
  ContactTracker tracker(materials(0.4, adhesion));
  ModelState state = scene.model.start;
  std::vector<Point3> change;
  std::vector<ElasticStep> steps(3);
  for (ElasticStep& step : steps) {
    stepper->solve(input_for(scene.model, stack_step, {3, 1, -9.81}));
    const auto contacts = scene.begin(tracker, state, stack_step);
    stepper->get_velocities(step.velocity);
    take_copied();
    take_calls();
    step.outcome = system.solve(*stepper, state, tracker, contacts, step.velocity, &change);
    system.set_velocities(step.velocity, *stepper);
    step.copied = take_copied();
    step.calls = take_calls();
    step.impulse = system.solution().impulse;

    std::vector<Point3> of_stepper;
    stepper->get_velocities(of_stepper);
    EXPECT_EQ(of_stepper, step.velocity);
    stepper->move(stack_step, {});
    stepper->get_state(state);
    tracker.end_step(system.solution(), scene.places(state));
  }
  return steps;
}

TEST(ElasticContactsEmulated, Look) {
  for (const double youngs : {1e4, 1e6, 1e8}) {
    for (const double adhesion : {0.0, 4e7}) {
      const HandScene scene = stack_scene(youngs);
      ContactSystemOptions options;
      options.solver.tolerance = 1e-6;
      const auto expected = run_stack(scene, Backend::cpu, options, adhesion);
      const auto found = run_stack(scene, Backend::cuda, options, adhesion);
      for (std::size_t n = 0; n < found.size(); ++n) {
        double far = 0;
        for (std::size_t i = 0; i < found[n].velocity.size(); ++i)
          far = std::max(far, norm(minus(found[n].velocity[i], expected[n].velocity[i])));
        std::printf("%g %g: cpu %d %.2e outer %ld sweeps %ld | cuda %d %.2e outer %ld sweeps %ld | far %.2e launches %ld up %zu down %zu\n",
                    youngs, adhesion, expected[n].outcome.converged, expected[n].outcome.residual,
                    expected[n].outcome.outer_iterations, expected[n].outcome.sweeps,
                    found[n].outcome.converged, found[n].outcome.residual,
                    found[n].outcome.outer_iterations, found[n].outcome.sweeps, far,
                    found[n].calls.count(DeviceCall::launch), found[n].copied.to_device, found[n].copied.to_host);
      }
    }
  }
  for (const double height : {1.0, 0.3, 0.1}) {
    const HandScene scene = tower_scene(height, 6);
    const auto expected = run_stack(scene, Backend::cpu, {});
    const auto found = run_stack(scene, Backend::cuda, {});
    for (std::size_t n = 0; n < found.size(); ++n) {
      double far = 0;
      for (std::size_t i = 0; i < found[n].velocity.size(); ++i)
        far = std::max(far, norm(minus(found[n].velocity[i], expected[n].velocity[i])));
      std::printf("tower %g: cpu %d %.2e outer %ld sweeps %ld | cuda %d %.2e outer %ld sweeps %ld | far %.2e launches %ld\n",
                  height, expected[n].outcome.converged, expected[n].outcome.residual,
                  expected[n].outcome.outer_iterations, expected[n].outcome.sweeps,
                  found[n].outcome.converged, found[n].outcome.residual,
                  found[n].outcome.outer_iterations, found[n].outcome.sweeps, far,
                  found[n].calls.count(DeviceCall::launch));
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
