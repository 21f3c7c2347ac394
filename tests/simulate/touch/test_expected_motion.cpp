/// What a step expects of the contacts of the step before.
#include <gtest/gtest.h>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/contact_step/contact_step.hpp"
#include "host/simulate/contact_step/expected_motion.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

constexpr double time_step = 0.005;

/// A box above a floor by less than it falls in a step, and by more than twice the thickness.
Scene box_above_floor() {
  Scene scene = scene_of({rigid_box("box", {0.05, 0.05, 0.05}, {0, 0, 0.0501})}, time_step);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 1e-5;
  return scene;
}

/// The contacts that the step expects to hold the box are not there: it is stopped nevertheless.
TEST(ExpectedMotion, ABodyThatNothingHoldsAnyMoreIsStoppedByWhatItFallsOn) {
  const Scene scene = box_above_floor();
  const SceneGeometry geometry = make_scene_geometry(scene);
  const Model model = make_model(scene, geometry);
  const SceneSurfaces surfaces = make_scene_surfaces(scene, geometry, model);
  ContactStep step(scene, model, surfaces, {});
  ContactMemory memory;
  memory.time_step = time_step;
  memory.change.resize(static_cast<std::size_t>(model.block_count()));
  memory.change[0] = {0, 0, 9.81 * time_step};
  step.set_memory(memory);
  const auto stepper = make_cpu_stepper(model, {});
  stepper->solve(input_for(model, time_step, {0, 0, -9.81}));

  const ContactPart part = step.advance(model.start, time_step, false, *stepper);

  EXPECT_EQ(part.passes, 3);
  EXPECT_GE(part.contacts, 3);
  ModelState after = model.start;
  stepper->get_state(after);
  EXPECT_NEAR(after.position[0][2], 0.05 + 1e-5, 2e-6);
}

/// Changes that would move a body more than contact did without them do not come again.
TEST(ExpectedMotion, AddsChangesOnlyWhereTheyHold) {
  Model model = empty_model();
  add_rigid(model, 1, {1, 1, 1}, {0, 0, 0});
  const Point3 held{0, 0, 0.1}, hit{0, 0, 5};
  for (const Point3& change : {held, hit}) {
    std::vector<Point3> velocity = {{0, 0, -0.1}, {0, 0, 0}};
    expect_contacts(model, model.start, {change, {0, 0, 0}}, velocity);
    EXPECT_EQ(velocity[0], (Point3{0, 0, change == held ? 0 : -0.1}));
  }
}

}  // namespace
}  // namespace tetwarp::test
