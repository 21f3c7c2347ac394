/// @file item_box.hpp
/// Stage "item_box" of collision detection: boxes of items and their classes of size; items far
/// from all partners of their body are skipped.
#pragma once
#include <cstdint>

#include "kernels/collide/collide_item.hpp"

namespace tetwarp {

constexpr int item_sizes = 48;  ///< classes of size, each half as large as the one before
constexpr std::int8_t skipped_item = -1;

/// One index = one item. An item is skipped if its box overlaps the box of no body that its own
/// body may touch.
struct ItemBoxOp {
  CollideView scene;
  View<const Box> vertex_boxes;
  View<const Box> body_boxes;
  View<const std::int32_t> partner_start;  ///< [bodies + 1]
  View<const std::int32_t> partners;       ///< bodies that each body may touch
  std::int32_t largest;                    ///< binary exponent of the extent of the largest box
  View<Box> boxes;                         ///< out
  View<std::int8_t> sizes;                 ///< out: 0 the largest to item_sizes - 1; skipped_item

  TETWARP_HD void operator()(std::int64_t i) const {
    const CollideItem& item = scene.items[i];
    const std::int32_t first = partner_start[item.body], past = partner_start[item.body + 1];
    if (first == past) {
      sizes[i] = skipped_item;
      return;
    }
    Box box = vertex_boxes[item.vertex[0]];
    for (int k = 1; k < item.count; ++k) add_box(box, vertex_boxes[item.vertex[k]]);
    boxes[i] = box;
    bool is_near = false;
    for (std::int32_t k = first; k < past && !is_near; ++k) {
      is_near = overlap(box, body_boxes[partners[k]]);
    }
    sizes[i] = is_near ? size_of(box) : skipped_item;
  }

  TETWARP_HD std::int8_t size_of(const Box& box) const {
    double extent = 0;
    for (int k = 0; k < 3; ++k) extent = max_of(extent, box.high[k] - box.low[k]);
    const int smaller = largest - ilogb(extent);
    return static_cast<std::int8_t>(max_of(0, min_of(smaller, item_sizes - 1)));
  }
};

constexpr std::int64_t size_run = 1024;  ///< items that one index of SizeCountOp counts

/// One index = size_run items. Counts them by size.
struct SizeCountOp {
  View<const std::int8_t> sizes;
  View<std::int32_t> counts;  ///< out [runs][item_sizes]

  TETWARP_HD void operator()(std::int64_t run) const {
    const View<std::int32_t> own = {counts.data + run * item_sizes, item_sizes};
    for (int s = 0; s < item_sizes; ++s) own[s] = 0;
    const std::int64_t end = min_of(sizes.size, (run + 1) * size_run);
    for (std::int64_t i = run * size_run; i < end; ++i) {
      if (sizes[i] != skipped_item) ++own[sizes[i]];
    }
  }
};

/// One index = one size. Sums its counts of all runs.
struct SizeSumOp {
  View<const std::int32_t> counts;  ///< [runs][item_sizes]
  View<std::int32_t> sums;          ///< out [item_sizes]

  TETWARP_HD void operator()(std::int64_t size) const {
    std::int32_t sum = 0;
    for (std::int64_t k = size; k < counts.size; k += item_sizes) sum += counts[k];
    sums[size] = sum;
  }
};

}  // namespace tetwarp
