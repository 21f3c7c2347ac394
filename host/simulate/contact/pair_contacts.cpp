#include "host/simulate/contact/pair_contacts.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/contact/find_record.hpp"

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

}  // namespace

PairContacts::PairContacts(const SceneSurfaces& scene, int threads)
    : scene_(scene), threads_(threads), areas_(scene.surfaces), patches_(scene, areas_) {}

std::int32_t PairContacts::slot_of(const PairTouch& touch,
                                   std::span<const ContactRecord> records) const {
  constexpr std::int32_t last = -64;
  const auto own = std::ranges::equal_range(
      vertex_records_, std::pair(touch.a, touch.body_b), {},
      [](const VertexRecord& record) { return std::pair(record.vertex, record.body); });
  const auto is_taken = [&](std::int32_t slot) {
    return std::find(slots_.begin(), slots_.end(), slot) != slots_.end();
  };
  std::int32_t best = 0;
  double closest = cosine_45;
  for (const VertexRecord& of : own) {
    if (is_taken(of.slot)) continue;
    const ContactRecord& record = records[of.record];
    if (record.normal_world == Point3{0, 0, 0}) return of.slot;
    const double sign = record.key.feature_a == touch.a ? 1 : -1;
    const double cosine = sign * dot(record.normal_world, point_of(touch.normal));
    if (cosine <= closest) continue;
    closest = cosine;
    best = of.slot;
  }
  if (best != 0) return best;
  const auto has_record = [&](std::int32_t slot) {
    return std::ranges::find(own, slot, &VertexRecord::slot) != own.end();
  };
  std::int32_t free = -1;
  while (free > last && (is_taken(free) || has_record(free))) --free;
  return free;
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
    if (own.vertex >= 0 && own.slot < 0 && own.slot > RigidPatches::first_feature) {
      vertex_records_.push_back(own);
    }
  }
  std::ranges::sort(vertex_records_, {}, [](const VertexRecord& own) {
    return std::tuple(own.vertex, own.body, -own.slot);
  });
}

/// A point of a body from vertices of all bodies.
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

/// The contact of a touch.
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

void PairContacts::name(const PairTouch& touch,
                        std::int32_t feature_a,
                        std::int32_t feature_b,
                        double area) {
  const ContactKey key = key_of(touch.body_a, feature_a, touch.body_b, feature_b);
  const bool is_turned = key.body_a != touch.body_a || key.feature_a != feature_a;
  named_.push_back({key, &touch, area, is_turned});
}

/// Names the touches of a vertex and a body.
void PairContacts::name_vertex(std::span<const ChosenTouch> touches,
                               std::span<const ContactRecord> records) {
  slots_.clear();
  for (const ChosenTouch& chosen : touches) {
    const PairTouch& touch = chosen.touch;
    slots_.push_back(slot_of(touch, records));
    // A bond keeps its area as the surfaces turn away from each other.
    const ContactRecord* const record =
        find_record(records, key_of(touch.body_a, touch.a, touch.body_b, slots_.back()));
    const bool is_bonded = record != nullptr && record->intensity > 0;
    name(touch, touch.a, slots_.back(),
         is_bonded ? std::max(chosen.area, record->area) : chosen.area);
  }
}

std::vector<ReportedContact>& PairContacts::find(std::span<const ChosenTouch> touches,
                                                 const std::vector<Point3>& vertices,
                                                 std::span<const ContactRecord> records) {
  named_.clear();
  list_records(records);
  const auto vertex_count = static_cast<std::int32_t>(scene_.surfaces.vertex_body.size());
  const auto edge_count = static_cast<std::int32_t>(scene_.surfaces.edges.size());
  for (std::size_t first = 0; first < touches.size();) {
    const PairTouch& touch = touches[first].touch;
    std::size_t end = first + 1;
    if (touch.is_of_edges()) {
      name(touch, touch.a + vertex_count + touch.end * edge_count, touch.b + vertex_count, 0);
    } else {
      while (end < touches.size() && !touches[end].touch.is_of_edges() &&
             touches[end].touch.a == touch.a && touches[end].touch.body_b == touch.body_b) {
        ++end;
      }
      name_vertex(touches.subspan(first, end - first), records);
    }
    first = end;
  }
  std::ranges::sort(named_, {}, &NamedTouch::key);
  contacts_.resize(named_.size());
  parallel_for(threads_, static_cast<std::int64_t>(named_.size()),
               [this](std::int64_t c) { report(named_[index_of(c)], contacts_[index_of(c)]); });
  patches_.reduce(contacts_, vertices, records);
  return contacts_;
}

}  // namespace tetwarp
