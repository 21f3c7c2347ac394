/// The parts of a step between which contact changes the velocities, on cpu and the emulated
/// device.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "host/base/point3.hpp"
#include "host/simulate/model/rotations.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
constexpr double move_step = 5e-3;

/// An elastic block with a held node, and a spinning rigid body coupled to it.
Model coupled_bodies() {
  Model model = empty_model();
  const std::int32_t block = add_block(model, {.cells = {2, 1, 1}});
  model.prescribed[0] = 1;
  const std::int32_t rigid = add_rigid(model, 0.5, {1e-3, 2e-3, 2e-3}, {-0.2, 0.1, 0.1});
  add_spring(model, rigid_point(model, rigid, {0.1, 0.02, 0}), node_point(model, block + 3), 500);
  for (std::size_t i = 1; i < model.start.velocity.size(); ++i) {
    model.start.velocity[i] = {0.1 * std::sin(1.0 * static_cast<double>(i)), 0.2, -0.1};
  }
  model.start.angular_momentum[0] = {1e-3, 2e-3, -1e-3};
  return model;
}

StepInput coupled_input(const Model& model) {
  StepInput input = input_for(model, move_step, {0, 0, -9.81});
  input.prescribed_velocity[0] = {0.1, 0, 0.2};
  return input;
}

std::vector<std::unique_ptr<BodyStepper>> both(const Model& model) {
  StepperOptions options;
  options.linear_tolerance = 1e-13;
  std::vector<std::unique_ptr<BodyStepper>> steppers;
  steppers.push_back(make_cpu_stepper(model, options));
  steppers.push_back(make_cuda_stepper(model, options));
  return steppers;
}

TEST(StepperMove, ReturnsTheSystemThatItSolved) {
  const Model model = coupled_bodies();
  for (const auto& stepper : both(model)) {
    stepper->solve(coupled_input(model));
    const StepSystem system = stepper->system();
    const SystemRows& rows = system.rows;
    ASSERT_EQ(rows.count, model.block_count());
    ASSERT_EQ(rows.unknown_count, model.block_count() - 1);
    for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
      for (int i = 0; i < 3; ++i) {
        double sum = -system.load[3 * row + i];
        for (std::int32_t k = rows.start[row]; k < rows.free_end[row]; ++k) {
          for (int c = 0; c < 3; ++c) {
            sum += system.values[9 * k + 3 * c + i] * system.velocity[3 * rows.column[k] + c];
          }
        }
        EXPECT_NEAR(sum, 0, 1e-11);
      }
    }
  }
}

TEST(StepperMove, MovesByTheVelocitiesThatItWasGiven) {
  const Model model = coupled_bodies();
  const auto free_stepper = make_cpu_stepper(model, {});
  free_stepper->step(coupled_input(model));
  const ModelState free_state = state_of(*free_stepper);
  for (const auto& stepper : both(model)) {
    stepper->solve(coupled_input(model));
    std::vector<Point3> velocity;
    stepper->get_velocities(velocity);
    velocity[5] = {1, 2, 3};
    const std::size_t angular = velocity.size() - 1;
    velocity[angular] = {0.4, -0.3, 0.2};
    stepper->set_velocities(velocity);
    EXPECT_GE(stepper->move(move_step, {}), 0);

    const ModelState state = state_of(*stepper);
    EXPECT_EQ(state.velocity[5], (Point3{1, 2, 3}));
    EXPECT_LT(
        distance(state.position[5], plus(model.start.position[5], times(move_step, {1, 2, 3}))),
        1e-15);
    EXPECT_LT(distance(axis_angle_of(state.rotation[0]), times(move_step, velocity[angular])),
              1e-15);
    EXPECT_GT(distance(state.angular_momentum[0], free_state.angular_momentum[0]), 1e-6);
    // A v - b of the held node, whose neighbor is not the one that was changed by hand.
    EXPECT_GT(norm(stepper->support_impulses()[0]), 0);
  }
}

TEST(StepperMove, MovesBodiesByTheirFractionOfTheStep) {
  const Model model = coupled_bodies();
  for (const auto& stepper : both(model)) {
    stepper->solve(coupled_input(model));
    std::vector<Point3> velocity;
    stepper->get_velocities(velocity);
    stepper->move(move_step, std::vector<double>{0.25, 0.5});

    const ModelState state = state_of(*stepper);
    for (std::int32_t n = 0; n <= model.node_count; ++n) {
      const auto i = static_cast<std::size_t>(n);
      const double share = n < model.node_count ? 0.25 : 0.5;
      EXPECT_LT(distance(state.position[i],
                         plus(model.start.position[i], times(share * move_step, velocity[i]))),
                1e-15);
      EXPECT_EQ(state.velocity[i], velocity[i]);
    }
    const Point3 turn = axis_angle_of(state.rotation[0]);
    EXPECT_LT(distance(turn, times(0.5 * move_step, velocity.back())), 1e-15);
  }
}

TEST(StepperMove, IsTheStepWithoutFractions) {
  const Model model = coupled_bodies();
  for (const auto& stepper : both(model)) {
    const auto whole = make_cpu_stepper(model, {.linear_tolerance = 1e-13});
    whole->step(coupled_input(model));
    stepper->solve(coupled_input(model));
    stepper->move(move_step, std::vector<double>{1, 1});

    const ModelState one = state_of(*whole), other = state_of(*stepper);
    for (std::size_t i = 0; i < one.position.size(); ++i) {
      EXPECT_LT(distance(one.position[i], other.position[i]), 1e-13);
    }
    const auto supports = stepper->support_impulses();
    EXPECT_LT(distance(supports[0], whole->support_impulses()[0]), 1e-11);
  }
}

TEST(StepperMove, RefusesFractionsOfTooFewBodies) {
  const Model model = coupled_bodies();
  for (const auto& stepper : both(model)) {
    stepper->solve(coupled_input(model));
    EXPECT_THROW(stepper->move(move_step, std::vector<double>{1}), std::invalid_argument);
    EXPECT_THROW(stepper->set_velocities({}), std::invalid_argument);
  }
}

}  // namespace
}  // namespace tetwarp::test
