#include "host/simulate/contact/pair_contacts.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/contact/edge_side.hpp"

namespace tetwarp {
namespace {
constexpr std::size_t part_size = 256;              // pairs that one task takes
constexpr double same_gap = 0.1, level_gap = 0.25;  // thicknesses
constexpr double cosine_45 = 0.7071067811865476, cosine_5 = 0.9961946980917455;

bool is_of_edges(const PairTouch& touch) {
  return touch.kind == PairKind::edge_edge;
}

/// Touches of a vertex and a body follow each other: what is near at the start by distance, then
/// what is hit on the way by time. Edges are last.
bool comes_before(const PairTouch& p, const PairTouch& q) {
  const auto order = [](const PairTouch& touch) {
    return std::tuple(is_of_edges(touch), touch.a, touch.body_b, touch.time, touch.distance,
                      touch.kind, touch.b, touch.end);
  };
  return order(p) < order(q);
}

/// Whether the nearest point of a part is on an edge or corner that a nearer part has, too.
bool is_edge_of(const PairTouch& touch, const PairTouch& nearer) {
  if (touch.nearest_b == touch.part_b || touch.part_b[0] < 0) return false;
  return std::all_of(touch.nearest_b.begin(), touch.nearest_b.end(), [&](std::int32_t vertex) {
    return vertex < 0 ||
           std::find(nearer.part_b.begin(), nearer.part_b.end(), vertex) != nearer.part_b.end();
  });
}

ContactKey key_of(std::int32_t body_a,
                  std::int32_t feature_a,
                  std::int32_t body_b,
                  std::int32_t feature_b) {
  return std::tie(body_a, feature_a) <= std::tie(body_b, feature_b)
             ? ContactKey{body_a, feature_a, body_b, feature_b}
             : ContactKey{body_b, feature_b, body_a, feature_a};
}

const ContactRecord* record_of(std::span<const ContactRecord> records, const ContactKey& key) {
  const auto found =
      std::lower_bound(records.begin(), records.end(), key,
                       [](const ContactRecord& a, const ContactKey& of) { return a.key < of; });
  return found != records.end() && found->key == key ? &*found : nullptr;
}
}  // namespace

PairContacts::PairContacts(const SceneSurfaces& scene, int threads)
    : scene_(scene), threads_(threads), areas_(scene.surfaces), patches_(scene, areas_) {}

/// Whether each of two edges is what is nearest of its surface.
bool PairContacts::is_nearest_of_edges(const PairTouch& touch,
                                       const std::vector<Point3>& vertices) const {
  const CollisionSurfaces& surfaces = scene_.surfaces;
  return is_nearest(surfaces, areas_, touch.b, touch.normal, vertices) &&
         is_nearest(surfaces, areas_, touch.a, times(-1, touch.normal), vertices);
}

void PairContacts::choose(std::size_t first, std::size_t end) {
  const double level = level_gap * scene_.surfaces.thickness;
  const bool is_round = at(scene_.surfaces.vertex_radius, touches_[order_[first]].a) > 0;
  kept_.assign(1, order_[first]);
  for (std::size_t i = first + 1; i < end; ++i) {
    const PairTouch& touch = touches_[order_[i]];
    const bool is_new = std::all_of(kept_.begin(), kept_.end(), [&](std::size_t k) {
      const PairTouch& nearer = touches_[k];
      const bool is_as_near = is_round && touch.time == 0 && touch.gap <= nearer.gap + level;
      const double limit = touch.is_inside || is_as_near ? cosine_5 : cosine_45;
      return dot(touch.normal, nearer.normal) < limit && !is_edge_of(touch, nearer);
    });
    if (is_new) kept_.push_back(order_[i]);
  }
}

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
    const double cosine = sign * dot(record.normal_world, touch.normal);
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

void PairContacts::report(const PairTouch& touch,
                          std::int32_t feature_a,
                          std::int32_t feature_b,
                          double area) {
  ReportedContact& contact = contacts_.emplace_back();
  contact.key = key_of(touch.body_a, feature_a, touch.body_b, feature_b);
  const bool is_turned = contact.key.body_a != touch.body_a || contact.key.feature_a != feature_a;
  const double sign = is_turned ? -1 : 1;
  contact.point_a_world = touch.point_a;
  contact.point_b_world = touch.point_b;
  contact.material_a = touch.material_a;
  contact.material_b = touch.material_b;
  if (is_turned) {
    std::swap(contact.point_a_world, contact.point_b_world);
    std::swap(contact.material_a, contact.material_b);
  }
  contact.normal = times(sign, touch.normal);
  contact.area = area;
  contact.material = scene_.material_of(touch.body_a, touch.body_b);
  const Point3 across = minus(touch.way, times(dot(touch.way, touch.normal), touch.normal));
  if (norm(across) > 1e-9 * scene_.surfaces.thickness) contact.tangent = times(sign, unit(across));
}

void PairContacts::report_vertex(std::size_t first,
                                 std::size_t end,
                                 const std::vector<Point3>& vertices,
                                 std::span<const ContactRecord> records) {
  choose(first, end);
  slots_.clear();
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    const PairTouch& touch = touches_[kept_[k]];
    // A part that faces almost as a nearer one takes none of its area.
    const bool has_area = std::none_of(
        kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(k), [&](std::size_t nearer) {
          return dot(touches_[nearer].normal, touch.normal) >= cosine_45;
        });
    double area = 0;
    if (has_area && touch.kind == PairKind::vertex_plane) {
      area = areas_.seen(touch.a, touch.normal, vertices);
    } else if (has_area && touch.kind == PairKind::vertex_face) {
      area =
          areas_.share(touch.body_a, touch.body_b) * areas_.seen(touch.a, touch.normal, vertices);
    }
    slots_.push_back(slot_of(touch, records));
    // A bond keeps its area as the surfaces turn away from each other.
    const ContactRecord* const record =
        record_of(records, key_of(touch.body_a, touch.a, touch.body_b, slots_.back()));
    if (record != nullptr && record->intensity > 0) area = std::max(area, record->area);
    report(touch, touch.a, slots_.back(), area);
  }
}

void PairContacts::add_touches(const TouchingPair& pair,
                               const SurfaceMotion& motion,
                               const SurfaceMotion& first,
                               std::vector<PairTouch>& touches) const {
  const PairTouch touch = touch_of(pair, scene_, motion, first);
  if (const auto ends = end_touches_of(pair, scene_, motion, first)) {
    touches.insert(touches.end(), ends->begin(), ends->end());
    // Between ends that are as near a third contact would change nothing.
    const double nearer = same_gap * scene_.surfaces.thickness;
    if (std::min((*ends)[0].gap, (*ends)[1].gap) <= touch.gap + nearer) return;
  }
  const bool is_hit = pair.time <= 1;
  if (!is_of_edges(touch) ||
      (touch.is_inside && (is_hit || is_nearest_of_edges(touch, motion.start.vertices)))) {
    touches.push_back(touch);
  }
}

const std::vector<ReportedContact>& PairContacts::find(const std::vector<TouchingPair>& pairs,
                                                       std::span<const std::int32_t> pass,
                                                       std::span<const SurfaceMotion> motions,
                                                       std::span<const ContactRecord> records) {
  touches_.clear();
  contacts_.clear();
  if (pairs.empty()) return contacts_;
  parts_.resize((pairs.size() + part_size - 1) / part_size);
  parallel_tasks(threads_, static_cast<std::int64_t>(parts_.size()), [&](std::int64_t part) {
    std::vector<PairTouch>& own = parts_[static_cast<std::size_t>(part)];
    own.clear();
    const std::size_t begin = part_size * static_cast<std::size_t>(part);
    for (std::size_t p = begin; p < std::min(begin + part_size, pairs.size()); ++p) {
      add_touches(pairs[p], motions[static_cast<std::size_t>(pass[p])], motions[0], own);
    }
  });
  for (const std::vector<PairTouch>& own : parts_) {
    touches_.insert(touches_.end(), own.begin(), own.end());
  }
  order_.resize(touches_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(),
            [&](std::size_t i, std::size_t k) { return comes_before(touches_[i], touches_[k]); });
  list_records(records);
  const auto vertex_count = static_cast<std::int32_t>(scene_.surfaces.vertex_body.size());
  const auto edge_count = static_cast<std::int32_t>(scene_.surfaces.edges.size());
  for (std::size_t first = 0; first < order_.size();) {
    const PairTouch& touch = touches_[order_[first]];
    if (is_of_edges(touch)) {
      report(touch, touch.a + vertex_count + touch.end * edge_count, touch.b + vertex_count, 0);
      ++first;
      continue;
    }
    std::size_t end = first + 1;
    while (end < order_.size() && !is_of_edges(touches_[order_[end]]) &&
           touches_[order_[end]].a == touch.a && touches_[order_[end]].body_b == touch.body_b) {
      ++end;
    }
    report_vertex(first, end, motions[0].start.vertices, records);
    first = end;
  }
  patches_.reduce(contacts_, motions[0].start.vertices, records);
  std::sort(contacts_.begin(), contacts_.end(),
            [](const ReportedContact& p, const ReportedContact& q) { return p.key < q.key; });
  return contacts_;
}

std::vector<ReportedContact> contacts_of(const std::vector<TouchingPair>& pairs,
                                         std::span<const std::int32_t> pass,
                                         const SceneSurfaces& scene,
                                         std::span<const SurfaceMotion> motions) {
  PairContacts contacts(scene);
  return contacts.find(pairs, pass, motions);
}

}  // namespace tetwarp
