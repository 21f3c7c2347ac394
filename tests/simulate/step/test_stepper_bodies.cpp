#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
StepperOptions exact(int threads = 1) {
  StepperOptions options;
  options.linear_tolerance = 1e-13;
  options.threads = threads;
  return options;
}

/// Free fall without strain: backward Euler gives -g dt^2 n (n + 1) / 2 exactly.
TEST(BodyStepper, FallsFreely) {
  Model model = empty_model();
  add_block(model, {});
  add_rigid(model, 2, {1, 2, 3}, {5, 0, 0});
  const auto stepper = make_cpu_stepper(model, exact());

  for (int n = 0; n < 10; ++n) stepper->step(input_for(model, 0.01, {0, 0, -10}));

  const ModelState state = state_of(*stepper);
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    EXPECT_NEAR(state.position[i][2] - model.start.position[i][2], -10 * 1e-4 * 55, 1e-12);
  }
}

Model top_model(std::array<double, 3> spin) {
  Model model = empty_model();
  add_rigid(model, 1, {1, 2, 3}, {0, 0, 0});
  model.start.angular_momentum[0] = {spin[0], 2 * spin[1], 3 * spin[2]};
  model.start.velocity[1] = {spin[0], spin[1], spin[2]};
  return model;
}

/// Largest relative change of the energy in 20 s near the unstable axis; asserts that L stays.
double energy_change_of_top(double time_step) {
  const Model model = top_model({0.05, 5, 0.05});
  const auto stepper = make_cpu_stepper(model, exact());
  const double start = kinetic_energy(model, model.start);
  const StepInput input = input_for(model, time_step);
  double change = 0;
  const int steps = static_cast<int>(20 / time_step);
  for (int n = 0; n < steps; ++n) {
    stepper->step(input);
    const ModelState state = state_of(*stepper);
    EXPECT_LT(distance(state.angular_momentum[0], model.start.angular_momentum[0]), 1e-11);
    change = std::max(change, std::abs(kinetic_energy(model, state) / start - 1));
  }
  return change;
}

TEST(BodyStepper, KeepsTheMomentumAndEnergyOfAFreeTop) {
  const double coarse = energy_change_of_top(8e-3), fine = energy_change_of_top(4e-3);

  EXPECT_LT(coarse, 1e-4);
  EXPECT_NEAR(coarse / fine, 4, 0.4);
}

/// Each spring of a hanging chain stretches by the weight below it over its stiffness.
TEST(BodyStepper, HangsAChainOfRigidBodies) {
  for (const double stiffness : {1e3, 1e5, 1e7}) {
    Model model = empty_model();
    constexpr int links = 8;
    for (int i = 0; i < links; ++i) {
      add_rigid(model, 1, {0.01, 0.01, 0.01}, {0, 0, -0.2 * i});
      model.rigid.alpha.back() = 40;
    }
    add_spring(model, rigid_point(model, 0, {0, 0, 0.1}), world_point({0, 0, 0.1}), stiffness);
    for (int i = 1; i < links; ++i) {
      add_spring(model, rigid_point(model, i, {0, 0, 0.1}), rigid_point(model, i - 1, {0, 0, -0.1}),
                 stiffness);
    }
    const auto stepper = make_cpu_stepper(model, exact());

    for (int n = 0; n < 4000; ++n) stepper->step(input_for(model, 0.01, {0, 0, -10}));

    const ModelState state = state_of(*stepper);
    for (int i = 1; i < links; ++i) {
      const double gap = state.position[static_cast<std::size_t>(i) - 1][2] -
                         state.position[static_cast<std::size_t>(i)][2] - 0.2;
      EXPECT_NEAR(gap, (links - i) * 10 / stiffness, 1e-7 * (links - i) * 10 / stiffness + 1e-13)
          << stiffness;
    }
  }
}

/// Rigid, elastic and free bodies, some coupled: islands are (rigid, block, block) and (block).
Model coupled_model() {
  Model model = empty_model();
  const std::int32_t a = add_block(model, {.cells = {3, 2, 2}});
  const std::int32_t b = add_block(model, {.cells = {2, 2, 2}, .origin = {0.5, 0, 0}});
  add_block(model, {.cells = {2, 3, 2}, .origin = {0, 2, 0}, .youngs = 1e6});
  const std::int32_t r = add_rigid(model, 0.5, {1e-3, 2e-3, 2e-3}, {-0.2, 0.1, 0.1});
  add_rigid(model, 0.5, {1e-3, 2e-3, 2e-3}, {-3, 0.1, 0.1});
  ModelPoint inside = node_point(model, b);
  inside.node = {b, b + 1, b + 3, b + 9};
  inside.weight = {0.25, 0.25, 0.25, 0.25};
  add_spring(model, node_point(model, a + 3), inside, 300, 1);
  add_spring(model, node_point(model, a + 7), node_point(model, b + 3), 300);
  add_spring(model, rigid_point(model, r, {0.1, 0.02, 0}), node_point(model, a), 500, 2);
  add_spring(model, rigid_point(model, r, {0.1, 0, 0.05}), node_point(model, a + 4), 500);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.3);
  for (Point3& v : model.start.velocity) v = {normal(random), normal(random), normal(random)};
  model.start.angular_momentum = {{1e-3, 2e-3, -1e-3}, {0, 3e-3, 1e-3}};
  return model;
}

double largest_difference(const ModelState& a, const ModelState& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.position.size(); ++i) {
    most = std::max(most, distance(a.position[i], b.position[i]));
  }
  for (std::size_t i = 0; i < a.velocity.size(); ++i) {
    most = std::max(most, distance(a.velocity[i], b.velocity[i]));
  }
  return most;
}

ModelState after(const Model& model, const StepperOptions& options, int steps) {
  const auto stepper = make_cpu_stepper(model, options);
  for (int n = 0; n < steps; ++n) {
    EXPECT_TRUE(stepper->step(input_for(model, 5e-3, {0, 0, -9.81})).converged);
  }
  return state_of(*stepper);
}

TEST(BodyStepper, SolvesIslandsLikeTheWhole) {
  const Model islands = coupled_model();
  Model whole = islands;
  EXPECT_EQ(islands.island_count, 3);
  whole.island_count = 1;
  std::fill(whole.body_island.begin(), whole.body_island.end(), 0);

  StepperOptions options = exact();
  options.linear_tolerance = 1e-15;
  EXPECT_LT(largest_difference(after(islands, options, 60), after(whole, options, 60)), 1e-11);
}

TEST(BodyStepper, HasTheSameBitsForAnyNumberOfThreads) {
  Model model = coupled_model();
  Model large = empty_model();
  add_block(large, {.cells = {10, 9, 8}});  // an island of 990 rows is solved by several threads
  large.start.velocity[5] = {1, 2, 3};
  for (const Model& one : {model, large}) {
    const ModelState serial = after(one, exact(1), 5);
    for (const int threads : {2, 3, 7}) {
      const ModelState parallel = after(one, exact(threads), 5);

      EXPECT_EQ(parallel.position, serial.position);
      EXPECT_EQ(parallel.velocity, serial.velocity);
      EXPECT_EQ(parallel.rotation, serial.rotation);
      EXPECT_EQ(parallel.angular_momentum, serial.angular_momentum);
    }
  }
}

/// Springs between bodies push them apart equally.
TEST(BodyStepper, KeepsMomentumWithoutLoads) {
  const Model model = coupled_model();
  const auto stepper = make_cpu_stepper(model, exact());
  const Point3 before = momentum(model, model.start);

  for (int n = 0; n < 20; ++n) stepper->step(input_for(model, 5e-3));

  EXPECT_LT(distance(momentum(model, state_of(*stepper)), before), 1e-10);
}

/// Rotations are held within a step: a turn by an angle a in one step stretches by a^2 / 2, so
/// that fast spins of stiff bodies do gain energy. The spin here is slow, the vibration is not.
TEST(BodyStepper, NeverGainsEnergy) {
  for (const double youngs : {1e4, 1e6, 1e8}) {
    for (const double time_step : {1e-4, 1e-3, 5e-3, 2e-2}) {
      Model model = empty_model();
      add_block(model, {.cells = {3, 3, 3}, .youngs = youngs});
      for (std::size_t n = 0; n < model.start.velocity.size(); ++n) {
        const Point3& p = model.start.position[n];
        model.start.velocity[n] = {-0.1 * p[1] + 0.5 * p[0], 0.1 * p[0], 0.8 * p[2]};
      }
      const auto stepper = make_cpu_stepper(model, exact());
      const double start = kinetic_energy(model, model.start);
      double before = start;
      for (int n = 0; n < 100; ++n) {
        stepper->step(input_for(model, time_step));
        const ModelState state = state_of(*stepper);
        const double energy = kinetic_energy(model, state) + elastic_energy(model, state);

        EXPECT_LT(energy, before + 1e-4 * start) << youngs << " " << time_step;
        before = energy;
      }
      EXPECT_LE(before, start);
    }
  }
}

/// A column whose lowest nodes are held carries its weight there.
TEST(BodyStepper, HoldsPrescribedNodesWithTheirSupportImpulses) {
  Model model = empty_model();
  add_block(model, {.cells = {2, 2, 4}, .gamma = 0.05});
  for (std::size_t n = 0; n < 9; ++n) model.prescribed[n] = 1;
  const auto stepper = make_cpu_stepper(model, exact());
  StepInput input = input_for(model, 0.02, {0, 0, -9.81});

  for (int n = 0; n < 2000; ++n) stepper->step(input);

  double mass = 0;
  for (const double m : model.node_mass) mass += m;
  Point3 support{};
  for (const Point3& impulse : stepper->support_impulses()) {
    for (std::size_t i = 0; i < 3; ++i) support[i] += impulse[i] / 0.02;
  }
  EXPECT_NEAR(support[0], 0, 1e-6 * mass);
  EXPECT_NEAR(support[2], mass * 9.81, 1e-6 * mass);
  const ModelState state = state_of(*stepper);
  for (std::size_t n = 0; n < 9; ++n) {
    EXPECT_EQ(state.position[n], model.start.position[n]);
  }

  for (std::size_t n = 0; n < 9; ++n) input.prescribed_velocity[n] = {0.5, 0, 0.25};
  stepper->step(input);

  const ModelState driven = state_of(*stepper);
  for (std::size_t n = 0; n < 9; ++n) {
    EXPECT_EQ(driven.velocity[n], (Point3{0.5, 0, 0.25}));
    EXPECT_NEAR(driven.position[n][2], model.start.position[n][2] + 0.005, 1e-15);
  }
}

/// A handle's spring reaches its anchor; one that lets go has no force.
TEST(BodyStepper, FollowsTheAnchorOfAHandle) {
  Model model = empty_model();
  add_rigid(model, 1, {1, 1, 1}, {0, 0, 0});
  add_spring(model, rigid_point(model, 0, {0, 0, 0}), world_point({0, 0, 0}), 1e3, 50);
  model.springs.handle[0] = 0;
  const auto stepper = make_cpu_stepper(model, exact());
  StepInput input = input_for(model, 0.01);
  input.anchor[0] = {1, 2, 3};

  for (int n = 0; n < 1000; ++n) stepper->step(input);

  EXPECT_LT(distance(state_of(*stepper).position[0], {1, 2, 3}), 1e-9);
  input.anchor[0] = {5, 5, 5};
  input.is_active[0] = 0;
  stepper->step(input);
  EXPECT_LT(distance(state_of(*stepper).position[0], {1, 2, 3}), 1e-9);
}

TEST(BodyStepper, DampsRelativeToAMovingAnchor) {
  Model model = empty_model();
  add_rigid(model, 1, {1, 1, 1}, {0, 0, 0});
  add_spring(model, rigid_point(model, 0, {0, 0, 0}), world_point({0, 0, 0}), 1e3, 50);
  model.springs.handle[0] = 0;
  const auto stepper = make_cpu_stepper(model, exact());
  StepInput input = input_for(model, 0.01);
  input.anchor_velocity[0] = {2, 0, 0};

  for (int n = 1; n <= 1000; ++n) {
    input.anchor[0] = {2 * 0.01 * n, 0, 0};
    stepper->step(input);
  }

  const ModelState state = state_of(*stepper);
  EXPECT_LT(distance(state.velocity[0], {2, 0, 0}), 1e-9);
  EXPECT_LT(distance(state.position[0], {20, 0, 0}), 1e-8);
}

}  // namespace
}  // namespace tetwarp::test
