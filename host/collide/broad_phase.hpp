/// @file broad_phase.hpp
/// BroadPhase: the pairs of items whose boxes overlap during a motion.
#pragma once
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "host/collide/body_partners.hpp"
#include "host/collide/detector.hpp"
#include "host/collide/grid_plan.hpp"
#include "host/collide/item_boxes.hpp"
#include "host/collide/motion_boxes.hpp"
#include "kernels/base/pair_limit.hpp"
#include "kernels/collide/entry_pairs.hpp"

namespace tetwarp {

/// Boxes of a search can have a margin, so that its pairs suffice for later motions that differ
/// little.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class BroadPhase {
 public:
  /// @param surfaces, items  kept by the caller
  BroadPhase(Exec& exec, const SurfaceBuffers<Exec>& surfaces, const CollideItems& items)
      : exec_(exec),
        surfaces_(surfaces),
        items_(items),
        boxes_(exec, surfaces, items),
        item_boxes_(exec, surfaces) {}

  /// Whether the pairs of the last search hold all that come within a distance in this motion: its
  /// boxes lie within those of the search. Sets the boxes of partners() if so.
  /// @param distance  [m]
  bool pairs_suffice(const MotionView& motion, double distance, DetectionCounts& counts) {
    const View<const RunBox> bodies = boxes_.compare(motion, distance);
    for (std::int64_t r = 0; r < bodies.size; ++r) {
      if (bodies[r].leaves != 0) return false;
    }
    partners_.set_boxes(items_, bodies);
    ++counts.reused;
    return true;
  }

  /// Searches pairs.
  /// @param distance, fraction  as of MotionBoxes::find()
  /// @param bodies              as CollideItems::bodies; touches_itself may differ where the host
  ///                            may read what stages read
  /// @param is_still            as of BodyPartners::find()
  void search(const MotionView& motion,
              double distance,
              double fraction,
              const std::vector<CollideBody>& bodies,
              std::span<const std::uint8_t> is_still,
              DetectionCounts& counts) {
    partners_.set_boxes(items_, boxes_.find(motion, distance, fraction));
    counts.skipped_edges += items_.flat_edges;
    CollideView on_host = items_.view_of_bodies();
    on_host.bodies = {bodies.data(), std::ssize(bodies)};
    partners_.find(on_host, is_still);
    entries_.clear();
    pairs_.clear();
    if (!partners_.has_pairs) {
      counts.skipped_items += item_boxes_.count();
      return;
    }
    item_boxes_.find(partners_, boxes_.of_vertices());
    const auto sizes = item_boxes_.count_sizes();
    const std::int64_t kept = std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0});
    counts.skipped_items += item_boxes_.count() - kept;
    if (kept == 0) return;
    host_plan_ = make_grid_plan(sizes, item_boxes_.largest(), partners_.boxes.back());
    compare_in_grid(bodies);
    counts.grid_entries += entries_.size();
    counts.box_tests += pairs_.tally();
    counts.box_pairs += pairs_.size();
  }

  View<const ItemPair> pairs() const { return pairs_.view(); }
  std::int64_t item_count() const { return item_boxes_.count(); }
  const BodyPartners& partners() const { return partners_; }

 private:
  template <class T>
  using List = typename Exec::template List<T>;

  void compare_in_grid(const std::vector<CollideBody>& bodies) {
    CollideView scene = surfaces_.scene();
    if constexpr (Exec::reads_are_free) scene.bodies = {bodies.data(), std::ssize(bodies)};
    const GridPlan* const plan = exec_.input(&host_plan_, 1, plan_).data;
    const View<const Box> boxes = item_boxes_.boxes();
    const View<const std::int8_t> sizes = item_boxes_.sizes();
    exec_.append("collide/item_cells", item_count(), ItemCellsOp{plan, boxes, sizes}, entries_);
    exec_.sort_pairs("collide/sort", entries_, host_plan_.key_bits);
    exec_.append("collide/entry_pairs", entries_.size(),
                 EntryPairsOp{scene, plan, entries_.view(), boxes, sizes}, pairs_,
                 most_pairs(item_count()));
  }

  Exec& exec_;
  const SurfaceBuffers<Exec>& surfaces_;
  const CollideItems& items_;
  MotionBoxes<Exec> boxes_;
  BodyPartners partners_;
  ItemBoxes<Exec> item_boxes_;
  GridPlan host_plan_{};
  typename Exec::template Vector<GridPlan> plan_;
  List<KeyValue> entries_;  ///< items in cells of the grids
  List<ItemPair> pairs_;
};

}  // namespace tetwarp
