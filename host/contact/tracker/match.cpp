/// @file match.cpp
/// Matches by key first, then by place among contacts of the same two bodies.
#include "host/contact/tracker/match.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "host/contact/tracker/geometry.hpp"
#include "host/contact/tracker/input_checks.hpp"

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

/// A record that no report has the key of.
struct FreeRecord {
  std::int32_t body_a, body_b;
  Eigen::Vector3d anchor;  ///< on body a: in coordinates of a rigid one, world of a deformable one
  std::size_t record;

  auto order() const { return std::tuple(body_a, body_b, anchor.x(), record); }
};

bool is_in_key_order(const ContactKey& key) {
  return std::tie(key.body_a, key.feature_a) <= std::tie(key.body_b, key.feature_b);
}

ReportedContact in_key_order(const ReportedContact& report) {
  const ContactKey& key = report.key;
  if (is_in_key_order(key)) return report;
  ReportedContact turned = report;
  turned.key = {key.body_b, key.feature_b, key.body_a, key.feature_a};
  std::swap(turned.point_a_world, turned.point_b_world);
  std::swap(turned.material_a, turned.material_b);
  for (Point3* vector : {&turned.normal, &turned.surface_velocity, &turned.obstacle_velocity}) {
    for (double& component : *vector) component = -component;
  }
  return turned;
}

bool is_sorted(std::span<const ReportedContact> reports) {
  for (std::size_t r = 0; r < reports.size(); ++r) {
    if (!is_in_key_order(reports[r].key)) return false;
    if (r > 0 && !(reports[r - 1].key < reports[r].key)) return false;
  }
  return true;
}

/// Whether the normals differ by less than 60 degrees: a point may touch two sides of a body.
bool face_alike(const ReportedContact& report, const ContactRecord& record) {
  const Eigen::Vector3d normal = vector_of(record.normal_world);
  return normal.isZero() || normal.dot(vector_of(report.normal)) > 0.5;
}

/// Matches equal keys.
/// @returns whether each record is taken
std::vector<std::uint8_t> match_keys(std::span<const ReportedContact> reports,
                                     std::span<const ContactRecord> records,
                                     std::vector<std::int64_t>& matches) {
  std::vector<std::uint8_t> is_taken(records.size());
  std::size_t k = 0;
  for (std::size_t r = 0; r < reports.size(); ++r) {
    while (k < records.size() && records[k].key < reports[r].key) ++k;
    if (k == records.size() || records[k].key != reports[r].key) continue;
    matches[r] = static_cast<std::int64_t>(k);
    is_taken[k] = 1;
  }
  return is_taken;
}
}  // namespace

std::span<const ReportedContact> sorted_reports(std::span<const ReportedContact> reports,
                                                std::vector<ReportedContact>& storage) {
  if (is_sorted(reports)) return reports;
  std::vector<std::pair<ContactKey, std::size_t>> order;
  order.reserve(reports.size());
  for (std::size_t r = 0; r < reports.size(); ++r) {
    const ContactKey& key = reports[r].key;
    order.emplace_back(is_in_key_order(key)
                           ? key
                           : ContactKey{key.body_b, key.feature_b, key.body_a, key.feature_a},
                       r);
  }
  std::sort(order.begin(), order.end());
  storage.clear();
  storage.reserve(reports.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && order[i].first == order[i - 1].first) {
      refuse(order[i].first, "is reported twice");
    }
    storage.push_back(in_key_order(reports[order[i].second]));
  }
  return storage;
}

std::vector<std::int64_t> match_contacts(std::span<const ReportedContact> reports,
                                         std::span<const ContactRecord> records,
                                         std::span<const BodyPlace> places,
                                         double match_distance) {
  std::vector<std::int64_t> matches(reports.size(), -1);
  std::vector<std::uint8_t> is_taken = match_keys(reports, records, matches);

  std::vector<FreeRecord> free;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (is_taken[k] != 0) continue;
    const ContactRecord& record = records[k];
    const BodyPlace& place = place_of(places, record.key.body_a);
    free.push_back({record.key.body_a, record.key.body_b,
                    place.is_rigid() ? vector_of(record.anchor_a)
                                     : world_of(place.vertices, record.material_a),
                    k});
  }
  if (free.empty()) return matches;
  std::sort(free.begin(), free.end(),
            [](const FreeRecord& a, const FreeRecord& b) { return a.order() < b.order(); });

  std::vector<Candidate> candidates;
  for (std::size_t r = 0; r < reports.size(); ++r) {
    if (matches[r] >= 0) continue;
    const ReportedContact& report = reports[r];
    const BodyPlace& place = place_of(places, report.key.body_a);
    const Eigen::Vector3d point =
        place.is_rigid() ? vector_of(body_of(place.pose, vector_of(report.point_a_world)))
                         : world_of(place.vertices, report.material_a);
    // Wider than match_distance by rounding.
    const double reach = match_distance + 1e-15 * std::abs(point.x());
    const std::tuple from(report.key.body_a, report.key.body_b, point.x() - reach, std::size_t{0});
    auto near = std::lower_bound(
        free.begin(), free.end(), from,
        [](const FreeRecord& record, const auto& order) { return record.order() < order; });
    for (; near != free.end() && near->body_a == report.key.body_a &&
           near->body_b == report.key.body_b && near->anchor.x() <= point.x() + reach;
         ++near) {
      const double squared = (point - near->anchor).squaredNorm();
      if (squared <= match_distance * match_distance && face_alike(report, records[near->record])) {
        candidates.push_back({squared, r, near->record});
      }
    }
  }
  std::sort(candidates.begin(), candidates.end());
  for (const Candidate& candidate : candidates) {
    if (matches[candidate.report] >= 0 || is_taken[candidate.record] != 0) continue;
    matches[candidate.report] = static_cast<std::int64_t>(candidate.record);
    is_taken[candidate.record] = 1;
  }
  return matches;
}

}  // namespace tetwarp
