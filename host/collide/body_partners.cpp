/// @file body_partners.cpp
/// Pairs of bodies whose boxes overlap, as lists by body.
#include "host/collide/body_partners.hpp"

#include <algorithm>

namespace tetwarp {
namespace {
constexpr std::size_t most_bodies = 512;  // more are not compared with each other
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

void BodyPartners::find(const CollideView& scene, std::span<const std::uint8_t> is_still) {
  order_.clear();
  for (std::size_t b = 0; b < has_box.size(); ++b) {
    if (has_box[b] != 0) order_.push_back(static_cast<std::int32_t>(b));
  }
  pairs_.clear();
  if (order_.size() > most_bodies) {
    find_crowd(is_still);
  } else {
    find_overlapping(scene, is_still);
  }
  make_lists();
}

/// Bodies ascend along x, so that only boxes that overlap along x are compared.
void BodyPartners::find_overlapping(const CollideView& scene,
                                    std::span<const std::uint8_t> is_still) {
  const auto box_of = [&](std::int32_t b) -> const Box& {
    return boxes[static_cast<std::size_t>(b)];
  };
  const auto can_meet = [&](std::int32_t a, std::int32_t b) {
    if (!scene.may_touch(std::min(a, b), std::max(a, b))) return false;
    return is_still.empty() || is_still[static_cast<std::size_t>(a)] == 0 ||
           is_still[static_cast<std::size_t>(b)] == 0;
  };
  std::sort(order_.begin(), order_.end(),
            [&](std::int32_t a, std::int32_t b) { return box_of(a).low[0] < box_of(b).low[0]; });
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const std::int32_t a = order_[i];
    if (can_meet(a, a)) pairs_.push_back({a, a});
    for (std::size_t j = i + 1; j < order_.size(); ++j) {
      const std::int32_t b = order_[j];
      if (box_of(b).low[0] > box_of(a).high[0]) break;
      if (!overlap(box_of(a), box_of(b)) || !can_meet(a, b)) continue;
      pairs_.push_back({a, b});
      pairs_.push_back({b, a});
    }
  }
  std::sort(pairs_.begin(), pairs_.end());
}

/// The partner of each body that moves, and of each body whose box overlaps the common box of those
/// that move, is the last box.
void BodyPartners::find_crowd(std::span<const std::uint8_t> is_still) {
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
  const auto last = static_cast<std::int32_t>(boxes.size()) - 1;
  for (const std::int32_t b : order_) {
    const bool is_near = has_movers && overlap(movers, boxes[static_cast<std::size_t>(b)]);
    if (moves(b) || is_near) pairs_.push_back({b, last});
  }
}

void BodyPartners::make_lists() {
  start.assign(boxes.size(), 0);
  bodies.clear();
  for (const auto& [a, b] : pairs_) {
    const Box& own = boxes[static_cast<std::size_t>(a)];
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

}  // namespace tetwarp
