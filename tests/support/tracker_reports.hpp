/// @file tracker_reports.hpp
/// Contacts of two bodies as ContactTracker gets them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <tetwarp/contact_tracker.hpp>
#include <vector>

namespace tetwarp::test {

constexpr double report_area = 1e-4;      // [m^2]
constexpr double report_stiffness = 1e6;  // [N/m^3]
constexpr double report_step = 0.01;      // [s]

/// Glue that bonds at the first touch and never debonds.
inline ContactTrackerOptions glue(double match_distance = 0, double intensity = 1) {
  ContactTrackerOptions options;
  options.materials = {
      {.friction = 0.5, .stiffness = report_stiffness, .initial_intensity = intensity}};
  options.match_distance = match_distance;
  return options;
}

/// Body 1 above body 0, touching at (x, 0, z).
inline ReportedContact at(double x, std::int32_t feature, double gap = 0, double z = 0) {
  ReportedContact report;
  report.key = {1, feature, 0, 0};
  report.point_a_world = {x, 0, z + gap};
  report.point_b_world = {x, 0, z};
  report.area = report_area;
  return report;
}

/// No impulses, no velocities.
inline ContactSolution rest(std::size_t contacts) {
  ContactSolution solution;
  solution.impulse.assign(3 * contacts, 0);
  solution.velocity = solution.impulse;
  return solution;
}

/// One whole step in which nothing moves.
inline void step(ContactTracker& tracker,
                 const std::vector<ReportedContact>& reports,
                 const std::vector<BodyPose>& poses = {2, BodyPose{}}) {
  const std::size_t count = tracker.begin_step(reports, poses, report_step).size();
  tracker.end_step(rest(count), poses);
}

}  // namespace tetwarp::test
