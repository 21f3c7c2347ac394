/// Where the contacts of steps are solved on back end cuda.
#include <gtest/gtest.h>

#include "host/base/point3.hpp"
#include "tests/emu/device_calls.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/mixed_contacts.hpp"

namespace tetwarp::test {
namespace {

/// After a step under gravity and a pull along x. Bodies are stepped on the host.
std::vector<Point3> velocities(const HandScene& scene, Backend backend) {
  const auto stepper = make_cpu_stepper(scene.model, {.linear_tolerance = 1e-13});
  stepper->solve(input_for(scene.model, mixed_step, {1, 0, -9.81}));
  ContactTracker tracker(materials(0.3));
  const auto contacts = scene.begin(tracker, scene.model.start, mixed_step);
  ContactSystem system(scene.surfaces, scene.model, exact(backend));
  std::vector<Point3> velocity;
  stepper->get_velocities(velocity);
  const ContactSolveOutcome outcome =
      system.solve(stepper->system(), scene.model.start, tracker, contacts, velocity);
  EXPECT_TRUE(outcome.converged);
  EXPECT_GT(outcome.sweeps, 0);
  return velocity;
}

/// Launches of a solve on back end cuda, whose velocities are those of the host.
std::int64_t launches_of(const HandScene& scene) {
  const std::vector<Point3> expected = velocities(scene, Backend::cpu);
  take_calls();
  const std::vector<Point3> found = velocities(scene, Backend::cuda);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT(norm(minus(found[i], expected[i])), 1e-8) << i;
  }
  return take_calls().count(DeviceCall::launch);
}

TEST(ContactSystemEmulated, SolvesContactsOfRigidBodiesOnTheDevice) {
  EXPECT_GT(launches_of(box_on_frame()), 0);
}

/// Those of elastic bodies, cloth and coupled bodies are solved on the host.
TEST(ContactSystemEmulated, SolvesOtherContactsOnTheHost) {
  EXPECT_EQ(launches_of(mixed_scene(1)), 0);
}

}  // namespace
}  // namespace tetwarp::test
