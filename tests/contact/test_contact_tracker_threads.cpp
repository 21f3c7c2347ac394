/// @file test_contact_tracker_threads.cpp
/// The tracker does the same on any number of threads.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <stdexcept>
#include <string>
#include <tetwarp/contact_tracker.hpp>
#include <vector>

namespace tetwarp::test {
namespace {
constexpr double step_time = 0.01;
constexpr std::size_t many_contacts = 2000;
constexpr std::int32_t sheet_side = 50;  ///< vertices

/// Vertices of a rough sheet, which follow body 1; body 0 is rigid.
std::vector<Point3> sheet(double height) {
  std::vector<Point3> vertices;
  for (std::int32_t v = 0; v < sheet_side * sheet_side; ++v) {
    vertices.push_back(
        {0.01 * (v % sheet_side), 0.01 * (v / sheet_side), height + 1e-4 * std::sin(v)});
  }
  return vertices;
}

/// Contacts of random triangles of the sheet with the rigid body.
std::vector<ReportedContact> reports_on(const std::vector<Point3>& vertices, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.1, 0.4);
  std::vector<ReportedContact> reports(many_contacts);
  for (std::size_t c = 0; c < many_contacts; ++c) {
    ReportedContact& report = reports[c];
    report.key = {1, static_cast<std::int32_t>(c + seed % 7), 0, 0};
    const auto v = static_cast<std::int32_t>(c % (sheet_side * (sheet_side - 1) - 1));
    report.material_a.vertex = {v, v + 1, v + sheet_side};
    report.material_a.weight = {share(random), share(random), 0};
    report.material_a.weight[2] = 1 - report.material_a.weight[0] - report.material_a.weight[1];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(report.material_a.vertex[k]);
      for (std::size_t i = 0; i < 3; ++i) {
        report.point_a_world[i] += report.material_a.weight[k] * vertices[corner][i];
      }
    }
    report.point_b_world = report.point_a_world;
    report.point_b_world[2] = 0;
    report.area = 1e-4;
  }
  return reports;
}

ContactTrackerOptions options_with(int threads) {
  ContactTrackerOptions options;
  options.materials = {{.friction = 0.3,
                        .stiffness = 1e6,
                        .energy = 1,
                        .viscosity = 0.05,
                        .bonding_rate = 1e-3,
                        .saturation_pressure = 1e4,
                        .initial_intensity = 0.7}};
  options.match_distance = 2e-3;
  options.touch_distance = 1e-3;
  options.threads = threads;
  return options;
}

ContactSolution random_solution(std::size_t contacts, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  ContactSolution solution;
  for (std::size_t row = 0; row < 3 * contacts; ++row) {
    solution.impulse.push_back(1e-2 * number(random));
    solution.velocity.push_back(1e-2 * number(random));
  }
  return solution;
}

/// The records after three steps in which the sheet rises.
std::vector<ContactRecord> records_with(int threads) {
  ContactTracker tracker(options_with(threads));
  for (unsigned n = 0; n < 3; ++n) {
    const std::vector<Point3> start = sheet(1e-3 * n), end = sheet(1e-3 * (n + 1));
    const std::vector<BodyPlace> before = {{}, {.vertices = start}},
                                 after = {{}, {.vertices = end}};
    const std::size_t contacts = tracker.begin_step(reports_on(start, n), before, step_time).size();
    tracker.end_step(random_solution(contacts, n), after);
  }
  return tracker.records();
}

TEST(ContactTracker, AnyNumberOfThreadsGivesTheSameRecords) {
  const std::vector<ContactRecord> one = records_with(1);
  ASSERT_GT(one.size(), many_contacts);  // bonds that are not reported are kept
  for (const int threads : {2, 5, 0}) {
    const std::vector<ContactRecord> many = records_with(threads);
    ASSERT_EQ(many.size(), one.size()) << threads;
    for (std::size_t k = 0; k < one.size(); ++k) {
      ASSERT_EQ(many[k].key, one[k].key);
      EXPECT_EQ(many[k].intensity, one[k].intensity) << k;
      EXPECT_EQ(many[k].anchor_b, one[k].anchor_b) << k;
      EXPECT_EQ(many[k].material_a.weight, one[k].material_a.weight) << k;
      EXPECT_EQ(many[k].normal_a, one[k].normal_a) << k;
      EXPECT_EQ(many[k].impulse_world, one[k].impulse_world) << k;
      EXPECT_EQ(many[k].standoff, one[k].standoff) << k;
    }
  }
}

TEST(ContactTracker, AnyNumberOfThreadsNamesTheFirstContactThatIsWrong) {
  const std::vector<Point3> vertices = sheet(0);
  const std::vector<BodyPlace> places = {{}, {.vertices = vertices}};
  std::vector<ReportedContact> reports = reports_on(vertices, 0);
  reports[700].area = reports[1900].area = -1;
  std::string first;
  for (const int threads : {1, 4}) {
    ContactTracker tracker(options_with(threads));
    try {
      tracker.begin_step(reports, places, step_time);
      ADD_FAILURE() << "a negative area is accepted";
    } catch (const std::invalid_argument& error) {
      if (threads == 1) first = error.what();
      EXPECT_EQ(error.what(), first);
      EXPECT_NE(first.find("contact (0, 0, 1, 700)"), std::string::npos) << first;
    }
    EXPECT_TRUE(tracker.records().empty());
  }
  EXPECT_THROW(ContactTracker(options_with(-1)), std::invalid_argument);
}

}  // namespace
}  // namespace tetwarp::test
