/// @file pressing_impulses.cpp
/// Linear pressure over patches of rigid bodies, pressure at the nodes of others.
#include "host/simulate/contact_step/pressing_impulses.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "host/base/point3.hpp"
#include "host/simulate/patches/rigid_patches.hpp"

namespace tetwarp {
namespace {
constexpr double cosine_20 = 0.9396926207859084;  ///< of one patch, as in RigidPatches

bool is_patch_point(const ContactKey& key) {
  return key.feature_b == RigidPatches::first_feature;
}

/// The patch of an adhesion point among those of its bodies.
std::int32_t slot_of(const ContactKey& key) {
  return (RigidPatches::first_feature - key.feature_a) / 4;
}

std::pair<std::int32_t, std::int32_t> bodies_of(const TrackedContact& contact) {
  return {contact.key.body_a, contact.key.body_b};
}

Point3 middle_of(const TrackedContact& contact) {
  return times(0.5, plus(contact.point_a_world, contact.point_b_world));
}

/// Shares of a load among the points of a patch, by which force and moment stay what they are.
class PatchShares {
 public:
  PatchShares(std::span<const TrackedContact> contacts, std::span<const std::size_t> points)
      : axes_(contacts[points[0]].axes), count_(static_cast<double>(points.size())) {
    for (const std::size_t p : points) {
      center_ = plus(center_, times(1 / count_, middle_of(contacts[p])));
    }
    for (const std::size_t p : points) {
      const auto [x, y] = place_of(contacts[p]);
      xx_ += x * x / count_;
      xy_ += x * y / count_;
      yy_ += y * y / count_;
    }
  }

  double share(const TrackedContact& load, const TrackedContact& point) const {
    const double determinant = xx_ * yy_ - xy_ * xy_;
    const double size = xx_ + yy_;
    if (!(determinant > 1e-12 * size * size)) return 1 / count_;  // points on a line
    const auto [a, b] = place_of(load);
    const auto [x, y] = place_of(point);
    return (1 + (a * (yy_ * x - xy_ * y) + b * (xx_ * y - xy_ * x)) / determinant) / count_;
  }

 private:
  std::pair<double, double> place_of(const TrackedContact& contact) const {
    const Point3 from_center = minus(middle_of(contact), center_);
    return {dot(from_center, axes_[1]), dot(from_center, axes_[2])};
  }

  std::array<Point3, 3> axes_;
  double count_;
  Point3 center_{0, 0, 0};
  double xx_ = 0, xy_ = 0, yy_ = 0;  ///< mean products of the places of points [m^2]
};
}  // namespace

PressingImpulses::PressingImpulses(const SceneSurfaces& surfaces)
    : surfaces_(surfaces),
      has_bonding_(std::ranges::any_of(
          surfaces.materials, [](const ContactMaterial& of) { return of.bonding_rate > 0; })) {}

/// The tracker has every material twice.
bool PressingImpulses::forms_bonds(const ContactRecord& record) const {
  const std::size_t count = surfaces_.materials.size();
  return surfaces_.materials[static_cast<std::size_t>(record.material) % count].bonding_rate > 0;
}

std::span<const double> PressingImpulses::spread(std::span<const TrackedContact> contacts,
                                                 std::span<const ContactRecord> records,
                                                 std::span<const double> impulses) {
  if (!has_bonding_) return {};
  const Step step{contacts, records, impulses, 0.1 * surfaces_.surfaces.thickness};
  pressing_.assign(contacts.size(), 0);
  order_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (forms_bonds(records[c])) order_.push_back(c);
  }
  if (order_.empty()) return {};
  std::ranges::sort(order_, {},
                    [&](std::size_t c) { return std::pair(bodies_of(contacts[c]), c); });
  for (std::size_t first = 0; first < order_.size();) {
    std::size_t last = first;
    while (last < order_.size() &&
           bodies_of(contacts[order_[last]]) == bodies_of(contacts[order_[first]])) {
      ++last;
    }
    spread_pair(step, std::span(order_).subspan(first, last - first));
    first = last;
  }
  return pressing_;
}

void PressingImpulses::spread_pair(const Step& step, std::span<const std::size_t> pair) {
  const ContactKey& key = step.contacts[pair[0]].key;
  const bool is_rigid_a = at(surfaces_.surfaces.bodies, key.body_a).is_rigid;
  const bool is_rigid_b = at(surfaces_.surfaces.bodies, key.body_b).is_rigid;
  if (is_rigid_a && is_rigid_b) return spread_patches(step, pair);
  const double share = is_rigid_a || is_rigid_b ? 1 : 0.5;
  if (!is_rigid_a) spread_over_nodes(step, pair, true, share);
  if (!is_rigid_b) spread_over_nodes(step, pair, false, share);
}

/// Each patch takes the contacts of the pair with about its normal.
void PressingImpulses::spread_patches(const Step& step, std::span<const std::size_t> pair) {
  const auto slot = [&](std::size_t c) { return slot_of(step.contacts[c].key); };
  points_.clear();
  for (const std::size_t c : pair) {
    if (is_patch_point(step.contacts[c].key) && step.records[c].area > 0) points_.push_back(c);
  }
  std::ranges::sort(points_, {}, [&](std::size_t c) { return std::pair(slot(c), c); });
  for (std::size_t first = 0; first < points_.size();) {
    std::size_t last = first;
    while (last < points_.size() && slot(points_[last]) == slot(points_[first])) ++last;
    const auto points = std::span(points_).subspan(first, last - first);
    const Point3& normal = step.contacts[points[0]].axes[0];
    const PatchShares shares(step.contacts, points);
    for (const std::size_t c : pair) {
      if (!step.touches(c) || dot(step.contacts[c].axes[0], normal) <= cosine_20) continue;
      for (const std::size_t p : points) {
        if (!step.touches(p)) continue;
        pressing_[p] += step.impulse(c) * shares.share(step.contacts[c], step.contacts[p]);
      }
    }
    first = last;
  }
}

void PressingImpulses::spread_over_nodes(const Step& step,
                                         std::span<const std::size_t> pair,
                                         bool of_a,
                                         double share) {
  entries_.clear();
  for (const std::size_t c : pair) {
    if (step.touches(c)) list_nodes(step.contacts[c], of_a, c);
  }
  for (const Entry& entry : entries_) {
    NodeSum& sum = sum_of(entry.node);
    sum.impulse += entry.weight * step.impulse(entry.contact);
    sum.area += entry.weight * step.records[entry.contact].area;
  }
  for (const Entry& entry : entries_) {
    const NodeSum& sum = sum_of(entry.node);
    if (!(sum.area > 0)) continue;
    const double part = entry.weight * step.records[entry.contact].area / sum.area;
    pressing_[entry.contact] += share * part * sum.impulse;
  }
  for (const Entry& entry : entries_) sum_of(entry.node) = {};
}

/// Lists the nodes that one side of a contact moves with.
void PressingImpulses::list_nodes(const TrackedContact& of, bool of_a, std::size_t contact) {
  const MaterialPoint& point = of_a ? of.material_a : of.material_b;
  const std::int32_t body = of_a ? of.key.body_a : of.key.body_b;
  const std::int32_t first = at(surfaces_.surfaces.bodies, body).first_vertex;
  for (std::size_t v = 0; v < 3 && point.vertex[v] >= 0; ++v) {
    const ModelPoint& vertex = at(surfaces_.vertex_point, first + point.vertex[v]);
    for (std::size_t n = 0; n < 4 && vertex.node[n] >= 0; ++n) {
      const double weight = point.weight[v] * vertex.weight[n];
      if (weight > 0) entries_.push_back({contact, vertex.node[n], weight});
    }
  }
}

PressingImpulses::NodeSum& PressingImpulses::sum_of(std::int32_t node) {
  const auto index = static_cast<std::size_t>(node);
  if (index >= sums_.size()) sums_.resize(index + 1);
  return sums_[index];
}

}  // namespace tetwarp
