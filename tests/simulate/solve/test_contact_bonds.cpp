/// Contacts that only a bond is left of: their surfaces do not touch.
#include <gtest/gtest.h>

#include "tests/simulate/body_models.hpp"
#include "tests/simulate/hand_contacts.hpp"

namespace tetwarp::test {
namespace {
constexpr double step = 1e-3;    // [s]
constexpr double weight = 9.81;  // [m/s^2]

/// The impulse on a box of 1 kg that was bonded to a frame below it and then moved.
Point3 impulse_after(const Point3& way) {
  HandScene scene;
  scene.model = empty_model();
  add_rigid(scene.model, 1, {1e-3, 1e-3, 1e-3}, {0, 0, 0});
  add_frame(scene.model, {0, 0, 0});
  scene.make_surfaces(0.1);
  scene.surfaces.surfaces.thickness = 1e-4;
  scene.touches.push_back({.body_a = scene.model.rigid.body[0],
                           .body_b = scene.model.rigid.body[1],
                           .point_a = on_rigid({0, 0, 0}),
                           .point_b = on_rigid({0, 0, 0}),
                           .area = 1e-6});
  ContactTrackerOptions tracking;
  tracking.materials[0].stiffness = 1e6;
  tracking.materials[0].initial_intensity = 1;
  tracking.touch_distance = 1e-9;
  ContactTracker tracker(tracking);
  scene.begin(tracker, scene.model.start, step);
  ContactSolution nothing;
  nothing.impulse.assign(3, 0);
  nothing.velocity.assign(3, 0);
  tracker.end_step(nothing, scene.places(scene.model.start));

  ModelState state = scene.model.start;
  for (std::size_t i = 0; i < 3; ++i) state.position[0][i] += way[i];
  const auto contacts = tracker.begin_step({}, scene.places(state), step);
  EXPECT_EQ(contacts.size(), 1u);
  const auto stepper = make_cpu_stepper(scene.model, {.linear_tolerance = 1e-12});
  stepper->set_state(state);
  stepper->solve(input_for(scene.model, step, {0, 0, -weight}));
  std::vector<Point3> velocity;
  stepper->get_velocities(velocity);
  ContactSystemOptions options;
  options.solver.tolerance = 1e-12;
  ContactSystem system(scene.surfaces, scene.model, options);
  system.solve(*stepper, state, tracker, contacts, velocity);
  return scene.block_impulses(state, contacts, system.solution().impulse)[0];
}

TEST(ContactBonds, HoldInTension) {
  const double spring = 1 * step;  // C area dt [N s/m]
  EXPECT_NEAR(impulse_after({0, 0, 0.01})[2] / (-spring * 0.01), 1, 0.02);
}

TEST(ContactBonds, PushWhereTheirEndsMeet) {
  EXPECT_NEAR(impulse_after({0, 0, 0})[2], weight * step, 1e-9);
}

/// A plane through one end, without the surface that it was part of, must not stop the other end.
TEST(ContactBonds, DoNotPushBesideTheirEnds) {
  for (const double below : {0.0, 1e-4}) {
    const Point3 impulse = impulse_after({0.01, 0, -below});
    EXPECT_EQ(impulse[2], 0) << below;
    EXPECT_NEAR(impulse[0] / (-1 * step * 0.01), 1, 0.02) << below;
  }
}

/// The normal of the last contact has turned until one end is behind the other one's surface.
/// Pushing there would oppose the contacts of what is really in front.
TEST(ContactBonds, DoNotPushFromBehind) {
  for (const double below : {1e-9, 1e-5, 1e-4, 1e-2}) {
    EXPECT_EQ(impulse_after({0, 0, -below}), (Point3{0, 0, 0})) << below;
  }
}

}  // namespace
}  // namespace tetwarp::test
