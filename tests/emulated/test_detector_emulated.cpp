/// @file test_detector_emulated.cpp
/// The detector of back end cuda on the emulated device against that of cpu: the same pairs.
#include <gtest/gtest.h>

#include "tests/collide/collide_scenes.hpp"
#include "tests/emulated/device_calls.hpp"

namespace tetwarp::test {
namespace {
void expect_equal(const DetectionCounts& a, const DetectionCounts& b) {
  EXPECT_EQ(a.skipped_items, b.skipped_items);
  EXPECT_EQ(a.grid_entries, b.grid_entries);
  EXPECT_EQ(a.box_tests, b.box_tests);
  EXPECT_EQ(a.box_pairs, b.box_pairs);
  EXPECT_EQ(a.pairs, b.pairs);
  EXPECT_EQ(a.evaluations, b.evaluations);
  EXPECT_EQ(a.reused, b.reused);
}

/// The emulated device computes with the host's rounding.
void expect_equal(const ChosenTouch& a, const ChosenTouch& b) {
  EXPECT_EQ(a.touch, b.touch);
  EXPECT_EQ(a.area, b.area);
}

void expect_same_touches(const CollideScene& scene, Detector& cpu, Detector& cuda) {
  std::vector<CollideScene> pass(3, scene);
  std::mt19937 random(3);
  for (std::size_t k = 1; k < pass.size(); ++k) {
    for (std::int32_t b = 0; b < scene.body_count(); ++b) pass[k].shake_body(b, 0.02, random);
  }
  for (const CollideScene& moved : pass) {
    EXPECT_EQ(cuda.find_touches(moved.motion), cpu.find_touches(moved.motion));
    EXPECT_EQ(cuda.reached(), cpu.reached());
    const auto expected = cpu.touches(), touches = cuda.touches();
    ASSERT_EQ(touches.size(), expected.size());
    for (std::size_t t = 0; t < touches.size(); ++t) expect_equal(touches[t], expected[t]);
  }
}

void expect_parity(const CollideScene& scene) {
  const auto cpu = make_cpu_detector(scene.surfaces, {.skip_clear_bodies = false});
  const auto cuda = make_cuda_detector(scene.surfaces, {});
  for (int step = 0; step < 2; ++step) {
    cpu->begin_step();
    cuda->begin_step();
    EXPECT_EQ(cuda->detect(scene.motion), cpu->detect(scene.motion));
    EXPECT_EQ(cuda->detect_hits(scene.motion), cpu->detect_hits(scene.motion));
    EXPECT_EQ(cuda->check(scene.motion), cpu->check(scene.motion));
    expect_equal(cuda->counts(), cpu->counts());
    expect_same_touches(scene, *cpu, *cuda);
    expect_equal(cuda->counts(), cpu->counts());
    std::vector<std::uint8_t> is_still(static_cast<std::size_t>(scene.body_count()));
    for (std::size_t b = 0; b < is_still.size(); b += 2) is_still[b] = 1;
    for (Detector* const detector : {cpu.get(), cuda.get()}) {
      detector->set_still(std::span(is_still).first(step == 0 ? is_still.size() : 0));
    }
  }
  const ClosestPair a = cpu->closest(scene.motion.start, 0.1);
  const ClosestPair b = cuda->closest(scene.motion.start, 0.1);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.a, b.a);
  EXPECT_EQ(a.b, b.b);
  EXPECT_EQ(a.distance, b.distance);
}

TEST(DetectorEmulated, MixedScenesHaveThePairsOfTheCpu) {
  expect_parity(mixed_scene(41, 0.05));
  expect_parity(mixed_scene(42, 0.5));
}

TEST(DetectorEmulated, APileHasThePairsOfTheCpu) {
  expect_parity(pile_scene(6, 1500, {.touches_itself = true}));
}

/// Bodies of more than 32^2 vertices, whose boxes are united in three stages.
TEST(DetectorEmulated, LargeBodiesHaveThePairsOfTheCpu) {
  expect_parity(pile_scene(3, 9000));
}

TEST(DetectorEmulated, EmptyScenesHaveNoPairs) {
  CollideScene scene;
  scene.surfaces.thickness = 1e-3;
  expect_parity(scene);
  scene.add_plane({{0, 0, 0}, {0, 0, 1}});
  expect_parity(scene);
}

/// Results must not depend on the order of threads.
TEST(DetectorEmulated, EveryOrderOfThreadsGivesTheSamePairsAndTouches) {
  const CollideScene scene = mixed_scene(43, 0.05);
  const auto expected = make_cpu_detector(scene.surfaces, {})->detect(scene.motion);

  simt::for_each_schedule([&](const simt::Schedule&) {
    const auto cpu = make_cpu_detector(scene.surfaces, {});
    const auto cuda = make_cuda_detector(scene.surfaces, {});
    EXPECT_EQ(cuda->detect(scene.motion), expected);
    expect_same_touches(scene, *cpu, *cuda);
  });
}

TEST(DetectorEmulated, LaterStepsAllocateNothingOnTheDevice) {
  const CollideScene scene = mixed_scene(44, 0.05);
  CollideScene moved = scene;
  std::mt19937 random(4);
  for (std::int32_t b = 0; b < scene.body_count(); ++b) moved.shake_body(b, 0.02, random);
  const auto cuda = make_cuda_detector(scene.surfaces, {});
  const auto step = [&] {
    cuda->begin_step();
    cuda->find_touches(scene.motion);
    cuda->touches();
    cuda->find_touches(moved.motion);
    cuda->touches();
    cuda->check(scene.motion);
  };
  for (int k = 0; k < 2; ++k) step();
  take_calls();

  step();

  EXPECT_EQ(take_calls().count(DeviceCall::allocate), 0);
}
}  // namespace
}  // namespace tetwarp::test
