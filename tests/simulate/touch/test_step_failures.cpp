/// @file test_step_failures.cpp
/// A step that cannot be made names itself, bodies and a remedy, and leaves all as before.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/simulate/touch_run.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {

/// A box on a floor, and a ball that is pushed beyond the range of numbers from the sixth step on.
Scene overloaded(double force) {
  Scene scene = scene_of(
      {rigid_box("box", {0.1, 0.1, 0.1}, {0, 0, 0.101}), rigid_ball("ball", 0.1, {1, 0, 0.101})},
      0.01);
  scene.thickness = 1e-3;
  scene.obstacles = {plane_at(0)};
  scene.loads = {
      {.body = "ball", .select = {AllSelection{}}, .force = Point3{0, 0, -force}, .from = 0.055}};
  return scene;
}

TEST(StepFailure, NamesStepBodyAndRemedyAndLeavesAllAsBefore) {
  for (const double force : {1e300, 1.7e308}) {
    Simulator simulator(overloaded(force)), other(overloaded(0));
    std::string message;
    for (int n = 0; n < 8 && message.empty(); ++n) {
      message = message_of<std::runtime_error>([&] { simulator.step(); });
    }
    ASSERT_NE(message, "") << force;
    EXPECT_EQ(message.find("step 5: "), 0U) << message;
    EXPECT_NE(message.find("step 5: bodies["), std::string::npos) << message;
    EXPECT_NE(message.find("; "), std::string::npos) << message;
    EXPECT_EQ(simulator.step_index(), 5);
    run(other, 5);
    EXPECT_EQ(places_of(simulator), places_of(other));
    EXPECT_EQ(simulator.record().contacts, other.record().contacts);
    // The same failure again, and no other: nothing is left of the first.
    EXPECT_EQ(message_of<std::runtime_error>([&] { simulator.step(); }), message);
  }
}

}  // namespace
}  // namespace tetwarp::test
