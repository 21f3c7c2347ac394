/// @file test_rest_growth.cpp
/// Bodies that start small grow to their full size within 0.2 s.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/simulate/start/rest_growth.hpp"
#include "host/simulate/step/scene_drive.hpp"
#include "host/simulate/step/scene_loads.hpp"
#include "tests/simulate/touch_scenes.hpp"

namespace tetwarp::test {
namespace {

/// A body alone, without contact, that starts at a part of its size.
class GrowingBody {
 public:
  GrowingBody(const Body& body, double scale)
      : scene_(scene_of({body}, 0.004)),
        geometry_(make_scene_geometry(scene_)),
        model_(make_model(scene_, geometry_)),
        full_(model_.start.position) {
    scene_.gravity = {0, 0, 0};
    const ShrunkBody shrunk{0, full_[5], scale};
    for (std::size_t n = 0; n < full_.size(); ++n) {
      model_.start.position[n] = plus(shrunk.center, times(scale, minus(full_[n], shrunk.center)));
    }
    growth_ = RestGrowth(geometry_, model_, full_, {shrunk});
    state_ = model_.start;
    StepperOptions options;
    options.linear_tolerance = 1e-12;
    stepper_ = make_cpu_stepper(model_, options);
    stepper_->set_state(state_);
  }

  void run(double until) {
    SceneDrive drive(scene_, geometry_, model_);
    const SceneLoads loads(scene_, geometry_, model_);
    StepInput input;
    for (; time_ < until - 1e-9; time_ += scene_.time_step) {
      drive.fill(state_, time_ + scene_.time_step, scene_.time_step, input);
      loads.forces(state_, time_ + scene_.time_step, input.block_force);
      growth_.apply(model_, state_, input);
      stepper_->step(input);
      stepper_->get_state(state_);
    }
  }

  /// Lengths of edges of elements or cloth over those at rest: least and largest.
  std::array<double, 2> stretch() const {
    double least = 1e9, largest = 0;
    const auto add = [&](std::int32_t a, std::int32_t b) {
      const double ratio = distance_of(at(state_.position, a), at(state_.position, b)) /
                           distance_of(at(full_, a), at(full_, b));
      least = std::min(least, ratio);
      largest = std::max(largest, ratio);
    };
    for (const auto& tet : model_.tets.nodes) {
      for (std::size_t a = 0; a < 4; ++a) add(tet[a], tet[(a + 1) % 4]);
    }
    for (const auto& [a, b] : model_.edges.nodes) add(a, b);
    return {least, largest};
  }
  Point3 momentum() const {
    Point3 sum{0, 0, 0};
    for (std::size_t n = 0; n < full_.size(); ++n) {
      sum = plus(sum, times(model_.node_mass[n], state_.velocity[n]));
    }
    return sum;
  }
  const ModelState& state() const { return state_; }
  const std::vector<Point3>& full() const { return full_; }

 private:
  Scene scene_;
  SceneGeometry geometry_;
  Model model_;
  std::vector<Point3> full_;
  RestGrowth growth_;
  ModelState state_;
  std::unique_ptr<BodyStepper> stepper_;
  double time_ = 0;
};

Body turned_block() {
  Body body = elastic_box("block", {0.1, 0.05, 0.05}, {4, 2, 2});
  body.pose = {{1, 2, 3}, {0.5, 0.5, -0.5, 0.5}};
  return body;
}

TEST(RestGrowth, ElasticBodiesGrowToTheirSize) {
  for (const double scale : {0.9, 0.5, 0.1}) {
    GrowingBody body(turned_block(), scale);
    body.run(0.1);
    const double half = (1 + scale) / 2;
    EXPECT_NEAR(body.stretch()[0], half, 0.03) << scale;
    EXPECT_NEAR(body.stretch()[1], half, 0.03) << scale;
    EXPECT_LT(norm(body.momentum()), 1e-9);
    body.run(0.22);
    EXPECT_NEAR(body.stretch()[0], 1, 0.02) << scale;
    EXPECT_NEAR(body.stretch()[1], 1, 0.02) << scale;
    body.run(1);
    EXPECT_NEAR(body.stretch()[0], 1, 1e-6) << scale;
    EXPECT_NEAR(body.stretch()[1], 1, 1e-6) << scale;
  }
}

TEST(RestGrowth, ClothGrowsToItsSize) {
  Body cloth = sheet_body("cloth", {0.3, 0.2}, {6, 4});
  GrowingBody body(cloth, 0.3);
  body.run(0.1);
  EXPECT_NEAR(body.stretch()[0], 0.65, 0.05);
  EXPECT_NEAR(body.stretch()[1], 0.65, 0.05);
  body.run(1);
  EXPECT_NEAR(body.stretch()[0], 1, 1e-3);
  EXPECT_NEAR(body.stretch()[1], 1, 1e-3);
}

/// Without growth the same body would burst at once.
TEST(RestGrowth, FixedAndDrivenNodesGrowWithTheirBody) {
  Body block = turned_block();
  block.pose = {};
  block.fixed = {HalfSpaceSelection{{-1, 0, 0}, 0.099}};
  block.driven = {
      {{HalfSpaceSelection{{1, 0, 0}, 0.099}}, {{0, Point3{0, 0, 0}}, {0.4, Point3{0.01, 0, 0}}}}};
  GrowingBody body(block, 0.5);
  body.run(0.5);
  for (std::size_t n = 0; n < body.full().size(); ++n) {
    const Point3& full = body.full()[n];
    const Point3& now = body.state().position[n];
    if (full[0] < -0.099) {
      EXPECT_LT(distance_of(now, full), 1e-12);
    }
    if (full[0] > 0.099) {
      EXPECT_LT(distance_of(now, plus(full, {0.01, 0, 0})), 1e-12);
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
