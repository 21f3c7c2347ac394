/// @file test_contact_moving.cpp
/// Restitution and prescribed velocities through the tracker, and normal springs whose gap is not
/// dt w_n: closed forms of a point mass, and the reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tetwarp/contact_tracker.hpp>
#include <vector>

#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp::test {
namespace {
constexpr double gravity = 9.81;  // m/s^2
constexpr double mass = 2;        // kg
constexpr double dt = 1e-3;       // s

SparseMatrix identity(double value) {
  return {3, 3, {0, 1, 2, 3}, {0, 1, 2}, {value, value, value}};
}

/// A point mass above the plane z = 0 of body 0, in one contact with it.
struct Point {
  double height = 0;
  double side = 0;  ///< x
  std::vector<double> v = {0, 0, 0};
  ContactTracker tracker;
  ReportedContact report = {};  ///< what it prescribes: velocities
  ContactSolution solution = {};

  std::vector<BodyPose> poses() const { return {{}, {{side, 0, height}, {1, 0, 0, 0}}}; }

  /// One step under gravity and a force along x.
  void step(double pull = 0) {
    report.key = {1, 0, 0, 0};
    report.point_a_world = {side, 0, height};
    report.point_b_world = {side, 0, 0};
    report.tangent = {1, 0, 0};
    report.area = 1;
    report.approach_speed = -v[2] - report.obstacle_velocity[2];
    const std::vector<TrackedContact> contacts =
        tracker.begin_step(std::vector{report}, poses(), dt);
    ContactProblem problem;
    tracker.fill(problem);
    problem.system = identity(mass);
    // The tracker names body 0 first, so that rows act on body 1 with the opposite sign.
    problem.jacobian = identity(0);
    for (std::size_t row = 0; row < 3; ++row) {
      problem.jacobian.row_start[row + 1] = 3 * static_cast<std::int64_t>(row + 1);
    }
    problem.jacobian.column = {0, 1, 2, 0, 1, 2, 0, 1, 2};
    problem.jacobian.value.clear();
    for (const Point3& axis : contacts[0].axes) {
      for (const double x : axis) problem.jacobian.value.push_back(-x);
    }
    problem.load = {mass * v[0] + dt * pull, 0, mass * (v[2] - gravity * dt)};
    solution = solve_contacts(problem, {.tolerance = 1e-12, .threads = 1});
    EXPECT_TRUE(solution.converged());
    v = solution.body_velocity;
    side += dt * v[0];
    height += dt * v[2];
    tracker.end_step(solution, poses());
  }
};

ContactTrackerOptions material(const ContactMaterial& choice, double restitution_speed = 0) {
  ContactTrackerOptions options;
  options.materials = {choice};
  options.restitution_speed = restitution_speed;
  return options;
}

TEST(ContactRestitution, SeparatesWithItsShareOfTheApproachSpeed) {
  for (const double e : {0.25, 0.5, 1.0}) {
    Point ball{.height = 0.1, .tracker = ContactTracker(material({.restitution = e}))};
    double before = 0;
    while (ball.v[2] <= 0) {
      before = -ball.v[2];
      ball.step();
      ASSERT_GE(ball.height, 0);
    }
    EXPECT_GT(before, 1.3);  // sqrt(2 g h) = 1.4
    EXPECT_NEAR(ball.v[2], e * before, 1e-12);
  }
}

TEST(ContactRestitution, NoneClosesTheGapAndSlowContactsDoNotRebound) {
  Point dull{.height = 0.1, .tracker = ContactTracker(material({}))};
  Point slow{.height = 0.1, .tracker = ContactTracker(material({.restitution = 0.9}, 10))};
  for (int step = 0; step < 300; ++step) {
    dull.step();
    slow.step();
  }
  for (const Point* point : {&dull, &slow}) {
    EXPECT_NEAR(point->height, 0, 1e-12);
    EXPECT_NEAR(point->v[2], 0, 1e-10);
  }
}

/// e = 1 keeps the energy of a fall, but for the order of the steps: v after k impacts is constant.
TEST(ContactRestitution, AnElasticBallBouncesOnWithTheSameSpeed) {
  Point ball{.height = 0.05, .tracker = ContactTracker(material({.restitution = 1}))};
  std::vector<double> speeds;
  for (int step = 0; step < 1000; ++step) {
    const double before = ball.v[2];
    ball.step();
    if (before < 0 && ball.v[2] > 0) speeds.push_back(ball.v[2]);
  }
  ASSERT_GE(speeds.size(), 3U);
  for (const double speed : speeds) EXPECT_NEAR(speed, speeds[0], 0.02 * speeds[0]);
}

/// A floor that rises carries the mass with it, by its pose or by its velocity alone.
TEST(ContactMoving, AnObstacleThatRisesPushes) {
  Point mass_point{.tracker = ContactTracker(material({}))};
  mass_point.report.obstacle_velocity = {0, 0, -0.3};  // of a, the mass, relative to b, the floor

  mass_point.step();

  EXPECT_NEAR(mass_point.v[2], 0.3, 1e-12);
  EXPECT_NEAR(mass_point.solution.impulse[0], mass * (0.3 + gravity * dt), 1e-10);
}

/// From rest the mass slides at mu g until it has the speed of the belt, then moves with it.
TEST(ContactMoving, ABeltAcceleratesAndThenCarries) {
  constexpr double mu = 0.4, belt = 0.2;
  Point box{.tracker = ContactTracker(material({.friction = mu}))};
  box.report.surface_velocity = {-belt, 0, 0};
  for (int step = 1; step <= 100; ++step) {
    box.step();
    const double expected = std::min(mu * gravity * dt * step, belt);
    ASSERT_NEAR(box.v[0], expected, 1e-10) << "step " << step;
  }
  EXPECT_NEAR(box.v[0], belt, 1e-10);
  // A pull beyond mu m g makes it slide over the belt.
  const double pull = 1.5 * mu * mass * gravity;
  box.step(pull);
  EXPECT_NEAR(box.v[0], belt + dt * 0.5 * mu * gravity, 1e-10);
}

/// The bond to a belt is stretched by its motion: held by a spring k, the mass moves with the belt,
/// and a mass that does not move pulls with area C beta^2 times the way of the belt.
TEST(ContactMoving, BondsFollowTheSurface) {
  constexpr double belt = 0.1, stiffness = 1e5;
  ContactTracker tracker(material({.stiffness = stiffness, .initial_intensity = 1}));
  ReportedContact report;
  report.key = {1, 0, 0, 0};
  report.area = 1e-2;
  report.tangent = {1, 0, 0};
  report.surface_velocity = {-belt, 0, 0};
  const std::vector<BodyPose> poses(2);
  ContactSolution still;
  still.impulse.assign(3, 0);
  Point3 gap = {0, 0, 0};
  for (int step = 0; step < 5; ++step) {
    const TrackedContact contact = tracker.begin_step(std::vector{report}, poses, dt).front();
    gap = contact.gap;
    EXPECT_NEAR(std::abs(gap[1]), step * dt * belt, 1e-15);
    EXPECT_NEAR(std::abs(contact.surface_velocity[1]), belt, 1e-15);
    still.velocity = {0, contact.surface_velocity[1], contact.surface_velocity[2]};
    tracker.end_step(still, poses);
  }
  EXPECT_NEAR(gap[0], 0, 1e-15);
}

/// Velocity and pulling force of one glued mass whose offset w_n is not gap / dt.
TEST(ContactMoving, SpringsSeeTheGapAndNotTheOffset) {
  constexpr double gap = 1e-4, kappa = 0.5;  // kg
  ContactProblem problem;
  problem.system = identity(mass);
  problem.jacobian = {3, 3, {0, 1, 2, 3}, {2, 0, 1}, {1, 1, 1}};
  problem.load = {0, 0, mass * 0.2};
  problem.velocity_offset = {-0.05, 0, 0};  // separates with 0.05 m/s or more
  problem.friction = {0.3};
  problem.adhesion = {.time_step = dt,
                      .area = {1},
                      .stiffness = {kappa / (dt * dt)},
                      .tangential_stiffness = {},
                      .intensity = {1},
                      .gap = {gap, 0, 0},
                      .energy = {},
                      .viscosity = {},
                      .bonding_rate = {},
                      .saturation_pressure = {}};

  for (const Backend backend : {Backend::cpu, Backend::reference}) {
    const ContactSolution solution =
        solve_contacts(problem, {.tolerance = 1e-12, .backend = backend});

    // m (v - 0.2) = -kappa (v + gap / dt)
    const double v = (mass * 0.2 - kappa * gap / dt) / (mass + kappa);
    EXPECT_TRUE(solution.converged());
    EXPECT_NEAR(solution.body_velocity[2], v, 1e-12);
    EXPECT_NEAR(solution.velocity[0], v - 0.05, 1e-12);
    EXPECT_NEAR(solution.impulse[0], -kappa * (v + gap / dt), 1e-12);
    EXPECT_NEAR(evolve_adhesion(problem, solution).gap[0], gap + dt * v, 1e-15);
    EXPECT_LE(residual_of(problem, solution.impulse, solution.body_velocity).eta, 1e-11);
  }
}

/// Any offsets and gaps: the reference has its own form of the law.
TEST(ContactMoving, AgreesWithTheReference) {
  std::mt19937 random(91);
  for (const FrictionLaw law : {FrictionLaw::cone, FrictionLaw::pyramid}) {
    for (int round = 0; round < 10; ++round) {
      ContactProblem problem = samples::random_global(random, 3, 6, 0, 0.4);
      problem.adhesion = samples::adhesion_of(
          random, std::vector<double>(problem.friction.size(), round % 2 == 0 ? 0.5 : 0));
      problem.impulse_guess.assign(3 * problem.friction.size(), 0.1);
      std::uniform_real_distribution<double> gap(-0.2, 0.2);
      for (std::size_t c = 0; c < problem.friction.size(); ++c) {
        problem.adhesion.gap[3 * c] = problem.adhesion.time_step * gap(random);
      }

      const ContactSolution solution = solve_contacts(problem, {.law = law, .tolerance = 1e-10});
      const ContactSolution expected =
          solve_contacts(problem, {.law = law, .tolerance = 1e-10, .backend = Backend::reference});

      ASSERT_TRUE(solution.converged() && expected.converged()) << "round " << round;
      for (std::size_t d = 0; d < solution.body_velocity.size(); ++d) {
        EXPECT_NEAR(solution.body_velocity[d], expected.body_velocity[d], 1e-6)
            << "round " << round;
      }
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
