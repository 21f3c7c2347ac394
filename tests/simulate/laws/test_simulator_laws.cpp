/// Closed forms of whole scenes through the Simulator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {

/// A chain of rigid boxes that hangs by springs: each gap is the weight below over its stiffness.
TEST(SpringChain, GapsAreWeightOverStiffness) {
  for (const double stiffness : {1e4, 1e6}) {
    Scene scene;
    for (int i = 0; i < 5; ++i) {
      Body body = rigid_box("box" + std::to_string(i), {0.05, 0.05, 0.05}, {0, 0, -0.2 * i});
      body.damping.alpha = 5;
      scene.bodies.push_back(body);
    }
    scene = scene_of(scene.bodies, 0.01);
    for (int i = 0; i < 5; ++i) {
      const double top = -0.2 * i + 0.1;
      scene.couplings.push_back({.a = "box" + std::to_string(i),
                                 .b = i == 0 ? "world" : "box" + std::to_string(i - 1),
                                 .points = {{0.05, 0.05, top},
                                            {-0.05, 0.05, top},
                                            {0.05, -0.05, top},
                                            {-0.05, -0.05, top}},
                                 .stiffness = stiffness});
    }
    Simulator simulator(scene);
    run(simulator, 3000);
    const StepRecord& record = simulator.record();

    const double weight = simulator.body(0).mass * 9.81;
    double above = 0;  // how far the body above has sunk
    for (std::size_t i = 0; i < 5; ++i) {
      const double sunk = -0.2 * static_cast<double>(i) - record.bodies[i].center[2];
      const double expected = static_cast<double>(5 - i) * weight / stiffness;
      EXPECT_NEAR((sunk - above) / expected, 1, 1e-7) << stiffness << " " << i;
      EXPECT_NEAR(record.coupling_forces[i][2] / (static_cast<double>(5 - i) * weight), 1, 1e-7);
      above = sunk;
    }
  }
}

/// The tension turns a light body within much less than a step, as a pendulum: with the arms of the
/// start alone these chains gain energy.
TEST(SpringChain, OfLightBodiesUnderAHeavyOneGainsNoEnergy) {
  for (const std::size_t links : {3, 4, 5}) {
    for (const double time_step : {2e-3, 1e-2, 2e-2}) {
      std::vector<Body> bodies;
      std::vector<Coupling> couplings;
      double top = 0;
      for (std::size_t i = 0; i < links; ++i) {
        const bool is_last = i + 1 == links;
        const double half = is_last ? 0.2 : 0.05, width = is_last ? 0.2 : 0.02;
        bodies.push_back(
            rigid_box("link" + std::to_string(i), {width, width, half}, {0, 0, top - half}));
        bodies.back().collide = false;
        bodies.back().rigid.density = (is_last ? 100 : 1) / (8 * width * width * half);
        if (is_last) bodies.back().velocity = {1, 0.5, 0};
        couplings.push_back({.a = bodies.back().name,
                             .b = i == 0 ? "world" : bodies[i - 1].name,
                             .points = {{0, 0, top}},
                             .stiffness = 1e6});
        top -= 2 * half;
      }
      Scene scene = scene_of(std::move(bodies), time_step);
      scene.couplings = couplings;
      Simulator simulator(scene);
      const double kinetic = 0.5 * 100 * 1.25;  // of the start [J]
      double start = 0, most = -1e9;
      for (int step = 0; step < static_cast<int>(2 / time_step); ++step) {
        run(simulator, 1);
        const double energy = simulator.record().energy.total();
        if (step == 0) start = energy;
        most = std::max(most, energy);
      }
      EXPECT_LT(most - start, 1e-3 * kinetic) << links << " links, dt " << time_step;
    }
  }
}

/// y = a cosh(x / a) of the span 1 and the length 1.3.
double catenary_parameter() {
  double low = 0.1, high = 10;
  for (int i = 0; i < 200; ++i) {
    const double a = (low + high) / 2;
    (2 * a * std::sinh(0.5 / a) > 1.3 ? low : high) = a;
  }
  return low;
}

/// Largest distance of a hanging strip's points from the catenary of its span and length.
double catenary_error(std::int64_t segments) {
  Body strip = sheet_body("strip", {1.3, 0.05}, {segments, 1});
  strip.cloth = {1.0, 1e5, 1e5, 0};
  strip.damping = {4, 0};
  strip.fixed = {NodeSelection{{0, static_cast<std::int64_t>(segments + 1)}}};
  const auto last = static_cast<std::int64_t>(segments);
  strip.driven = {{{NodeSelection{{last, 2 * segments + 1}}},
                   {{0, Point3{0, 0, 0}}, {0.5, Point3{-0.3, 0, 0}}}}};
  Simulator simulator(scene_of({strip}, 0.02));
  run(simulator, 400);

  const double a = catenary_parameter();
  double error = 0;
  const auto positions = simulator.node_positions(0);
  for (std::int64_t u = 0; u <= segments; ++u) {
    // By length from the middle: s = a sinh(x / a).
    const double s = 1.3 * (static_cast<double>(u) / static_cast<double>(segments) - 0.5);
    const double x = a * std::asinh(s / a);
    const double z = a * std::cosh(x / a) - a * std::cosh(0.5 / a);
    const Point3& p = positions[static_cast<std::size_t>(u)];
    error = std::max(error, std::hypot(p[0] - 0.5 - x, p[2] - z));
  }
  return error;
}

TEST(Cloth, HangsInACatenary) {
  const double coarse = catenary_error(16), fine = catenary_error(32);
  EXPECT_LT(fine, 3e-4);
  EXPECT_NEAR(coarse / fine, 4, 1.2);
}

/// The fall of an elastic box on a handle: the error of backward Euler is of first order in dt.
TEST(Simulator, IsOfFirstOrderInTime) {
  const auto place = [](double dt) {
    Body body = elastic_box("body", {0.05, 0.05, 0.2}, {1, 1, 4});
    body.fixed = {HalfSpaceSelection{{0, 0, 1}, 0.19}};
    body.material = {2e4, 0.3, 1000};
    Simulator simulator(scene_of({body}, dt));
    run(simulator, static_cast<int>(std::lround(0.064 / dt)));
    return simulator.record().bodies[0].center[2];
  };
  const double exact = 2 * place(0.000125) - place(0.00025);  // extrapolated
  const double order = std::log2((place(0.004) - exact) / (place(0.002) - exact));
  EXPECT_GT(order, 0.9);
  EXPECT_LT(order, 1.05);
}

/// A free top keeps its angular momentum to rounding, its energy to second order.
TEST(Simulator, FreeTopKeepsItsAngularMomentum) {
  Body top = rigid_box("top", {0.3, 0.2, 0.1}, {0, 0, 0});
  top.angular_velocity = {0.05, 5, 0.05};
  Scene scene = scene_of({top}, 0.008);
  scene.gravity = {0, 0, 0};
  Simulator simulator(scene);
  const StepRecord start = simulator.record();
  double change = 0;
  for (int n = 0; n < 2500; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    change = std::max(change, std::abs(record.energy.kinetic / start.energy.kinetic - 1));
    ASSERT_EQ(record.substeps, 1);
  }
  const double size = norm(start.angular_momentum);
  EXPECT_LT(distance_of(simulator.record().angular_momentum, start.angular_momentum), 1e-12 * size);
  EXPECT_LT(change, 1e-4);
}

/// Bodies that turn by more than 0.5 rad in a step are stepped in parts.
TEST(Simulator, DividesStepsOfFastSpin) {
  Body top = rigid_box("top", {0.1, 0.1, 0.2}, {0, 0, 0});
  top.angular_velocity = {0, 0, 150};
  Scene scene = scene_of({top}, 0.01);
  Simulator simulator(scene);
  simulator.step();

  EXPECT_EQ(simulator.record().substeps, 4);
  EXPECT_NEAR(simulator.record().bodies[0].velocity[2], -0.0981, 1e-12);
  EXPECT_EQ(simulator.time(), 0.01);
}

/// The turn of a ball is exact and moves nothing, unless a spring holds it off its center.
TEST(Simulator, DividesStepsOfSpinningBallsOnlyWhereTheyAreHeld) {
  Body ball = rigid_box("ball", {0.1, 0.1, 0.1}, {0, 0, 0});
  ball.geometry = Shape{EllipsoidShape{{0.1, 0.1, 0.1}}};
  ball.angular_velocity = {90, 0, 120};
  Simulator simulator(scene_of({ball}, 0.01));
  simulator.step();
  EXPECT_EQ(simulator.record().substeps, 1);
  EXPECT_NEAR(norm(simulator.record().bodies[0].angular_velocity), 150, 1e-12);

  simulator.add_handle({.name = "hand", .body = "ball", .center = {0.1, 0, 0}, .stiffness = 1});
  simulator.step();
  EXPECT_EQ(simulator.record().substeps, 4);
}

/// Stiffness over twelve orders, and time steps from 0.01 to 50 ms: finite, and never a larger
/// energy than at the start.
TEST(Simulator, IsSoundForAllStiffnesses) {
  for (const double youngs : {1.0, 1e4, 1e8, 1e12}) {
    for (const double dt : {1e-5, 1e-3, 0.05}) {
      Body body = elastic_box("body", {0.1, 0.1, 0.1}, {2, 2, 2});
      body.material.youngs_modulus = youngs;
      body.angular_velocity = {0, 3, 1};
      body.fixed = {HalfSpaceSelection{{0, 0, 1}, 0.09}};
      Scene scene = scene_of({body}, dt);
      scene.solver.linear_tolerance = 1e-6;
      Simulator simulator(scene);
      const double start = simulator.record().energy.total();
      run(simulator, 10);
      const StepRecord& record = simulator.record();
      ASSERT_TRUE(std::isfinite(record.energy.total())) << youngs << " " << dt;
      EXPECT_LE(record.energy.total(), start + 1e-4 * std::abs(start)) << youngs << " " << dt;
    }
  }
}

/// The order of bodies changes results by rounding only.
TEST(Simulator, DoesNotDependOnTheOrderOfBodies) {
  std::vector<Body> bodies{elastic_box("a", {0.1, 0.1, 0.1}, {2, 2, 2}),
                           rigid_box("b", {0.1, 0.1, 0.1}, {0.2, 0, 0}),
                           sheet_body("c", {0.4, 0.4}, {3, 3})};
  for (Body& body : bodies) body.collide = false;
  const auto centers = [&](const std::array<std::size_t, 3>& order) {
    Scene scene = scene_of({bodies[order[0]], bodies[order[1]], bodies[order[2]]}, 0.01);
    scene.couplings = {
        {.a = "a", .b = "b", .select_a = {AllSelection{}}, .within = 0.05, .stiffness = 2e3},
        {.a = "c", .b = "a", .select_a = {AllSelection{}}, .stiffness = 50}};
    Simulator simulator(scene);
    run(simulator, 20);
    std::vector<Point3> result(3);
    for (std::size_t i = 0; i < 3; ++i) {
      result[order[i]] = simulator.record().bodies[i].center;
    }
    return result;
  };
  const auto expected = centers({0, 1, 2});
  for (const auto& order : {std::array<std::size_t, 3>{2, 0, 1}, {1, 2, 0}, {2, 1, 0}}) {
    const auto found = centers(order);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(distance_of(found[i], expected[i]), 1e-12);
  }
}

}  // namespace
}  // namespace tetwarp::test
