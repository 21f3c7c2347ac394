#include "host/contact/tracker/match.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "host/contact/tracker/geometry.hpp"

namespace tetwarp {
namespace {
struct Candidate {
  double squared_distance;
  std::size_t report;
  std::size_t record;

  bool operator<(const Candidate& other) const {
    return std::tie(squared_distance, report, record) <
           std::tie(other.squared_distance, other.report, other.record);
  }
};

using BodyPair = std::pair<std::int32_t, std::int32_t>;

BodyPair bodies_of(const ContactKey& key) {
  return {key.body_a, key.body_b};
}
}  // namespace

ReportedContact in_key_order(const ReportedContact& report) {
  const ContactKey& key = report.key;
  if (std::tie(key.body_a, key.feature_a) <= std::tie(key.body_b, key.feature_b)) return report;
  ReportedContact turned = report;
  turned.key = {key.body_b, key.feature_b, key.body_a, key.feature_a};
  std::swap(turned.point_a_world, turned.point_b_world);
  for (Point3* vector : {&turned.normal, &turned.surface_velocity, &turned.obstacle_velocity}) {
    for (double& component : *vector) component = -component;
  }
  return turned;
}

std::vector<std::int64_t> match_contacts(std::span<const ReportedContact> reports,
                                         std::span<const ContactRecord> records,
                                         std::span<const BodyPose> poses,
                                         double match_distance) {
  std::vector<std::int64_t> matches(reports.size(), -1);
  std::vector<bool> is_taken(records.size());
  for (std::size_t r = 0; r < reports.size(); ++r) {
    const auto found =
        std::lower_bound(records.begin(), records.end(), reports[r].key,
                         [](const ContactRecord& a, const ContactKey& key) { return a.key < key; });
    if (found == records.end() || found->key != reports[r].key) continue;
    matches[r] = found - records.begin();
    is_taken[static_cast<std::size_t>(matches[r])] = true;
  }

  std::map<BodyPair, std::vector<std::size_t>> left;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (!is_taken[k]) left[bodies_of(records[k].key)].push_back(k);
  }
  std::vector<Candidate> candidates;
  for (std::size_t r = 0; r < reports.size(); ++r) {
    const auto same_bodies = left.find(bodies_of(reports[r].key));
    if (matches[r] >= 0 || same_bodies == left.end()) continue;
    const BodyPose& pose = poses[static_cast<std::size_t>(reports[r].key.body_a)];
    const Eigen::Vector3d point = vector_of(body_of(pose, vector_of(reports[r].point_a_world)));
    for (const std::size_t k : same_bodies->second) {
      const double squared = (point - vector_of(records[k].anchor_a)).squaredNorm();
      if (squared <= match_distance * match_distance) candidates.push_back({squared, r, k});
    }
  }
  std::sort(candidates.begin(), candidates.end());
  for (const Candidate& candidate : candidates) {
    if (matches[candidate.report] >= 0 || is_taken[candidate.record]) continue;
    matches[candidate.report] = static_cast<std::int64_t>(candidate.record);
    is_taken[candidate.record] = true;
  }
  return matches;
}

}  // namespace tetwarp
