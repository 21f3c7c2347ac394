/// @file test_law_slopes.cpp
/// Rigid bodies on slopes: closed forms of friction, rolling and tipping.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {
constexpr double degree = std::numbers::pi / 180;

struct Ride {
  Point3 velocity{}, turning{};  ///< [m/s], [rad/s]
  double time = 0;
  bool converged = true;
  std::int64_t clamped = 0, contacts = 0;
  std::int64_t parts = 0;  ///< of a step, at most
};

/// Steps a body that starts on a slope.
Ride ride(const Body& body, double angle, double friction, double time_step, int steps) {
  Scene scene = floor_scene({body}, time_step, friction);
  scene.gravity = gravity_on_slope(angle);
  Simulator simulator(scene);
  Ride ride;
  for (int n = 0; n < steps; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    ride.converged = ride.converged && record.converged;
    ride.clamped += record.clamped_islands;
    ride.contacts = std::max(ride.contacts, record.contacts);
    ride.parts = std::max<std::int64_t>(ride.parts, record.substeps);
  }
  const BodyRecord& end = simulator.record().bodies[0];
  ride.velocity = end.velocity;
  ride.turning = end.angular_velocity;
  ride.time = simulator.time();
  return ride;
}

Body resting_ball() {
  return exact_ball("ball", 0.05, {0, 0, 0.05 + 1e-4});
}

/// It rolls with 5/7 g sin while friction holds: below tan = 7/2 mu.
TEST(BallOnASlope, RollsWithFiveSeventhsOfTheFall) {
  for (const auto& [angle, friction] :
       {std::pair{20 * degree, 0.5}, std::pair{20 * degree, 0.2}, std::pair{40 * degree, 0.5}}) {
    const Ride end = ride(resting_ball(), angle, friction, 1e-3, 200);
    const double speed = 5 / 7. * earth * std::sin(angle) * end.time;
    EXPECT_NEAR(end.velocity[0] / speed, 1, 1e-12) << angle << " " << friction;
    EXPECT_NEAR(end.turning[1] * 0.05 / speed, 1, 1e-12);
    EXPECT_NEAR(end.velocity[2], 0, 1e-12 * speed);
    EXPECT_NEAR(end.velocity[1], 0, 1e-12 * speed);
    EXPECT_TRUE(end.converged);
    EXPECT_EQ(end.clamped, 0);
    EXPECT_EQ(end.contacts, 1);
  }
}

/// Whatever it turns by in a step: nothing that touches turns. It slides until it rolls with
/// (5 v + 2 r omega) / 7 of the start, as the angular momentum about the floor stays.
TEST(BallOnAFloor, RollsAfterAnySpinWithoutPartsOfSteps) {
  for (const double spin : {-40.0, -400.0, 1000.0}) {
    Body ball = resting_ball();
    ball.velocity = {1, 0, 0};
    ball.angular_velocity = {0, spin, 0};
    const double speed = (5 + 2 * 0.05 * spin) / 7;
    const Ride end = ride(ball, 0, 2, 8e-3, 150);
    EXPECT_NEAR(end.velocity[0] / speed, 1, 1e-11) << spin;
    EXPECT_NEAR(end.turning[1] * 0.05 / speed, 1, 1e-11) << spin;
    EXPECT_TRUE(end.converged);
    EXPECT_EQ(end.clamped, 0);
    EXPECT_EQ(end.parts, 1) << spin;
  }
}

TEST(BallOnASlope, SlidesAndSpinsBeyondItsFriction) {
  for (const auto& [angle, friction] : {std::pair{40 * degree, 0.2}, std::pair{60 * degree, 0.3}}) {
    const Ride end = ride(resting_ball(), angle, friction, 1e-3, 200);
    const double speed = earth * (std::sin(angle) - friction * std::cos(angle)) * end.time;
    const double spin = 2.5 * friction * earth * std::cos(angle) / 0.05 * end.time;
    EXPECT_NEAR(end.velocity[0] / speed, 1, 1e-12) << angle << " " << friction;
    EXPECT_NEAR(end.turning[1] / spin, 1, 1e-12);
    EXPECT_TRUE(end.converged);
  }
}

/// Rolling ends where friction is 2/7 of the slope.
TEST(BallOnASlope, BeginsToSlideAtTwoSevenths) {
  const double angle = 30 * degree, limit = 2 / 7. * std::tan(angle);
  for (const double part : {1 + 1e-6, 1 - 1e-6}) {
    const Ride end = ride(resting_ball(), angle, part * limit, 1e-3, 100);
    const double slip = end.velocity[0] - 0.05 * end.turning[1];
    const double beyond = std::max(1 - part, 0.0);
    // g sin - 7/2 mu g cos, per second.
    const double expected = earth * std::sin(angle) * beyond * end.time;
    EXPECT_NEAR(slip, expected, 1e-12) << part;
  }
}

/// A box whose shape has the corners of its eight vertices; it touches by its surface.
Body resting_box(double half_width, double half_height) {
  Body box =
      rigid_box("box", {half_width, half_width, half_height}, {0, 0, half_height + 1e-4 + 1e-12});
  return box;
}

TEST(BoxOnASlope, SticksUpToItsFriction) {
  const double friction = 0.4;
  for (const double part : {0.9, 0.99, 0.999}) {
    const Ride end = ride(resting_box(0.1, 0.03), std::atan(part * friction), friction, 0.01, 100);
    EXPECT_LT(norm(end.velocity), 1e-10) << part;
    EXPECT_LT(norm(end.turning), 1e-9) << part;
    EXPECT_TRUE(end.converged);
  }
}

TEST(BoxOnASlope, SlidesBeyondItsFriction) {
  const double friction = 0.4;
  for (const double part : {1.001, 1.01, 1.1}) {
    const double angle = std::atan(part * friction);
    const Ride end = ride(resting_box(0.1, 0.03), angle, friction, 0.01, 100);
    const double speed = earth * (std::sin(angle) - friction * std::cos(angle)) * end.time;
    EXPECT_NEAR(end.velocity[0] / speed, 1, 1e-4) << part;
    EXPECT_LT(norm(end.turning), 1e-6) << part;
    EXPECT_TRUE(end.converged);
  }
}

/// It tips where the slope is steeper than half-width over half-height w / h, and then falls about
/// its lower edge: with d = (w, h) and the moment 4/3 m d^2 about the edge, the turn grows as
/// sinh(s t) with s^2 = 3/4 g / |d|.
TEST(BoxOnASlope, TipsBeyondTheAngleOfItsDiagonal) {
  const double w = 0.05, h = 0.1, diagonal = std::hypot(w, h);
  for (const double part : {0.99, 1.01}) {
    const double angle = std::atan(part * w / h);
    const Ride end = ride(resting_box(w, h), angle, 2, 0.002, 100);
    EXPECT_TRUE(end.converged);
    if (part < 1) {
      EXPECT_LT(norm(end.turning), 1e-9);
      EXPECT_LT(norm(end.velocity), 1e-10);
    } else {
      const double start =
          0.75 * earth * (h * std::sin(angle) - w * std::cos(angle)) / (diagonal * diagonal);
      const double rate = std::sqrt(0.75 * earth / diagonal);
      EXPECT_NEAR(end.turning[1] / (start / rate * std::sinh(rate * end.time)), 1, 0.05);
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
