/// @file test_contact_tracker_misuse.cpp
/// The tracker refuses calls out of order and numbers that are not finite, and keeps its state.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <tetwarp/contact_tracker.hpp>
#include <vector>

#include "tests/support/tracker_reports.hpp"

namespace tetwarp::test {
namespace {
/// The text of the exception of type Error that a call throws, or "no error".
template <class Error, class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ContactTracker, RefusesToEndAStepThatHasNotBegun) {
  ContactTracker tracker(glue());
  const std::vector<BodyPose> poses(2);
  EXPECT_NE(refusal<std::logic_error>([&] { tracker.end_step(rest(0), poses); }).find("end_step()"),
            std::string::npos);
  step(tracker, {at(0, 0)});

  EXPECT_NE(refusal<std::logic_error>([&] { tracker.end_step(rest(1), poses); }).find("end_step()"),
            std::string::npos);
  ContactProblem problem;
  EXPECT_NE(refusal<std::logic_error>([&] { tracker.fill(problem); }).find("begin_step()"),
            std::string::npos);

  ASSERT_EQ(tracker.records().size(), 1U);
  EXPECT_EQ(tracker.records()[0].intensity, 1);
}

TEST(ContactTracker, ContactsStayValidUntilTheNextStep) {
  ContactTracker tracker(glue());
  const std::vector<BodyPose> poses(2);
  const auto& contacts = tracker.begin_step(std::vector{at(0, 0), at(1, 1)}, poses, report_step);

  tracker.end_step(rest(2), poses);

  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_EQ(contacts[1].key, (ContactKey{0, 0, 1, 1}));
}

TEST(ContactTracker, StoresNoImpulsesThatAreNotFinite) {
  const std::vector<BodyPose> poses(2);
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    for (const std::size_t row : {0U, 2U}) {
      ContactTracker tracker(glue());
      tracker.begin_step(std::vector{at(0, 0)}, poses, report_step);
      ContactSolution impulse = rest(1), velocity = rest(1);
      impulse.impulse[row] = velocity.velocity[row] = bad;

      const auto end = [&](const ContactSolution& solution) {
        return refusal<std::invalid_argument>([&] { tracker.end_step(solution, poses); });
      };

      EXPECT_NE(end(impulse).find("solution.impulse of contact (0, 0, 1, 0)"), std::string::npos);
      EXPECT_NE(end(velocity).find("solution.velocity of contact (0, 0, 1, 0)"), std::string::npos);
      EXPECT_NE(end(rest(2)).find("has 6 numbers, expected 3"), std::string::npos);
      EXPECT_EQ(tracker.records()[0].impulse_world, (Point3{0, 0, 0}));
      EXPECT_NO_THROW(tracker.end_step(rest(1), poses));  // the step goes on
    }
  }
}

TEST(ContactTracker, RefusesPosesAndStepsThatAreNotFinite) {
  const std::vector<BodyPose> good(2);
  const auto begin = [&](const std::vector<BodyPose>& poses, double time_step) {
    ContactTracker tracker(glue());
    return refusal<std::invalid_argument>([&] { tracker.begin_step({}, poses, time_step); });
  };
  std::vector<BodyPose> nowhere = good, turned = good, long_one = good, rounded = good;
  nowhere[1].position[2] = std::nan("");
  turned[1].rotation[3] = std::nan("");
  long_one[1].rotation = {2, 0, 0, 0};
  rounded[1].rotation[0] = 1 + 1e-7;

  EXPECT_NE(
      begin(nowhere, report_step).find("the pose of body 1 has a position that is not finite"),
      std::string::npos);
  EXPECT_NE(begin(turned, report_step).find("the pose of body 1 has a rotation"),
            std::string::npos);
  EXPECT_NE(begin(long_one, report_step).find("of length 2, expected 1 within 1e-6"),
            std::string::npos);
  EXPECT_EQ(begin(rounded, report_step), "no error");
  for (const double time_step : {0.0, -report_step, HUGE_VAL, std::nan("")}) {
    EXPECT_NE(begin(good, time_step).find("time_step"), std::string::npos) << time_step;
  }
  ContactTracker tracker(glue());
  tracker.begin_step(std::vector{at(0, 0)}, good, report_step);
  EXPECT_THROW(tracker.end_step(rest(1), long_one), std::invalid_argument);
  EXPECT_NO_THROW(tracker.end_step(rest(1), good));
}

TEST(ContactTracker, RefusesRecordsAndReportsThatAreNotFinite) {
  ContactRecord record{.key = {0, 0, 1, 0}};
  record.anchor_b[1] = std::nan("");
  EXPECT_THROW(ContactTracker(glue(), {record}), std::invalid_argument);
  ContactTracker tracker(glue());
  ReportedContact moving = at(0, 0), closing = at(0, 0);
  moving.surface_velocity[0] = HUGE_VAL;
  closing.approach_speed = std::nan("");
  for (const ReportedContact& report : {moving, closing}) {
    EXPECT_THROW(tracker.begin_step(std::vector{report}, std::vector<BodyPose>(2), report_step),
                 std::invalid_argument);
  }
  ContactTrackerOptions lively = glue();
  lively.materials[0].restitution = 1.5;
  EXPECT_THROW(ContactTracker{lively}, std::invalid_argument);
}
/// The error has the key, so that its message can name the bodies.
TEST(ContactTracker, NamesTheContactThatItRefuses) {
  ContactTracker tracker(glue());
  const std::vector<BodyPose> poses(2);
  ReportedContact second = at(1, 7);
  try {
    tracker.begin_step(std::vector{at(0, 3), second, at(2, 7)}, poses, report_step);
    FAIL() << "expected an error";
  } catch (const ContactKeyError& error) {
    EXPECT_EQ(error.key(), (ContactKey{0, 0, 1, 7}));
    EXPECT_NE(std::string(error.what()).find("is reported twice"), std::string::npos);
  }
  second.normal = {0, 0, 2};
  EXPECT_NE(refusal<ContactKeyError>([&] {
              tracker.begin_step(std::vector{second}, poses, report_step);
            }).find("has a normal that is not a unit vector"),
            std::string::npos);
}

}  // namespace
}  // namespace tetwarp::test
