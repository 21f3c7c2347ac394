/// @file test_contact_tracker.cpp
/// The tracker's records: matched by key, by position, and kept as long as a contact adheres.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tetwarp/contact_tracker.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/support/tracker_reports.hpp"

namespace tetwarp::test {
namespace {
BodyPose moved(double x, double y, double z) {
  return {{x, y, z}, {1, 0, 0, 0}};
}

ContactSolution impulses(const std::vector<double>& impulse) {
  ContactSolution solution;
  solution.impulse = impulse;
  solution.velocity.assign(impulse.size(), 0);
  return solution;
}

TEST(ContactTracker, TouchingGivesTheInitialIntensityAndAnApproachDoesNot) {
  ContactTracker tracker(glue());
  step(tracker, {at(0, 0), at(1, 1, 1e-3)});
  ASSERT_EQ(tracker.records().size(), 2U);
  EXPECT_EQ(tracker.records()[0].intensity, 1);
  EXPECT_EQ(tracker.records()[1].intensity, 0);

  tracker.begin_step(std::vector{at(0, 0), at(1, 1, 1e-3)}, std::vector<BodyPose>(2), report_step);
  tracker.end_step(impulses({0, 0, 0, 1e-3, 0, 0}), std::vector<BodyPose>(2));

  EXPECT_EQ(tracker.records()[1].intensity, 1);
}

TEST(ContactTracker, AContactThatLetGoDoesNotBondAtOnceWhereItStillTouches) {
  ContactTrackerOptions options = glue();
  options.materials[0].energy = 1e-9;
  options.materials[0].viscosity = 1;
  ContactTracker tracker(options);
  step(tracker, {at(0, 0)});
  const std::vector<BodyPose> slid = {moved(0, 0, 0), moved(0.1, 0, 0)};
  tracker.begin_step(std::vector{at(0, 0)}, slid, report_step);

  const AdhesionStep torn = tracker.end_step(rest(1), slid);

  EXPECT_EQ(torn.debonded, std::vector<std::uint8_t>{1});
  step(tracker, {at(0, 0)}, slid);
  EXPECT_EQ(tracker.records()[0].intensity, 0);
  step(tracker, {}, slid);
  EXPECT_TRUE(tracker.records().empty());
  step(tracker, {at(0, 0)}, slid);  // a new contact after a separation
  EXPECT_EQ(tracker.records()[0].intensity, 1);
}

TEST(ContactTracker, KeepsContactsThatAdhereAndRemovesOthers) {
  ContactTracker tracker(glue());
  step(tracker, {at(0, 0), at(1, 1, 1e-3)});

  const auto& contacts =
      tracker.begin_step({}, std::vector{moved(0, 0, 0), moved(0, 0, 5e-3)}, report_step);

  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_FALSE(contacts[0].is_reported);
  EXPECT_EQ(contacts[0].key, (ContactKey{0, 0, 1, 0}));
  EXPECT_NEAR(contacts[0].gap[0], 5e-3, 1e-17);
}

TEST(ContactTracker, NeitherOrderOfReportsNorOfBodiesMatters) {
  const std::vector<ReportedContact> reports = {at(0, 4), at(0.5, 2, 1e-4), at(1, 3)};
  std::vector<ReportedContact> turned(reports.rbegin(), reports.rend());
  for (ReportedContact& report : turned) {
    std::swap(report.key.body_a, report.key.body_b);
    std::swap(report.key.feature_a, report.key.feature_b);
    std::swap(report.point_a_world, report.point_b_world);
    report.normal = {0, 0, -1};
  }
  const std::vector<BodyPose> poses(2);
  ContactTracker one(glue()), other(glue());

  const auto& contacts = one.begin_step(reports, poses, report_step);
  const auto& same = other.begin_step(turned, poses, report_step);

  ASSERT_EQ(same.size(), contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    EXPECT_EQ(same[c].key, contacts[c].key);
    EXPECT_EQ(same[c].point_a_world, contacts[c].point_a_world);
    EXPECT_EQ(same[c].gap, contacts[c].gap);
    EXPECT_EQ(same[c].axes, contacts[c].axes);
    EXPECT_TRUE(c == 0 || contacts[c - 1].key < contacts[c].key);
  }
}

TEST(ContactTracker, AChangedFeatureNearTheAnchorIsTheSameContact) {
  for (const double distance : {0.5e-3, 2e-3}) {
    ContactTracker tracker(glue(1e-3));
    step(tracker, {at(0, 0)});

    step(tracker, {at(distance, 7)});

    EXPECT_EQ(tracker.records().size(), distance < 1e-3 ? 1U : 2U);
    EXPECT_EQ(tracker.records().back().key, (ContactKey{0, 0, 1, 7}));
    const Point3 anchor = tracker.records().back().anchor_a;
    EXPECT_EQ(anchor[0], distance < 1e-3 ? 0 : distance);
  }
}

TEST(ContactTracker, TheNearestOfSeveralInheritsAndTheKeyComesFirst) {
  ContactTracker tracker(glue(1));
  step(tracker, {at(0, 0), at(0.1, 1)});

  step(tracker, {at(0.1, 0), at(0.3, 5), at(0.2, 6)});

  // Feature 0 matches by its key, although the other is nearer; of 5 and 6 the nearer matches
  // record 1.
  ASSERT_EQ(tracker.records().size(), 3U);
  EXPECT_EQ(tracker.records()[0].anchor_a[0], 0);
  EXPECT_EQ(tracker.records()[1].anchor_a[0], 0.3);
  EXPECT_EQ(tracker.records()[2].anchor_a[0], 0.1);
}

TEST(ContactTracker, OtherBodiesInheritNothing) {
  ContactTracker tracker(glue(1));
  const std::vector<BodyPose> poses(3);
  step(tracker, {at(0, 0)}, poses);
  ReportedContact other = at(0, 0, 1e-3);
  other.key.body_a = 2;

  const auto& contacts = tracker.begin_step(std::vector{other}, poses, report_step);

  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_EQ(tracker.records()[1].intensity, 0);
}

/// Body 1 slides by 1 mm and both turn together: the gap turns with them.
TEST(ContactTracker, MeasuresTangentialGapsBetweenTheMaterialPoints) {
  ContactTracker tracker(glue());
  step(tracker, {at(0, 0)});
  const double half = std::numbers::pi / 8;
  const std::array<double, 4> turn = {std::cos(half), 0, std::sin(half), 0};  // 45 degrees about y
  const double c = std::numbers::sqrt2 / 2;
  const std::vector<BodyPose> poses = {{{0, 0, 0}, turn}, {{1e-3 * c, 2e-3, -1e-3 * c}, turn}};

  const TrackedContact contact = tracker.begin_step({}, poses, report_step).front();

  EXPECT_NEAR(contact.gap[0], 0, 1e-18);
  EXPECT_NEAR(norm(contact.gap), std::hypot(1e-3, 2e-3), 1e-17);
  const Point3 down = {-c, 0, -c};  // the key's order turns the normal: from body 1 to body 0
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(contact.axes[0][k], down[k], 1e-15);
}

TEST(ContactTracker, GuessesTheLastImpulseInWhateverAxes) {
  ContactTracker tracker(glue());
  ReportedContact report = at(0, 0);
  report.tangent = {1, 0, 0};
  const std::vector<BodyPose> poses(2);
  tracker.begin_step(std::vector{report}, poses, report_step);
  tracker.end_step(impulses({3, 2, 0}), poses);
  report.tangent = {0, -1, 0.5};

  const TrackedContact contact =
      tracker.begin_step(std::vector{report}, poses, report_step).front();
  ContactProblem problem;
  tracker.fill(problem);

  EXPECT_EQ(contact.axes[1], (Point3{0, -1, 0}));
  EXPECT_EQ(problem.impulse_guess[0], 3);
  EXPECT_NEAR(problem.impulse_guess[1], 0, 1e-15);
  EXPECT_NEAR(std::abs(problem.impulse_guess[2]), 2, 1e-15);
}

/// Bonding from 1/2 towards 1 in a sheared contact leaves the force C beta^2 g as it was.
TEST(ContactTracker, BondsThatFormKeepTheForce) {
  ContactTrackerOptions options = glue();
  options.materials[0].initial_intensity = 0.5;
  options.materials[0].bonding_rate = 1e-2;
  ContactTracker tracker(options);
  step(tracker, {at(0, 0)});
  const std::vector<BodyPose> slid = {moved(0, 0, 0), moved(1e-4, 2e-4, 0)};
  const Point3 before = tracker.begin_step(std::vector{at(1e-4, 0)}, slid, report_step).front().gap;

  tracker.end_step(impulses({1e-2 * report_area * 1e4, 0, 0}), slid);

  const double beta = tracker.records()[0].intensity;
  ASSERT_NEAR(beta, 1, 1e-12);  // 0.5 + report_step r p with p = 10 kPa
  const Point3 after = tracker.begin_step(std::vector{at(1e-4, 0)}, slid, report_step).front().gap;
  EXPECT_NEAR(after[1], before[1] / 4, 1e-17);
  EXPECT_NEAR(after[2], before[2] / 4, 1e-17);
}

TEST(ContactTracker, FillsAProblemThatPassesTheChecks) {
  ContactTracker tracker(glue());
  step(tracker, {at(0, 0), at(1, 1)});
  tracker.begin_step(std::vector{at(0, 0, 1e-3), at(2, 2)},
                     std::vector{moved(0, 0, 0), moved(1e-4, 0, 1e-3)}, report_step);

  ContactProblem problem;
  tracker.fill(problem);

  const std::size_t dofs = 9;  // every row on a separate body
  for (std::size_t k = 0; k < dofs; ++k) {
    for (SparseMatrix* matrix : {&problem.system, &problem.jacobian}) {
      if (k == 0) *matrix = {9, 9, {0}, {}, {}};
      matrix->column.push_back(static_cast<std::int32_t>(k));
      matrix->value.push_back(1);
      matrix->row_start.push_back(static_cast<std::int64_t>(k + 1));
    }
  }
  problem.load.assign(dofs, 0);
  EXPECT_EQ(problem.contact_count(), 3);
  EXPECT_NO_THROW(check_problem(problem));
  EXPECT_NEAR(problem.velocity_offset[0], 0.1, 1e-15);
  EXPECT_EQ(problem.adhesion.tangential_stiffness[0], report_stiffness);
}

TEST(ContactTracker, RefusesWhatItCannotFollow) {
  ContactTracker tracker(glue());
  const std::vector<BodyPose> poses(2);
  const auto begin = [&](const std::vector<ReportedContact>& reports) {
    tracker.begin_step(reports, poses, report_step);
  };
  ReportedContact itself = at(0, 0), nowhere = at(0, 0), bent = at(0, 0), odd = at(0, 0);
  itself.key = {1, 0, 1, 2};
  nowhere.key.body_a = 2;
  bent.normal = {0, 0, 1.1};
  odd.material = 1;

  EXPECT_THROW(begin({at(0, 0), at(1, 0)}), std::invalid_argument);
  for (const ReportedContact& report : {itself, nowhere, bent, odd}) {
    EXPECT_THROW(begin({report}), std::invalid_argument);
  }
  EXPECT_THROW(tracker.begin_step({}, poses, 0), std::invalid_argument);
  ContactTrackerOptions options = glue();
  options.materials[0].initial_intensity = 1.5;
  EXPECT_THROW(ContactTracker{options}, std::invalid_argument);
  EXPECT_THROW(ContactTracker(glue(), {ContactRecord{.key = {1, 0, 0, 0}}}), std::invalid_argument);
}
}  // namespace
}  // namespace tetwarp::test
