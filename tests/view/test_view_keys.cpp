/// @file test_view_keys.cpp
/// What keys, wheel and texts of a window do, without the window.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "host/base/point3.hpp"
#include "host/view/camera_keys.hpp"
#include "host/view/look/slice_look.hpp"
#include "host/view/overlay_text.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

const Camera start{{1, 2, 3}, {0.5, -1, 0.25}, {0, 0, 1}, 0.7};

Camera pressed(const Camera& from, const std::string& name, bool has_shift = false) {
  return camera_after({name, has_shift}, from, start).value();
}

double distance_of(const Camera& camera) {
  return norm(minus(camera.eye, camera.target));
}

void expect_near(const Camera& a, const Camera& b) {
  EXPECT_LT(norm(minus(a.eye, b.eye)), 1e-12);
  EXPECT_LT(norm(minus(a.target, b.target)), 1e-12);
  EXPECT_LT(norm(minus(a.up, b.up)), 1e-12);
  EXPECT_EQ(a.angle, b.angle);
}

TEST(CameraKeys, UndoEachOther) {
  const std::vector<std::vector<std::string>> pairs{{"Left", "Right"}, {"Up", "Down"}};
  for (const auto& pair : pairs) {
    for (const bool has_shift : {false, true}) {
      const Camera there = pressed(start, pair[0], has_shift);
      EXPECT_GT(norm(minus(there.eye, start.eye)), 0.1);
      EXPECT_NEAR(distance_of(there), distance_of(start), 1e-12);
      EXPECT_EQ(norm(minus(there.target, start.target)) > 0.1, has_shift);
      expect_near(pressed(there, pair[1], has_shift), start);
    }
  }
  const Camera near = pressed(start, "plus");
  EXPECT_NEAR(distance_of(near), distance_of(start) / 1.1, 1e-12);
  expect_near(pressed(near, "minus"), start);
  expect_near(pressed(pressed(near, "KP_Add"), "KP_Subtract"), near);
  Camera turned = start;
  for (int n = 0; n < 72; ++n) turned = pressed(turned, "Right");
  EXPECT_LT(norm(minus(turned.eye, start.eye)), 1e-9);
}

/// What faces the camera goes where the arrow points.
TEST(CameraKeys, ArrowsMoveTheSceneAsTheyPoint) {
  const Camera front{{0, -2, 0}, {0, 0, 0}, {0, 0, 1}, 0.5};
  EXPECT_LT(pressed(front, "Right").eye[0], 0);
  EXPECT_GT(pressed(front, "Left").eye[0], 0);
  EXPECT_LT(pressed(front, "Up").eye[2], 0);
  EXPECT_GT(pressed(front, "Down").eye[2], 0);
  EXPECT_LT(pressed(front, "Right", true).target[0], 0);
  EXPECT_LT(pressed(front, "Up", true).target[2], 0);
}

TEST(CameraKeys, KeypadLooksAlongTheAxes) {
  struct Expected {
    const char *locked, *plain;
    Point3 back;
  };
  for (const Expected& of :
       {Expected{"KP_1", "KP_End", {0, 1, 0}}, Expected{"KP_3", "KP_Next", {-1, 0, 0}},
        Expected{"KP_7", "KP_Home", {0, 0, 1}}}) {
    for (const bool has_shift : {false, true}) {
      const Point3 back = times(has_shift ? -1 : 1, of.back);
      const Camera seen = pressed(start, of.plain, has_shift);
      EXPECT_EQ(seen.target, start.target);
      EXPECT_NEAR(dot(minus(seen.eye, seen.target), back), distance_of(start), 1e-12);
      EXPECT_EQ(dot(seen.up, back), 0);
      expect_near(pressed(start, of.locked, has_shift), seen);
      for (const char* turn : {"Left", "Up"}) {  // the nearest is where it came from
        expect_near(pressed(pressed(seen, turn), "KP_0"), seen);
        expect_near(pressed(pressed(seen, turn), "KP_Insert"), seen);
      }
    }
  }
}

TEST(CameraKeys, ResetTheViewAndLeaveOtherKeys) {
  expect_near(pressed(pressed(pressed(start, "KP_1"), "plus"), "r"), start);
  for (const char* other : {"space", "BackSpace", "q", "R", "1", "Escape"}) {
    EXPECT_FALSE(camera_after({other}, start, start)) << other;
  }
  EXPECT_FALSE(camera_after({"r", false, true}, start, start));
}

const Grid box{.dims = {11, 21, 5}, .origin = {-1, 2, 0}, .spacing = {0.2, 0.1, 0.5}};

TEST(SliceLook, ShowsAllThenEachAlone) {
  SliceLook slices;
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_FALSE(slices.alone);
    for (std::size_t alone = 0; alone < 3; ++alone) {
      choose_next(slices);
      for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(slices.shows(axis), axis == alone);
    }
    choose_next(slices);
  }
}

TEST(SliceLook, GoesFromEndToEnd) {
  SliceLook slices;
  EXPECT_EQ(slice_number(box, 1, slices.places[1]), 10);
  move_slice(slices, 1, 7);
  EXPECT_EQ(slice_number(box, 1, slices.places[1]), 13);
  move_slice(slices, 1, -7);
  EXPECT_EQ(slice_number(box, 1, slices.places[1]), 10);
  move_slice(slices, 1, 500);
  EXPECT_EQ(slice_number(box, 1, slices.places[1]), 20);
  move_slice(slices, 1, -500);
  EXPECT_EQ(slice_number(box, 1, slices.places[1]), 0);
  EXPECT_EQ(slices.places[0], 0.5);
}

/// A ray to a point of a shown slice meets that slice there, or another one before it.
TEST(SliceLook, IsMetWhereItIsSeen) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1), away(-4, 4);
  const auto inside = [&](std::size_t d) {
    return box.origin[d] + box.spacing[d] * share(random) * static_cast<double>(box.dims[d] - 1);
  };
  int first = 0;
  for (int n = 0; n < 600; ++n) {
    SliceLook slices{{share(random), share(random), share(random)}};
    const auto axis = static_cast<std::size_t>(n % 3);
    if (n % 2 == 0) slices.alone = axis;
    Point3 x{inside(0), inside(1), inside(2)};
    x[axis] = box.origin[axis] +
              box.spacing[axis] * static_cast<double>(slice_number(box, axis, slices.places[axis]));
    const Point3 eye{away(random), away(random), away(random)};
    const auto met = slice_at(box, slices, eye, times(0.5, minus(x, eye)));
    ASSERT_TRUE(met);
    EXPECT_LE(met->distance, 2 + 1e-12);
    const bool is_first = met->axis == axis;
    EXPECT_TRUE(is_first || !slices.alone);
    EXPECT_TRUE(!is_first || std::abs(met->distance - 2) < 1e-9);
    first += is_first ? 1 : 0;
    EXPECT_FALSE(slice_at(box, slices, eye, {0, 0, 0}));
    const Point3 beyond{9, 9, 9};
    EXPECT_FALSE(slice_at(box, slices, beyond, minus(beyond, x))) << "behind the eye";
  }
  EXPECT_GT(first, 400);
}

ViewScene named_scene() {
  ViewScene scene;
  scene.bodies = {"block", "ball"};
  scene.volumes = {{1, -1000, 2000}};
  scene.max_step_seconds = std::numeric_limits<double>::infinity();
  return scene;
}

LiveFrame some_frame() {
  LiveFrame frame;
  frame.step = 12;
  frame.tick = 20;
  frame.time = 0.1204;
  frame.steps_per_second = 48;
  frame.contacts.resize(3);
  frame.late_steps = 5;
  return frame;
}

TEST(OverlayText, SaysWhatThereIs) {
  ViewScene scene = named_scene();
  LiveFrame frame = some_frame();
  const std::string counts = "\n48 steps/s   15 frames/s   3 contacts";
  EXPECT_EQ(overlay_text(scene, frame, 15), "step 12   0.120 s" + counts);
  frame.is_paused = true;
  frame.is_converged = false;
  EXPECT_EQ(overlay_text(scene, frame, 15),
            "step 12   0.120 s   paused" + counts + "\nabove its tolerance");
  scene.max_step_seconds = 0.02;
  frame.is_paused = false;
  frame.grab = GrabView{{}, {}, {3, 0, -4}};
  frame.message = "there is no body";
  EXPECT_EQ(overlay_text(scene, frame, 15),
            "step 12   0.120 s" + counts +
                "\nbudget 20 ms, over in 5 of 20 steps\nforce 5 N\nthere is no body");
}

/// The value is that of the voxel below the surface, not of the air before it.
TEST(ProbeText, ReadsTheVolumeBelowTheSurface) {
  const ViewScene scene = named_scene();
  LiveFrame frame = some_frame();
  VolumeFrame volume;
  volume.grid = {.dims = {2, 2, 4}, .origin = {0, 0, 0}, .spacing = {0.1, 0.1, 0.1}};
  for (int v = 0; v < 16; ++v) {
    volume.samples.push_back(static_cast<std::int16_t>(v < 8 ? 0 : largest_sample));
  }
  frame.volumes = {volume};
  const Point3 down{0, 0, -7};
  EXPECT_EQ(probe_text(scene, frame, {1, {0.1, 0, 0.3}}, down), "ball at 0.1, 0, 0.3 m: 2000");
  EXPECT_EQ(probe_text(scene, frame, {1, {0.1, 0, 0.1}}, down), "ball at 0.1, 0, 0.1 m: -1000");
  EXPECT_EQ(probe_text(scene, frame, {1, {0.1, 0, 0}}, down), "ball at 0.1, 0, 0 m") << "outside";
  EXPECT_EQ(probe_text(scene, frame, {0, {0.1, 0, 0.3}}, down), "block at 0.1, 0, 0.3 m");
}

}  // namespace
}  // namespace tetwarp::test
