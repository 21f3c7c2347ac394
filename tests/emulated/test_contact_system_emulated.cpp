/// Where the contacts of steps are solved on back end cuda, and what is copied for them.
#include <gtest/gtest.h>

#include "host/base/point3.hpp"
#include "tests/emulated/device_calls.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/mixed_contacts.hpp"

namespace tetwarp::test {
namespace {

/// What the last of some steps under gravity and a pull along x has done.
struct Course {
  std::vector<Point3> velocity, block_impulses;
  std::vector<double> impulse;
  ContactSolveOutcome outcome;
  simt::CopiedBytes copied;  ///< by ContactSystem::solve() and set_velocities()
  DeviceCalls calls{""};     ///< of them
};

/// @param stepped   back end that steps the bodies
/// @param options   of the contacts; the frame of the scene moves
/// @param material  of all contacts
Course course_of(const HandScene& scene,
                 Backend stepped,
                 const ContactSystemOptions& options,
                 const ContactTrackerOptions& material = materials(0.3),
                 int steps = 3) {
  const StepperOptions stepping = {.linear_tolerance = 1e-13};
  const auto stepper = stepped == Backend::cuda ? make_cuda_stepper(scene.model, stepping)
                                                : make_cpu_stepper(scene.model, stepping);
  StepInput input = input_for(scene.model, mixed_step, {1, 0, -9.81});
  input.prescribed_velocity[at(scene.model.node_count + 2 * (scene.model.rigid_count - 1))] = {
      0.2, -0.1, 0.05};
  ContactTracker tracker(material);
  ContactSystem system(scene.surfaces, scene.model, options);
  ModelState state = scene.model.start;
  Course course;
  for (int step = 0; step < steps; ++step) {
    stepper->solve(input);
    const auto contacts = scene.begin(tracker, state, mixed_step);
    stepper->get_velocities(course.velocity);
    take_copied();
    take_calls();
    course.outcome = system.solve(*stepper, state, tracker, contacts, course.velocity);
    system.set_velocities(course.velocity, *stepper);
    course.copied = take_copied();
    course.calls = take_calls();
    course.impulse = system.solution().impulse;
    course.block_impulses = scene.block_impulses(state, contacts, course.impulse);
    EXPECT_TRUE(course.outcome.converged);

    // The velocities of the stepper are those of the solution, bit for bit.
    std::vector<Point3> of_stepper;
    stepper->get_velocities(of_stepper);
    EXPECT_EQ(of_stepper, course.velocity);
    stepper->move(mixed_step, {});
    stepper->get_state(state);
    tracker.end_step(system.solution(), scene.places(state));
  }
  return course;
}

void expect_near_course(const Course& found, const Course& expected, double tolerance) {
  for (std::size_t i = 0; i < expected.velocity.size(); ++i) {
    EXPECT_LT(norm(minus(found.velocity[i], expected.velocity[i])), tolerance) << i;
    EXPECT_LT(norm(minus(found.block_impulses[i], expected.block_impulses[i])), tolerance) << i;
  }
}

std::int64_t launches_in(const Course& course) {
  return course.calls.count(DeviceCall::launch);
}

TEST(ContactSystemEmulated, SolvesContactsOfRigidBodiesOnTheDevice) {
  const HandScene scene = stack_on_frame(1);
  const Course expected = course_of(scene, Backend::cpu, exact());
  const Course found = course_of(scene, Backend::cpu, exact(Backend::cuda));
  expect_near_course(found, expected, 1e-8);
  EXPECT_GT(launches_in(found), 0);
}

/// Those of elastic bodies, cloth and coupled bodies are solved where the bodies are stepped.
TEST(ContactSystemEmulated, SolvesOtherContactsWhereTheBodiesAreStepped) {
  const HandScene scene = mixed_scene(1);
  const Course expected = course_of(scene, Backend::cpu, exact(), materials(0.3), 1);
  for (const Backend stepped : {Backend::cpu, Backend::cuda}) {
    const Course found = course_of(scene, stepped, exact(Backend::cuda), materials(0.3), 1);
    expect_near_course(found, expected, 1e-8);
    EXPECT_EQ(launches_in(found) > 0, stepped == Backend::cuda);
  }
}

void expect_course_of_the_cpu(std::int32_t bodies) {
  const HandScene scene = stack_on_frame(bodies);
  for (const double stiffness : {0.0, 1e7}) {
    ContactTrackerOptions material = materials(0.3, stiffness);
    HandScene bonded = scene;
    for (Touch& touch : bonded.touches) touch.area = 1e-4;
    const Course expected = course_of(bonded, Backend::cpu, exact(), material);
    const Course found = course_of(bonded, Backend::cuda, exact(Backend::cuda), material);
    expect_near_course(found, expected, 1e-7);
  }
}

TEST(ContactSystemEmulated, BuildsProblemsWhereTheBodiesAreStepped) {
  expect_course_of_the_cpu(2);
}
TEST(LongContactSystemEmulated, BuildsProblemsWhereTheBodiesAreStepped) {
  expect_course_of_the_cpu(4);
}

/// Per contact of two bodies 24 numbers cross to the device, 31 where contacts adhere, and 6 back;
/// per body 6 back. J has 36 numbers per contact, A 36 per body. One island, whose own numbers are
/// few.
TEST(ContactSystemEmulated, OnlyNumbersOfContactsAndVelocitiesCross) {
  ContactSystemOptions options = exact(Backend::cuda);
  options.solver.tolerance = 1e-3;
  for (const bool adheres : {false, true}) {
    const auto copied = [&](std::int32_t count) {
      HandScene scene = stack_on_frame(count);
      for (Touch& touch : scene.touches) touch.area = 1e-4;
      return course_of(scene, Backend::cuda, options, materials(0.3, adheres ? 1e7 : 0)).copied;
    };
    const simt::CopiedBytes few = copied(2), many = copied(6);
    const std::size_t bodies = 4, contacts = 4 * bodies, numbers = adheres ? 31 : 24;
    EXPECT_EQ(many.to_device - few.to_device, contacts * numbers * sizeof(double));
    EXPECT_EQ(many.to_host - few.to_host, (contacts + bodies) * 6 * sizeof(double));
    EXPECT_LE(few.to_device, 8 * numbers * sizeof(double) + 256);
    EXPECT_LE(few.to_host, (8 + 2) * 6 * sizeof(double) + 1024);
  }
}

/// Places and structure are made where bodies or contacts have changed.
TEST(ContactSystemEmulated, TheSamePatternIsCopiedOnce) {
  const HandScene scene = stack_on_frame(3);
  ContactSystemOptions options = exact(Backend::cuda);
  options.solver.tolerance = 1e-3;
  const Course first = course_of(scene, Backend::cuda, options, materials(0.3), 1);
  const Course later = course_of(scene, Backend::cuda, options);
  EXPECT_GT(first.calls.count(DeviceCall::copy_to_device), 20);
  EXPECT_LE(first.copied.to_device - later.copied.to_device, 12u * 580 + 3 * 440 + 400);
  EXPECT_EQ(later.calls.count(DeviceCall::allocate), 0);
  EXPECT_LE(later.calls.count(DeviceCall::copy_to_device), 2);
  EXPECT_LE(later.calls.count(DeviceCall::copy_to_host), 8);
  EXPECT_LE(later.calls.count(DeviceCall::launch), 40);
}

/// What sweeps do not solve is solved on the host from what the device has found.
TEST(ContactSystemEmulated, TheHostGoesOnWhereTheDeviceStops) {
  const HandScene scene = stack_on_frame(3);
  ContactSystemOptions options = exact(), on_device = exact(Backend::cuda);
  options.solver.max_sweeps = on_device.solver.max_sweeps = 2;
  const Course expected = course_of(scene, Backend::cpu, options);
  const Course built_on_host = course_of(scene, Backend::cpu, on_device);
  const Course found = course_of(scene, Backend::cuda, on_device);
  expect_near_course(found, expected, 1e-7);
  EXPECT_EQ(found.outcome.sweeps, built_on_host.outcome.sweeps);
}

/// A contact far from the center of the last rigid box, which would drive it away and turn it by
/// more than half a turn: of the box and a frame, or of an elastic block and the box.
HandScene hit_box(bool by_elastic_block) {
  HandScene scene = stack_on_frame(1);
  scene.touches.resize(1);
  if (by_elastic_block) {
    scene.model = empty_model();
    add_block(scene.model, {.cells = {1, 1, 1}});
    add_rigid(scene.model, 1, {0.0125 / 3, 0.0125 / 3, 0.02 / 3}, {0, 0, -0.05});
    scene.make_surfaces(0.2);
    scene.touches[0].body_b = 1;
    scene.touches[0].point_a = on_nodes({0, 1, 2}, {0.2, 0.3, 0.5});
    scene.touches[0].point_b = on_rigid({0.1, 0.1, 0.05});
  }
  scene.touches[0].obstacle_velocity = {0, 0, -1e5};
  for (CollisionBody& body : scene.surfaces.surfaces.bodies) {
    body.triangle_end = body.first_triangle + 1;
  }
  return scene;
}

TEST(ContactSystemEmulated, ABoxThatWouldTurnTooFarStandsStill) {
  for (const bool by_elastic_block : {false, true}) {
    const HandScene scene = hit_box(by_elastic_block);
    for (const Backend backend : {Backend::cpu, Backend::cuda}) {
      const auto stepper = backend == Backend::cuda ? make_cuda_stepper(scene.model, {})
                                                    : make_cpu_stepper(scene.model, {});
      ContactSystem system(scene.surfaces, scene.model, exact(backend));
      ContactTracker tracker(materials(0));
      const StepInput input = input_for(scene.model, mixed_step, {0, 0, -9.81});
      stepper->solve(input);
      const auto contacts = scene.begin(tracker, scene.model.start, mixed_step);
      std::vector<Point3> velocity, of_stepper;
      stepper->get_velocities(velocity);
      take_calls();
      const ContactSolveOutcome outcome =
          system.solve(*stepper, scene.model.start, tracker, contacts, velocity);
      EXPECT_EQ(take_calls().count(DeviceCall::launch) > 0, backend == Backend::cuda);
      system.set_velocities(velocity, *stepper);
      stepper->get_velocities(of_stepper);

      EXPECT_FALSE(outcome.converged);
      const std::size_t box = at(scene.model.node_count);
      EXPECT_EQ(velocity[box], (Point3{0, 0, 0}));
      EXPECT_EQ(velocity[box + 1], (Point3{0, 0, 0}));
      EXPECT_EQ(system.solution().impulse, std::vector<double>(3));
      EXPECT_EQ(of_stepper, velocity);
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
