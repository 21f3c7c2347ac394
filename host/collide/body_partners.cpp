#include "host/collide/body_partners.hpp"

#include <algorithm>
#include <cmath>

namespace tetwarp {
namespace {
constexpr std::size_t most_bodies = 512;  // more are not compared with each other

CollideView view_of_bodies(const CollideItems& items) {
  CollideView view{};
  view.bodies = {items.bodies.data(), static_cast<std::int64_t>(items.bodies.size())};
  view.forbidden = {items.forbidden.data(), static_cast<std::int64_t>(items.forbidden.size())};
  return view;
}

/// Planes that turn about other points than their own are all taken as near.
bool follows_frame(const SurfaceMotion& motion, std::int32_t body) {
  if (motion.frames.empty()) return false;
  const double* const turn = motion.frames[static_cast<std::size_t>(body)].turn;
  return turn[0] != 0 || turn[1] != 0 || turn[2] != 0;
}

/// Whether the plane may reach within `distance` of the box: the least height of a corner above it.
bool is_near(const Box& box, const PlanePlace& start, const PlanePlace& end, double distance) {
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max({size, std::abs(box.low[k]), std::abs(box.high[k])});
  for (const PlanePlace* normal : {&start, &end}) {
    for (const PlanePlace* place : {&start, &end}) {
      double height = 0, far = size;
      for (std::size_t k = 0; k < 3; ++k) {
        const double n = normal->normal[k];
        height += n * ((n > 0 ? box.low[k] : box.high[k]) - place->point[k]);
        far = std::max(far, std::abs(place->point[k]));
      }
      if (height - 0x1p-46 * far <= distance) return true;
    }
  }
  return false;
}
}  // namespace

void BodyPartners::set_boxes(const CollideItems& items, const View<const RunBox>& of_bodies) {
  boxes.resize(items.bodies.size() + 1);
  has_box.assign(items.bodies.size(), 0);
  const std::size_t first = items.runs.size() - static_cast<std::size_t>(of_bodies.size);
  for (std::size_t r = first; r < items.runs.size(); ++r) {
    const auto b = static_cast<std::size_t>(items.runs[r].body);
    boxes[b] = of_bodies[static_cast<std::int64_t>(r - first)].box;
    has_box[b] = 1;
  }
}

/// Of very many bodies: the space of all is the partner of those that move and of those that reach
/// one that moves.
void BodyPartners::find_crowd(std::int32_t count, std::span<const std::uint8_t> is_still) {
  const auto moves = [&](std::int32_t b) {
    return is_still.empty() || is_still[static_cast<std::size_t>(b)] == 0;
  };
  bool has_movers = false;
  Box movers{};
  for (const std::int32_t b : order_) {
    if (!moves(b)) continue;
    const Box& box = boxes[static_cast<std::size_t>(b)];
    if (has_movers) {
      add_box(movers, box);
    } else {
      movers = box;
    }
    has_movers = true;
  }
  for (const std::int32_t b : order_) {
    const bool is_near = has_movers && overlap(movers, boxes[static_cast<std::size_t>(b)]);
    if (moves(b) || is_near) pairs_.push_back({b, count});
  }
}

void BodyPartners::find_bodies(const CollideItems& items, std::span<const std::uint8_t> is_still) {
  const CollideView scene = view_of_bodies(items);
  const auto count = static_cast<std::int32_t>(items.bodies.size());
  const auto box_of = [&](std::int32_t b) -> const Box& {
    return boxes[static_cast<std::size_t>(b)];
  };
  const auto rest = [&](std::int32_t a, std::int32_t b) {
    return !is_still.empty() && is_still[static_cast<std::size_t>(a)] != 0 &&
           is_still[static_cast<std::size_t>(b)] != 0;
  };
  order_.clear();
  for (std::int32_t b = 0; b < count; ++b) {
    if (has_box[static_cast<std::size_t>(b)] != 0) order_.push_back(b);
  }
  pairs_.clear();
  if (order_.size() > most_bodies) {
    find_crowd(count, is_still);
  } else {
    std::sort(order_.begin(), order_.end(),
              [&](std::int32_t a, std::int32_t b) { return box_of(a).low[0] < box_of(b).low[0]; });
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const std::int32_t a = order_[i];
      if (scene.may_touch(a, a) && !rest(a, a)) pairs_.push_back({a, a});
      for (std::size_t j = i + 1; j < order_.size(); ++j) {
        const std::int32_t b = order_[j];
        if (box_of(b).low[0] > box_of(a).high[0]) break;
        if (!overlap(box_of(a), box_of(b))) continue;
        if (!scene.may_touch(std::min(a, b), std::max(a, b)) || rest(a, b)) continue;
        pairs_.push_back({a, b});
        pairs_.push_back({b, a});
      }
    }
    std::sort(pairs_.begin(), pairs_.end());
  }
  start.assign(items.bodies.size() + 1, 0);
  bodies.clear();
  for (const auto& [a, b] : pairs_) {
    const Box& own = box_of(a);
    if (bodies.empty()) {
      boxes.back() = own;
    } else {
      add_box(boxes.back(), own);
    }
    ++start[static_cast<std::size_t>(a) + 1];
    bodies.push_back(b);
  }
  for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
  has_pairs = !bodies.empty();
}

void BodyPartners::find_planes(const CollisionSurfaces& surfaces,
                               const CollideItems& items,
                               const SurfaceMotion& motion,
                               double distance,
                               std::span<const std::uint8_t> is_still) {
  const CollideView scene = view_of_bodies(items);
  plane_start.assign(items.bodies.size() + 1, 0);
  planes.clear();
  for (std::size_t b = 0; b < items.bodies.size(); ++b) {
    for (std::size_t p = 0; p < surfaces.plane_body.size() && has_box[b] != 0; ++p) {
      const auto own = static_cast<std::int32_t>(b);
      const std::int32_t other = surfaces.plane_body[p];
      if (!is_still.empty() && is_still[b] != 0 && is_still[static_cast<std::size_t>(other)] != 0) {
        continue;
      }
      if (own == other || !scene.may_touch(std::min(own, other), std::max(own, other))) continue;
      if (follows_frame(motion, other) ||
          is_near(boxes[b], motion.start.planes[p], motion.end.planes[p], distance)) {
        planes.push_back(static_cast<std::int32_t>(p));
      }
    }
    plane_start[b + 1] = static_cast<std::int32_t>(planes.size());
  }
  has_planes = !planes.empty();
}

}  // namespace tetwarp
