/// @file pressing_impulses.cpp
/// Linear pressure over patches of rigid bodies, pressure at the nodes of others.
#include "host/simulate/contact_step/pressing_impulses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/base/point3.hpp"
#include "host/simulate/patches/rigid_patches.hpp"

namespace tetwarp {
namespace {
std::pair<std::int32_t, std::int32_t> bodies_of(const TrackedContact& contact) {
  return {contact.key.body_a, contact.key.body_b};
}

Point3 middle_of(const TrackedContact& contact) {
  return times(0.5, plus(contact.point_a_world, contact.point_b_world));
}

/// Shares of a load among the points of a patch, by which force and moment stay what they are; of
/// points on a line the force.
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

PressingImpulses::PressingImpulses(const SceneSurfaces& surfaces,
                                   std::span<const ContactMaterial> materials)
    : surfaces_(surfaces) {
  for (const ContactMaterial& material : materials) {
    forms_bonds_.push_back(material.bonding_rate > 0);
  }
}

std::span<const double> PressingImpulses::spread(std::span<const TrackedContact> contacts,
                                                 std::span<const ContactRecord> records,
                                                 std::span<const double> impulses) {
  const Step step{contacts, records, impulses, 0.1 * surfaces_.surfaces.thickness};
  order_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (forms_bonds_[static_cast<std::size_t>(records[c].material)]) order_.push_back(c);
  }
  if (order_.empty()) return {};
  pressing_.assign(contacts.size(), 0);
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
  divide(step, pair, is_rigid_a && is_rigid_b);
  for (std::size_t first = 0; first < members_.size();) {
    group_.clear();
    std::size_t last = first;
    for (; last < members_.size() && members_[last].first == members_[first].first; ++last) {
      group_.push_back(members_[last].second);
    }
    if (is_rigid_a && is_rigid_b) {
      spread_patch(step);
    } else if (key.body_a == key.body_b) {
      spread_over_nodes(step, true, true, 0.5);
    } else {
      const double share = is_rigid_a || is_rigid_b ? 1 : 0.5;
      if (!is_rigid_a) spread_over_nodes(step, true, false, share);
      if (!is_rigid_b) spread_over_nodes(step, false, true, share);
    }
    first = last;
  }
}

/// Divides the contacts of a pair by the area they press on: the patches of rigid bodies, else
/// areas that face within about 45 degrees. A contact belongs to the one with the nearest normal.
void PressingImpulses::divide(const Step& step,
                              std::span<const std::size_t> pair,
                              bool has_patches) {
  const ContactKey& key = step.contacts[pair[0]].key;
  // Which side of a contact of a body with itself is a depends on its features.
  const bool is_turned = key.body_a == key.body_b;
  areas_.clear();
  const auto nearest = [&](const TrackedContact& contact, double least) {
    std::size_t best = areas_.size();
    for (std::size_t n = 0; n < areas_.size(); ++n) {
      const double cosine = dot(contact.axes[0], areas_[n].normal);
      const double near = is_turned ? std::abs(cosine) : cosine;
      if (near < least) continue;
      least = near;
      best = n;
    }
    return best;
  };
  const auto of_slot = [&](std::int32_t slot) {
    const auto found = std::ranges::find(areas_, slot, &Area::slot);
    return static_cast<std::size_t>(found - areas_.begin());
  };
  for (const std::size_t c : pair) {
    const TrackedContact& contact = step.contacts[c];
    if (!(step.records[c].area > 0)) continue;
    const std::int32_t slot = has_patches ? RigidPatches::slot_of(contact.key) : -1;
    const bool is_known =
        has_patches ? of_slot(slot) < areas_.size() : nearest(contact, cosine_45) < areas_.size();
    if (!is_known) areas_.push_back({contact.axes[0], slot});
  }
  members_.clear();
  for (const std::size_t c : pair) {
    const TrackedContact& contact = step.contacts[c];
    const bool is_point = has_patches && RigidPatches::is_point(contact.key);
    const std::size_t area =
        is_point ? of_slot(RigidPatches::slot_of(contact.key)) : nearest(contact, cosine_45);
    if (area < areas_.size()) members_.emplace_back(area, c);
  }
  std::ranges::sort(members_);
}

/// In a step that closes the patch, its points touch where they are no more open than what pushes.
/// Where the line of the load leaves the patch, points are not pressed by less than nothing.
void PressingImpulses::spread_patch(const Step& step) {
  double open = step.open;
  for (const std::size_t c : group_) {
    if (step.impulse(c) > 0) open = std::max(open, step.gap(c) + step.open);
  }
  points_.clear();
  for (const std::size_t c : group_) {
    if (step.records[c].area > 0 && step.gap(c) <= open) points_.push_back(c);
  }
  if (points_.empty()) return;
  const PatchShares shares(step.contacts, points_);
  double sum = 0, positive = 0;
  for (const std::size_t p : points_) {
    for (const std::size_t c : group_) {
      if (step.gap(c) > open) continue;
      pressing_[p] += step.impulse(c) * shares.share(step.contacts[c], step.contacts[p]);
    }
    sum += pressing_[p];
    positive += std::max(0.0, pressing_[p]);
  }
  const double scale = sum > 0 ? sum / positive : 0;
  for (const std::size_t p : points_) pressing_[p] = scale * std::max(0.0, pressing_[p]);
}

void PressingImpulses::spread_over_nodes(const Step& step, bool of_a, bool of_b, double share) {
  entries_.clear();
  for (const std::size_t c : group_) {
    if (step.gap(c) > step.open) {
      pressing_[c] = std::max(0.0, step.impulse(c));
      continue;
    }
    const TrackedContact& contact = step.contacts[c];
    if (of_a) list_nodes(c, contact.material_a, contact.key.body_a);
    if (of_b) list_nodes(c, contact.material_b, contact.key.body_b);
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
void PressingImpulses::list_nodes(std::size_t contact,
                                  const MaterialPoint& point,
                                  std::int32_t body) {
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
