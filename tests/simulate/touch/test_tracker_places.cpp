/// @file test_tracker_places.cpp
/// The tracker with deformable bodies: anchors on vertices and triangles, steps that begin again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/simulate/pair_scene.hpp"

namespace tetwarp::test {
namespace {
constexpr double step_time = 0.01;
constexpr double glue_area = 1e-4;
constexpr double glue_stiffness = 1e6;

ContactTrackerOptions glue(double intensity = 1) {
  ContactTrackerOptions options;
  options.materials = {
      {.friction = 0.5, .stiffness = glue_stiffness, .initial_intensity = intensity}};
  options.touch_distance = 1e-6;
  return options;
}

/// A triangle, body 0, and a small one above it, body 1, both deformable, or a rigid body 1.
struct Sheets {
  std::vector<Point3> below = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<Point3> above = {{0.3, 0.3, h}, {0.4, 0.3, 1}, {0.3, 0.4, 1}};
  bool is_rigid = false;
  BodyPose pose;  ///< of a rigid body 1, whose point is at {0.3, 0.3, h} at first

  std::vector<BodyPlace> places() const {
    std::vector<BodyPlace> result(2);
    result[0].vertices = below;
    if (is_rigid) {
      result[1].pose = pose;
    } else {
      result[1].vertices = above;
    }
    return result;
  }
  /// Vertex 0 of body 1 on body 0: what contacts of pairs are, the thickness on side b.
  ReportedContact report(std::int32_t vertex_key = 0) const {
    ReportedContact contact;
    contact.key = {1, vertex_key, 0, -1};
    contact.point_a_world = is_rigid ? plus(pose.position, {0.3, 0.3, h}) : above[0];
    if (!is_rigid) contact.material_a = {{0, 0, 0}, {0, -1, -1}, {1, 0, 0}};
    contact.point_b_world = {contact.point_a_world[0], contact.point_a_world[1], below[0][2] + h};
    const double u = contact.point_a_world[0], w = contact.point_a_world[1];
    contact.material_b = {{0, 0, 0}, {0, 1, 2}, {1 - u - w, u, w}};
    contact.area = glue_area;
    return contact;
  }
};

ContactSolution solution_of(std::vector<double> impulse) {
  ContactSolution solution;
  solution.velocity.assign(impulse.size(), 0);
  solution.impulse = std::move(impulse);
  return solution;
}

void finish(ContactTracker& tracker, std::size_t count, const std::vector<BodyPlace>& places) {
  tracker.end_step(solution_of(std::vector<double>(3 * count)), places);
}

/// A bond between a face and a vertex, or a point of a rigid body, is pulled along and across the
/// normal, while both bodies move and the face turns: the gap follows the material.
TEST(TrackerPlaces, ABondFollowsTheMaterial) {
  for (const bool is_rigid : {false, true}) {
    Sheets sheets;
    sheets.is_rigid = is_rigid;
    ContactTracker tracker(glue());
    tracker.begin_step(std::vector{sheets.report()}, sheets.places(), step_time);
    finish(tracker, 1, sheets.places());
    ASSERT_EQ(tracker.records()[0].intensity, 1);
    EXPECT_NEAR(tracker.records()[0].standoff, h, 1e-18);

    // Everything moves and turns by 90 degrees about x; then body 1 is pulled off by (2, 3, 5) mm
    // along the triangle's axes.
    const auto turn = [](const Point3& x) { return Point3{x[0] + 7, -x[2] + 2, x[1] - 3}; };
    for (Point3& x : sheets.below) x = turn(x);
    for (Point3& x : sheets.above) x = turn(plus(x, {2e-3, 3e-3, 5e-3}));
    const double c = std::sqrt(0.5);
    sheets.pose.rotation = {c, c, 0, 0};
    sheets.pose.position = turn({2e-3, 3e-3, 5e-3});
    const TrackedContact contact = tracker.begin_step({}, sheets.places(), step_time).front();

    EXPECT_FALSE(contact.is_reported);
    EXPECT_NEAR(contact.gap[0], 5e-3, 1e-15);
    EXPECT_NEAR(std::hypot(contact.gap[1], contact.gap[2]), std::hypot(2e-3, 3e-3), 1e-15);
    EXPECT_NEAR(contact.axes[0][1], 1, 1e-15);  // in key order from body 1 to 0: turned twice
    EXPECT_EQ(contact.material_a.vertex[2], 2);
    EXPECT_EQ(contact.material_b.is_rigid(), is_rigid);
    finish(tracker, 1, sheets.places());
    EXPECT_EQ(tracker.records().size(), 1U);
  }
}

/// Hang test: at rest the spring of the bond carries the load with the gap m g / (A C beta^2).
TEST(TrackerPlaces, AHangingVertexHasTheGapOfItsWeight) {
  const double mass = 2e-3, gravity = 9.81;
  Sheets sheets;
  ContactTracker tracker(glue());
  tracker.begin_step(std::vector{sheets.report()}, sheets.places(), step_time);
  finish(tracker, 1, sheets.places());
  for (Point3& x : sheets.above) x[2] += mass * gravity / (glue_area * glue_stiffness);
  const auto& contacts = tracker.begin_step({}, sheets.places(), step_time);
  ContactProblem problem;
  tracker.fill(problem);

  const double spring =
      problem.adhesion.area[0] * problem.adhesion.stiffness[0] * problem.adhesion.gap[0];

  EXPECT_NEAR(spring, mass * gravity, 1e-12 * mass * gravity + 1e-16);
  EXPECT_EQ(contacts[0].gap[0], problem.adhesion.gap[0]);
}

/// Wall test: a vertex that has slid keeps its tangential gap step after step, whatever contact
/// point detection reports and whatever triangle it is in: no creep.
TEST(TrackerPlaces, ATangentialGapDoesNotCreep) {
  Sheets sheets;
  ContactTracker tracker(glue());
  tracker.begin_step(std::vector{sheets.report()}, sheets.places(), step_time);
  finish(tracker, 1, sheets.places());
  const double slip = 1e-3;
  sheets.above[0][0] += slip;

  for (int n = 0; n < 1000; ++n) {
    const auto& contacts =
        tracker.begin_step(std::vector{sheets.report()}, sheets.places(), step_time);
    ASSERT_EQ(contacts.size(), 1U);
    ASSERT_NEAR(std::hypot(contacts[0].gap[1], contacts[0].gap[2]), slip, 1e-16) << n;
    ASSERT_NEAR(contacts[0].gap[0], 0, 1e-18);
    finish(tracker, 1, sheets.places());
  }
}

/// Bonding from 1/2 towards 1 in a sheared contact leaves C beta^2 g as it was, with the anchor
/// moved on the triangle, whichever side it is on.
TEST(TrackerPlaces, BondsThatFormUnderShearKeepTheForce) {
  for (const bool is_rigid : {false, true}) {
    ContactTrackerOptions options = glue(0.5);
    options.materials[0].bonding_rate = 1e-2;
    Sheets sheets;
    sheets.is_rigid = is_rigid;
    // A face that is inclined to the contact's normal.
    sheets.below[1][2] = sheets.below[0][2] + 0.2;
    ContactTracker tracker(options);
    tracker.begin_step(std::vector{sheets.report()}, sheets.places(), step_time);
    finish(tracker, 1, sheets.places());
    ASSERT_EQ(tracker.records()[0].intensity, 0.5);
    sheets.above[0] = plus(sheets.above[0], {1e-4, 2e-4, 0});
    sheets.pose.position = {1e-4, 2e-4, 0};
    const Point3 before =
        tracker.begin_step(std::vector{sheets.report()}, sheets.places(), step_time).front().gap;
    ASSERT_NEAR(std::hypot(before[1], before[2]), std::hypot(1e-4, 2e-4), 1e-16);
    tracker.end_step(solution_of({1e-2 * glue_area * 1e4, 0, 0}), sheets.places());

    ASSERT_NEAR(tracker.records()[0].intensity, 1, 1e-12);
    const Point3 after = tracker.begin_step({}, sheets.places(), step_time).front().gap;
    EXPECT_NEAR(std::hypot(after[1], after[2]), std::hypot(before[1], before[2]) / 4, 1e-16);
    EXPECT_NEAR(after[0], before[0], 1e-16);
  }
}

/// A pass with more contacts starts from the records that the step began with.
TEST(TrackerPlaces, AStepThatBeginsAgainStartsAnew) {
  Sheets sheets;
  const std::vector<BodyPlace> places = sheets.places();
  ReportedContact second = sheets.report(1);
  second.material_a.vertex[0] = 1;
  second.point_a_world = sheets.above[1];
  second.point_b_world = {0.4, 0.3, h};
  ReportedContact touching = sheets.report(), off = sheets.report();
  off.point_a_world[2] += 1e-3;  // a first pass that sees the contact elsewhere
  ContactTracker once(glue()), twice(glue());

  for (int n = 0; n < 3; ++n) {
    const std::vector<ReportedContact> first = {touching}, all = {touching, second};
    twice.begin_step(n == 0 ? std::vector{touching} : first, places, step_time);
    EXPECT_EQ(twice.start_records().size(), n == 0 ? 0U : 2U);
    twice.begin_step(std::vector{off}, places, step_time);
    const auto& contacts = twice.begin_step(all, places, step_time);
    const auto& expected = once.begin_step(all, places, step_time);
    ASSERT_EQ(contacts.size(), expected.size());
    for (std::size_t c = 0; c < contacts.size(); ++c) EXPECT_EQ(contacts[c].gap, expected[c].gap);
    const ContactSolution solution = solution_of({1e-3, 1e-4, 0, 0, 0, 0});
    twice.end_step(solution, places);
    once.end_step(solution, places);
    ASSERT_EQ(twice.records().size(), once.records().size());
    for (std::size_t k = 0; k < once.records().size(); ++k) {
      EXPECT_EQ(twice.records()[k].intensity, once.records()[k].intensity);
      EXPECT_EQ(twice.records()[k].impulse_world, once.records()[k].impulse_world);
      EXPECT_EQ(twice.records()[k].material_b.weight, once.records()[k].material_b.weight);
    }
  }
}

/// A copy taken within a run goes on as the tracker does: for steps that are done again.
TEST(TrackerPlaces, ACopyGoesOnAsTheOriginal) {
  Sheets sheets;
  ContactTracker tracker(glue(0.7));
  tracker.begin_step(std::vector{sheets.report()}, sheets.places(), step_time);
  finish(tracker, 1, sheets.places());
  const ContactTracker snapshot = tracker;
  for (const double way : {1e-4, -2e-4}) {  // a step that is given up
    sheets.above[0][0] += way;
    tracker.begin_step(std::vector{sheets.report()}, sheets.places(), step_time);
    tracker.end_step(solution_of({1, 2, 3}), sheets.places());
  }
  tracker = snapshot;
  ContactTracker copy = snapshot;
  sheets.above[0][1] += 1e-4;

  for (ContactTracker* each : {&tracker, &copy}) {
    each->begin_step(std::vector{sheets.report()}, sheets.places(), step_time);
    each->end_step(solution_of({1e-3, 0, 0}), sheets.places());
  }

  EXPECT_EQ(tracker.records()[0].material_b.weight, copy.records()[0].material_b.weight);
  EXPECT_EQ(tracker.records()[0].intensity, copy.records()[0].intensity);
}

/// A vertex that slides over the edges of a mesh keeps its record, anchors and beta.
TEST(TrackerPlaces, SlidingOverEdgesKeepsTheBond) {
  ContactTrackerOptions options = glue(0.8);
  options.touch_distance = h;
  ContactTracker tracker(options);
  for (int n = 0; n < 40; ++n) {
    PairScene scene;
    const Square ground = square(7, 0, true);
    scene.add_mesh(ground.vertices, ground.triangles, {.is_rigid = false, .has_unknowns = false});
    const Point3 tip{0.2 + 0.013 * n, 0.3 + 0.007 * n, 1.2 * h};
    scene.add_mesh({tip, plus(tip, {0.02, 0, 1}), plus(tip, {0, 0.1, 1})}, {{0, 1, 2}},
                   {.is_rigid = false});

    const auto& reports = scene.contacts(tracker.records());
    const auto& contacts = tracker.begin_step(reports, scene.places(), step_time);
    const auto bonded = [&](const ContactRecord& record) { return record.intensity > 0; };
    const auto& records = tracker.records();
    ASSERT_EQ(std::count_if(records.begin(), records.end(), bonded), 1) << n;
    const auto tip_contact = std::find_if(records.begin(), records.end(), bonded) - records.begin();
    EXPECT_NEAR(std::hypot(contacts[static_cast<std::size_t>(tip_contact)].gap[1],
                           contacts[static_cast<std::size_t>(tip_contact)].gap[2]),
                n * std::hypot(0.013, 0.007), 1e-13);
    finish(tracker, contacts.size(), scene.places());
  }
}

TEST(TrackerPlaces, RefusesPointsThatAreNotOnTheBody) {
  const Sheets sheets;
  const std::vector<BodyPlace> places = sheets.places();
  const auto refused = [&](const ReportedContact& report) {
    ContactTracker tracker(glue());
    try {
      tracker.begin_step(std::vector{report}, places, step_time);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what()).find("needs a material point") != std::string::npos;
    }
    return false;
  };
  ReportedContact none = sheets.report(), outside = none, heavy = none, gap = none;
  none.material_b = {};
  outside.material_b.vertex[1] = 3;
  heavy.material_b.weight[0] += 0.1;
  gap.material_b.vertex = {0, -1, 2};

  for (const ReportedContact& report : {none, outside, heavy, gap}) EXPECT_TRUE(refused(report));
  EXPECT_FALSE(refused(sheets.report()));
  ReportedContact itself = sheets.report();
  itself.key = {1, 0, 1, -1};
  itself.material_b = {{0, 0, 0}, {1, 2, -1}, {0.5, 0.5, 0}};
  EXPECT_FALSE(refused(itself));  // a deformable body may touch itself
  EXPECT_NO_THROW(ContactTracker(glue()).begin_step(std::vector{itself}, places, step_time));
}
}  // namespace
}  // namespace tetwarp::test
