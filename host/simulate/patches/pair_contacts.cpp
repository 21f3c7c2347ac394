/// @file pair_contacts.cpp
/// Names contacts by their features, and fills reports for the tracker.
#include "host/simulate/patches/pair_contacts.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

ContactKey key_of(std::int32_t body_a,
                  std::int32_t feature_a,
                  std::int32_t body_b,
                  std::int32_t feature_b) {
  return std::tie(body_a, feature_a) <= std::tie(body_b, feature_b)
             ? ContactKey{body_a, feature_a, body_b, feature_b}
             : ContactKey{body_b, feature_b, body_a, feature_a};
}

/// Of the normals of a touch of a vertex and of a record of the same vertex and body; 1 where that
/// of the record is not known.
double cosine_between(const PairTouch& touch, const ContactRecord& record) {
  if (record.normal_world == Point3{0, 0, 0}) return 1;
  const double sign = record.key.feature_a == touch.a ? 1 : -1;
  return sign * dot(record.normal_world, point_of(touch.normal));
}

bool is_bonded(const ContactRecord& record) {
  return record.intensity > 0 && record.area > 0;
}

}  // namespace

PairContacts::NamedTouch PairContacts::named(const PairTouch& touch,
                                             std::int32_t feature_a,
                                             std::int32_t feature_b,
                                             double area) {
  const ContactKey key = key_of(touch.body_a, feature_a, touch.body_b, feature_b);
  const bool is_turned = key.body_a != touch.body_a || key.feature_a != feature_a;
  return {key, &touch, area, is_turned};
}

PairContacts::PairContacts(const SceneSurfaces& scene, int threads)
    : scene_(scene), threads_(threads), areas_(scene.surfaces), patches_(scene, areas_) {}

void PairContacts::list_groups(std::span<const ChosenTouch> touches) {
  groups_.clear();
  for (std::size_t begin = 0; begin < touches.size();) {
    const PairTouch& touch = touches[begin].touch;
    std::size_t end = begin + 1;
    while (!touch.is_of_edges() && end < touches.size() && !touches[end].touch.is_of_edges() &&
           touches[end].touch.a == touch.a && touches[end].touch.body_b == touch.body_b) {
      ++end;
    }
    groups_.push_back({begin, end});
    begin = end;
  }
}

/// @param own  records of contacts of the vertex with the body
/// @returns the one with the nearest normal that no other touch has taken, or null
PairContacts::VertexRecord* PairContacts::nearest(const PairTouch& touch,
                                                  std::span<VertexRecord> own,
                                                  std::span<const ContactRecord> records) {
  VertexRecord* best = nullptr;
  double closest = cosine_45;
  for (VertexRecord& of : own) {
    if (of.is_taken) continue;
    const ContactRecord& record = records[of.record];
    const double cosine = cosine_between(touch, record);
    if (cosine <= closest) continue;
    closest = cosine;
    best = &of;
  }
  return best;
}

/// Whether a vertex has a bond with the body on a part that faces almost the same way: that has the
/// area, be it the nearer part or not.
bool PairContacts::is_left_to_bond(const PairTouch& touch,
                                   std::span<const VertexRecord> own,
                                   std::span<const ContactRecord> records) {
  return std::ranges::any_of(own, [&](const VertexRecord& of) {
    const ContactRecord& record = records[of.record];
    return is_bonded(record) && cosine_between(touch, record) >= cosine_45;
  });
}

/// Lists the records of contacts of vertices.
void PairContacts::list_records(std::span<const ContactRecord> records) {
  vertex_records_.clear();
  for (std::size_t r = 0; r < records.size(); ++r) {
    const ContactKey& key = records[r].key;
    const bool is_second = key.feature_a < 0;  // the vertex
    const VertexRecord own{is_second ? key.feature_b : key.feature_a,
                           is_second ? key.body_a : key.body_b,
                           is_second ? key.feature_a : key.feature_b, r};
    if (own.vertex >= 0 && own.slot < 0) vertex_records_.push_back(own);
  }
  std::ranges::sort(vertex_records_, {}, [](const VertexRecord& own) {
    return std::tuple(own.vertex, own.body, -own.slot);
  });
}

/// A material point of a body, from numbers of vertices among those of all bodies.
MaterialPoint PairContacts::material_of(const std::int32_t* vertex,
                                        const double* weight,
                                        std::int32_t body) const {
  MaterialPoint point;
  const CollisionBody& of = at(scene_.surfaces.bodies, body);
  for (std::size_t k = 0; k < 3 && vertex[k] >= 0 && !of.is_rigid; ++k) {
    point.vertex[k] = vertex[k] - of.first_vertex;
    point.weight[k] = weight[k];
  }
  return point;
}

/// Writes the contact of a touch.
void PairContacts::report(const NamedTouch& named, ReportedContact& contact) const {
  const PairTouch& touch = *named.touch;
  contact = {};
  contact.key = named.key;
  const double sign = named.is_turned ? -1 : 1;
  contact.point_a_world = point_of(touch.point_a);
  contact.point_b_world = point_of(touch.point_b);
  contact.material_a = material_of(touch.vertex_a, touch.weight_a, touch.body_a);
  contact.material_b = material_of(touch.vertex_b, touch.weight_b, touch.body_b);
  if (named.is_turned) {
    std::swap(contact.point_a_world, contact.point_b_world);
    std::swap(contact.material_a, contact.material_b);
  }
  contact.normal = point_of(times(sign, touch.normal));
  contact.area = named.area;
  contact.material = scene_.material_of(touch.body_a, touch.body_b);
  const Vec3 across = minus(touch.way, times(dot(touch.way, touch.normal), touch.normal));
  if (norm(across) > 1e-9 * scene_.surfaces.thickness) {
    contact.tangent = point_of(times(sign, unit(across)));
  }
}

/// Names the touches of a vertex with a body: by the number of the record with the nearest normal,
/// or the next free one.
void PairContacts::name_vertex(std::span<const ChosenTouch> touches,
                               const Group& group,
                               std::span<const ContactRecord> records) {
  const PairTouch& first = touches[group.begin].touch;
  const auto own = std::ranges::equal_range(
      vertex_records_, std::pair(first.a, first.body_b), {},
      [](const VertexRecord& record) { return std::pair(record.vertex, record.body); });
  auto used = own.begin();  // by descending numbers
  std::int32_t free = 0;
  for (std::size_t t = group.begin; t < group.end; ++t) {
    const PairTouch& touch = touches[t].touch;
    double area = is_left_to_bond(touch, own, records) ? 0 : touches[t].area;
    std::int32_t slot = 0;
    if (VertexRecord* const known = nearest(touch, own, records)) {
      known->is_taken = true;
      slot = known->slot;
      // The area of a bonded contact stays the same while the surfaces turn away from each other.
      const ContactRecord& record = records[known->record];
      if (is_bonded(record)) area = std::max(touches[t].area, record.area);
    } else {
      for (--free; used != own.end() && used->slot == free; ++used) --free;
      slot = free;
    }
    named_[t] = named(touch, touch.a, slot, area);
  }
}

std::vector<ReportedContact>& PairContacts::find(std::span<const ChosenTouch> touches,
                                                 const std::vector<Point3>& vertices,
                                                 std::span<const ContactRecord> records) {
  list_records(records);
  list_groups(touches);
  named_.resize(touches.size());
  const auto vertex_count = static_cast<std::int32_t>(scene_.surfaces.vertex_body.size());
  const auto edge_count = static_cast<std::int32_t>(scene_.surfaces.edges.size());
  parallel_for(threads_for(threads_, std::ssize(groups_)), std::ssize(groups_),
               [&](std::int64_t g) {
                 const Group& group = groups_[index_of(g)];
                 const PairTouch& touch = touches[group.begin].touch;
                 if (!touch.is_of_edges()) return name_vertex(touches, group, records);
                 named_[group.begin] = named(touch, touch.a + vertex_count + touch.end * edge_count,
                                             touch.b + vertex_count, 0);
               });
  std::ranges::sort(named_, {}, &NamedTouch::key);
  contacts_.resize(named_.size());
  parallel_for(threads_for(threads_, std::ssize(named_)), std::ssize(named_),
               [this](std::int64_t c) { report(named_[index_of(c)], contacts_[index_of(c)]); });
  patches_.reduce(contacts_, vertices, records);
  return contacts_;
}

}  // namespace tetwarp
