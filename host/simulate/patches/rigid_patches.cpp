/// @file rigid_patches.cpp
/// Collects the contacts of each pair of rigid bodies, and reduces them.
#include "host/simulate/patches/rigid_patches.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "host/base/point3.hpp"
#include "host/simulate/surfaces/find_record.hpp"

namespace tetwarp {
namespace {
constexpr double cosine_20 = 0.9396926207859084;
constexpr double growth = 1.1;  ///< of the area of a patch, above which a bonded point moves

ContactKey point_key(const ContactKey& bodies, std::int32_t slot, std::int32_t point) {
  constexpr std::int32_t first = RigidPatches::first_feature;
  return {bodies.body_a, first - 4 * slot - point, bodies.body_b, first};
}

std::tuple<std::int32_t, std::int32_t> bodies_of(const ReportedContact& contact) {
  return {contact.key.body_a, contact.key.body_b};
}
}  // namespace

bool RigidPatches::is_rigid(const ReportedContact& contact) const {
  return at(scene_.surfaces.bodies, contact.key.body_a).is_rigid &&
         at(scene_.surfaces.bodies, contact.key.body_b).is_rigid;
}

void RigidPatches::reduce(std::vector<ReportedContact>& contacts,
                          const std::vector<Point3>& vertices,
                          std::span<const ContactRecord> records) {
  order_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (is_rigid(contacts[c])) order_.push_back(c);
  }
  if (order_.empty()) return;
  kept_.clear();
  std::sort(order_.begin(), order_.end(), [&](std::size_t i, std::size_t k) {
    return std::tuple(bodies_of(contacts[i]), contacts[i].key) <
           std::tuple(bodies_of(contacts[k]), contacts[k].key);
  });
  for (std::size_t first = 0; first < order_.size();) {
    left_.clear();
    const auto bodies = bodies_of(contacts[order_[first]]);
    for (; first < order_.size() && bodies_of(contacts[order_[first]]) == bodies; ++first) {
      left_.push_back(order_[first]);
    }
    reduce_pair(contacts, vertices, records);
  }
  const auto by_key = [](const ReportedContact& p, const ReportedContact& q) {
    return p.key < q.key;
  };
  std::erase_if(contacts, [this](const ReportedContact& contact) { return is_rigid(contact); });
  const auto others = static_cast<std::ptrdiff_t>(contacts.size());
  std::sort(kept_.begin(), kept_.end(), by_key);
  contacts.insert(contacts.end(), kept_.begin(), kept_.end());
  std::inplace_merge(contacts.begin(), contacts.begin() + others, contacts.end(), by_key);
}

void RigidPatches::reduce_pair(std::vector<ReportedContact>& contacts,
                               const std::vector<Point3>& vertices,
                               std::span<const ContactRecord> records) {
  slots_.clear();
  while (!left_.empty()) {
    patch_.clear();
    next_left_.clear();
    const ReportedContact& first = contacts[left_[0]];
    for (const std::size_t c : left_) {
      const bool is_alike = dot(contacts[c].normal, first.normal) > cosine_20;
      (is_alike ? patch_ : next_left_).push_back(c);
    }
    left_.swap(next_left_);
    if (at(scene_.materials, first.material).stiffness > 0) {
      const PatchPoints points = moments_.points_of(contacts, patch_, vertices);
      if (points.area > 0) add_points(first, points, records);
    }
    supports_.choose(contacts, patch_, scene_.surfaces.thickness, chosen_);
    for (const std::size_t c : chosen_) {
      kept_.push_back(contacts[c]);
      kept_.back().area = 0;
    }
  }
}

/// The number of the patch of these bodies that faces the same way, or a free one.
std::int32_t RigidPatches::slot_of(const ContactKey& bodies,
                                   const Point3& normal,
                                   std::span<const ContactRecord> records) {
  std::int32_t free = -1;
  for (std::int32_t slot = 0;; ++slot) {
    if (std::find(slots_.begin(), slots_.end(), slot) != slots_.end()) continue;
    const ContactRecord* record = nullptr;
    for (std::int32_t k = 0; k < 4 && record == nullptr; ++k) {
      record = find_record(records, point_key(bodies, slot, k));
    }
    if (record == nullptr) {
      // Patches are numbered from 0; a patch that has ended leaves at most one unused number.
      if (free >= 0) return free;
      free = slot;
    } else if (dot(record->normal_world, normal) > cosine_20) {
      return slot;
    }
  }
}

void RigidPatches::add_points(const ReportedContact& first,
                              const PatchPoints& points,
                              std::span<const ContactRecord> records) {
  const std::int32_t slot = slot_of(first.key, points.normal, records);
  slots_.push_back(slot);
  std::array<const ContactRecord*, 4> record{};
  double area = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    record[k] = find_record(records, point_key(first.key, slot, static_cast<std::int32_t>(k)));
    if (record[k] != nullptr) area += record[k]->area;
  }
  const bool has_grown = points.area > growth * area;
  for (std::size_t k = 0; k < 4; ++k) {
    const bool is_bonded = record[k] != nullptr && record[k]->intensity > 0;
    if (is_bonded && !has_grown) continue;
    const auto& [middle, gap] = points.point[k];
    ReportedContact& contact = kept_.emplace_back();
    contact.key = point_key(first.key, slot, static_cast<std::int32_t>(k));
    contact.normal = points.normal;
    contact.point_a_world = plus(middle, times(gap / 2, points.normal));
    contact.point_b_world = minus(middle, times(gap / 2, points.normal));
    contact.area = points.area / 4;
    contact.material = first.material;
    contact.tangent = first.tangent;
    if (is_bonded) contact.bonded_share = std::min(1.0, record[k]->area / contact.area);
  }
}

}  // namespace tetwarp
