/// @file test_view_parts.cpp
/// Live windows without a window: hand-over between threads, input, picking, colors and rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>
#include <thread>
#include <variant>
#include <vector>

#include "host/base/point3.hpp"
#include "host/view/input_log.hpp"
#include "host/view/live_volumes.hpp"
#include "host/view/look/scene_look.hpp"
#include "host/view/pick.hpp"
#include "host/view/ray_quality.hpp"
#include "host/view/triple_buffer.hpp"
#include "host/view/view_options.hpp"
#include "host/view/volume_colors.hpp"
#include "tests/support/run_command.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

TEST(TripleBuffer, GivesTheNewestValueOnce) {
  TripleBuffer<int> buffer;
  EXPECT_FALSE(buffer.take());
  for (const int value : {1, 2, 3}) {
    buffer.back() = value;
    buffer.publish();
  }
  EXPECT_TRUE(buffer.is_waiting());
  EXPECT_TRUE(buffer.take());
  EXPECT_EQ(buffer.front(), 3);
  EXPECT_FALSE(buffer.take());
  EXPECT_EQ(buffer.front(), 3);
}

/// Both threads go on all the time: values that the reader sees are whole and never older.
TEST(TripleBuffer, NeverGivesAValueThatIsBeingWritten) {
  constexpr std::int64_t last = 20000;
  TripleBuffer<std::vector<std::int64_t>> buffer;
  std::thread writer([&] {
    for (std::int64_t value = 1; value <= last; ++value) {
      buffer.back().assign(16, value);
      buffer.publish();
    }
  });
  std::int64_t before = 0;
  while (before < last) {
    if (!buffer.take()) continue;
    const std::vector<std::int64_t>& values = buffer.front();
    EXPECT_EQ(values, std::vector<std::int64_t>(16, values[0]));
    EXPECT_GT(values[0], before);
    before = values[0];
  }
  writer.join();
}

TEST(ViewOptions, AreTheSameAfterTheirWords) {
  ViewOptions options;
  EXPECT_TRUE(words_of(options).empty());
  options.scene_file = "a=b c.json";
  options.threads = 3;
  options.max_step_seconds = 0.1;
  options.paused = true;
  options.steps = 0;
  options.fingers = {{1, 2, 3, 4, 5, 6, 0.5}};
  options.camera = {{0.1, -2, 1e-30, 4, 5, 1.0 / 3}};
  options.camera_name = "inside";
  options.grab_radius = 0.7;
  options.record = "input.txt";
  options.join = "tcp://master:5611";
  options.ends_with_master = true;
  EXPECT_EQ(options_of(words_of(options)), options);
  for (const std::string word : {"thread=3", "threads", "threads=x", "paused=2", "camera=1,2"}) {
    EXPECT_THROW(options_of({word}), std::invalid_argument) << word;
  }
}

InputLog some_input() {
  InputLog log;
  log.scene = "a scene.json";
  log.start = 0xfedcba9876543210;
  log.events = {{.tick = 3,
                 .kind = InputKind::grab,
                 .handle = {.body = "head",
                            .center = {0.1, -1e-17, 1.0 / 3},
                            .radius = 0.01,
                            .stiffness = 1e300,
                            .damping = 0.7}},
                {.tick = 3, .kind = InputKind::move, .displacement = {0.2, 0, -1}},
                {.tick = 9, .kind = InputKind::release},
                {.tick = 12, .kind = InputKind::restart},
                {.tick = 13,
                 .kind = InputKind::carry,
                 .handle = {.body = "ball"},
                 .displacement = {0.25, 1e-9, 0}},
                {.tick = 13, .kind = InputKind::limit, .limit = {12, -1}}};
  log.ticks = 20;
  return log;
}

TEST(InputLog, KeepsAllBits) {
  const TemporaryFolder folder;
  const std::string path = folder / "input.txt";
  std::ofstream(path) << text_of(some_input());
  const InputLog log = read_input_log(path);
  EXPECT_EQ(log.scene, "a scene.json");
  EXPECT_EQ(log.start, some_input().start);
  EXPECT_EQ(log.events, some_input().events);
  EXPECT_EQ(log.ticks, 20);
}

TEST(InputLog, NamesTheLineThatIsWrong) {
  const TemporaryFolder folder;
  const std::string path = folder / "input.txt";
  const auto refuses = [&](const std::string& text, const std::string& expected) {
    std::ofstream(path) << text;
    try {
      read_input_log(path);
      ADD_FAILURE() << text;
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  };
  const std::string names = "tetwarp input 2\nchain\n", head = names + "start 17\n";
  refuses("", "is not a file that tetwarp view --record wrote");
  refuses(head, "is incomplete");
  refuses(names + "0 release\n", "line 3 is not start and a number");
  refuses(names + "start -1\n", "line 3 '-1' is not a number");
  refuses(head + "0 push\n", "line 4 'push' is not grab");
  refuses(head + "0 move 1 2\n", "line 4 ends too early");
  refuses(head + "4 release\n3 release\n", "line 5 its step is before");
  refuses(head + "0 move 1 2 nan\n", "'nan' is not a number");
  refuses(head + "0 release 1\n", "one word too many");
}

TEST(Pick, FindsTheNearestTriangleFromEitherSide) {
  const std::vector<std::vector<Point3>> points{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                                {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
  const std::vector<Triangles> triangles{{{0, 1, 2}}, {{0, 1, 2}}};
  const auto from_above = pick(points, triangles, {0.2, 0.3, 5}, {0, 0, -2});
  ASSERT_TRUE(from_above);
  EXPECT_EQ(from_above->body, 1u);
  EXPECT_EQ(from_above->point, (Point3{0.2, 0.3, 1}));
  EXPECT_EQ(from_above->distance, 2);
  const auto from_below = pick(points, triangles, {0.2, 0.3, -5}, {0, 0, 1});
  ASSERT_TRUE(from_below);
  EXPECT_EQ(from_below->body, 0u);
  EXPECT_FALSE(pick(points, triangles, {0.8, 0.8, 5}, {0, 0, -1}));
  EXPECT_FALSE(pick(points, triangles, {0.2, 0.3, 5}, {0, 0, 1}));  // behind
  EXPECT_FALSE(pick(points, triangles, {0.2, 0.3, 5}, {1, 0, 0}));  // along the triangles
}

TEST(Pick, SkipsWhatIsCutAway) {
  const std::vector<std::vector<Point3>> points{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                                {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
  const std::vector<Triangles> triangles{{{0, 1, 2}}, {{0, 1, 2}}};
  const auto body_below = [&](double height) {
    const auto found = pick(points, triangles, {0.2, 0.3, 5}, {0, 0, -2}, Cut{{0, 0, height}});
    return found ? static_cast<int>(found->body) : -1;
  };
  EXPECT_EQ(body_below(1.5), 1);
  EXPECT_EQ(body_below(0.5), 0);
  EXPECT_EQ(body_below(-0.5), -1);
}

TEST(ValueAt, IsThatOfTheNearestVoxel) {
  VolumeFrame frame;
  frame.grid = {.dims = {3, 4, 2}, .origin = {1, 2, 3}, .spacing = {0.5, 0.5, 0.5}};
  for (int v = 0; v < 24; ++v) frame.samples.push_back(static_cast<std::int16_t>(1000 * v));
  const VolumeBody range{0, -1000, 2000};
  for (std::int64_t k = 0; k < 2; ++k) {
    for (std::int64_t j = 0; j < 4; ++j) {
      for (std::int64_t i = 0; i < 3; ++i) {
        const Point3 center = frame.grid.world_of(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const double sample = 1000.0 * static_cast<double>(i + 3 * (j + 4 * k));
        const auto value = value_at(frame, range, plus(center, {0.2, -0.2, 0.1}));
        ASSERT_TRUE(value);
        EXPECT_NEAR(*value, -1000 + 3000 * sample / largest_sample, 1e-9);
      }
    }
  }
  EXPECT_FALSE(value_at(frame, range, {0.7, 2, 3}));
  EXPECT_FALSE(value_at(frame, range, {1, 2, 3.8}));
}

TEST(GridAround, HoldsThePointsAndTheLimit) {
  const std::vector<Point3> points{{-1, 0, 2}, {3, 0.5, 2.25}};
  for (const std::int64_t most : {100'000, 1'000'000}) {
    const Grid grid = grid_around(points, 1e-3, most);
    EXPECT_LT(static_cast<double>(grid.voxel_count()), 1.3 * static_cast<double>(most));
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_LT(grid.origin[d], points[0][d]);
      EXPECT_GT(grid.origin[d] + grid.spacing[d] * static_cast<double>(grid.dims[d] - 1),
                points[1][d]);
    }
  }
  EXPECT_EQ(grid_around(points, 0.5, 1000000).spacing, (Point3{0.5, 0.5, 0.5}));
  EXPECT_GE(grid_around({{1, 1, 1}}, 0.1, 1000).voxel_count(), 1);  // of one point
}

TEST(SceneLook, CameraIsUprightUnlessItLooksDown) {
  EXPECT_EQ(camera_at({0, -1, 1, 0, 0, 0}).up, (Point3{0, 0, 1}));
  EXPECT_EQ(camera_at({0, 0, 5, 0, 0, 1}).up, (Point3{0, 1, 0}));
  EXPECT_EQ(camera_at({1, 2, 3, 4, 5, 6}).eye, (Point3{1, 2, 3}));
  EXPECT_EQ(camera_at({1, 2, 3, 4, 5, 6}).target, (Point3{4, 5, 6}));
}

TEST(VolumeColors, FollowHounsfieldUnitsAndTheWindow) {
  VolumeColors tomography("ct", -1000, 1000);
  const auto value = [](double sample) { return -1000 + 2000 * sample / largest_sample; };
  EXPECT_NEAR(value(tomography.points().front().value), -1000, 1e-9);
  EXPECT_NEAR(value(tomography.points().back().value), 1000, 1e-9);
  EXPECT_EQ(tomography.points().front().opacity, 0);
  tomography.set_window(0.25, 0.5);
  EXPECT_NEAR(value(tomography.gray()[0]), 0, 1e-9);
  EXPECT_NEAR(value(tomography.gray()[1]), 1000, 1e-9);
  const VolumeColors other("mr", 0, 1);
  EXPECT_EQ(other.gray()[1], largest_sample);
}

/// Cost of a picture by its rays, in units of the finest one.
double cost_of(const RaySpacing& rays) {
  return 1 / (rays.step * rays.pixels * rays.pixels);
}

/// For any machine the quality settles where pictures are in time, or at the coarsest, and is not
/// coarser than needed by more than two levels.
TEST(RayQuality, SettlesWhereThePictureIsInTime) {
  for (const bool is_software : {false, true}) {
    for (double finest = 0.001; finest < 20; finest *= 1.3) {
      RayQuality quality(is_software);
      for (int n = 0; n < 100; ++n) quality.drew(finest * cost_of(quality.moving()));
      const RaySpacing settled = quality.moving();
      for (int n = 0; n < 20; ++n) {
        quality.drew(finest * cost_of(quality.moving()));
        EXPECT_EQ(quality.moving(), settled) << finest;
      }
      const double seconds = finest * cost_of(settled);
      EXPECT_TRUE(seconds <= 1.0 / 15 || settled == (RaySpacing{6, 6})) << finest;
      EXPECT_TRUE(seconds >= 0.2 / 15 || settled == RaySpacing{}) << finest;
      EXPECT_LE(quality.resting().pixels, settled.pixels);
    }
  }
}

/// Rays are given up after five pictures in a row of more than a second, and not again because of
/// the same ones.
TEST(RayQuality, GivesUpWhereEvenTheCoarsestTakesLong) {
  RayQuality quality;
  const auto draw = [&](int count, double seconds) {
    for (int n = 0; n < count; ++n) quality.drew(seconds);
    return quality.gives_up();
  };
  EXPECT_FALSE(draw(50, 0.99));
  EXPECT_FALSE(draw(4, 1.01));
  EXPECT_FALSE(draw(1, 0.5));
  EXPECT_FALSE(draw(4, 20));
  EXPECT_TRUE(draw(1, 1.01));
  quality.try_again();
  EXPECT_FALSE(draw(4, 3));
  EXPECT_TRUE(draw(1, 3));
}

}  // namespace
}  // namespace tetwarp::test
