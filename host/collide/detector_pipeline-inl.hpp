/// @file detector_pipeline-inl.hpp
/// Member functions of DetectorPipeline.
#pragma once
#include "host/collide/detector_pipeline.hpp"

namespace tetwarp {

template <class Exec>
bool DetectorPipeline<Exec>::make_boxes(double distance,
                                        bool finds,
                                        double found_distance,
                                        double fraction) {
  const std::vector<std::int64_t>& levels = items_.levels;
  exec_.for_each("collide/vertex_box", levels[1],
                 VertexBoxBody{view(memory_.runs), motion_, view(memory_.vertex_radius),
                               distance / 2, found_distance / 2, fraction, finds ? 1 : 0,
                               exec_.view(found_), exec_.view(run_boxes_)});
  for (std::size_t k = 1; k + 1 < levels.size(); ++k) {
    exec_.for_each("collide/vertex_box", levels[k + 1] - levels[k],
                   BoxUniteBody{view(memory_.runs), levels[k], exec_.view(run_boxes_)});
  }
  const std::int64_t last = levels[levels.size() - 2];
  const View<const RunBox> boxes = exec_.on_host(
      View<const RunBox>{view(run_boxes_).data + last, levels.back() - last}, host_run_boxes_);
  for (std::int64_t r = 0; r < boxes.size && !finds; ++r) {
    if (boxes[r].leaves != 0) return false;
  }
  partners_.set_boxes(items_, boxes);
  return true;
}

/// Pairs of items whose boxes of the search overlap.
template <class Exec>
void DetectorPipeline<Exec>::find_item_pairs(std::span<const std::uint8_t> is_still) {
  counts_.skipped_edges += items_.flat_edges;
  partners_.find_bodies(items_, is_still);
  entries_.clear();
  pairs_.clear();
  if (!partners_.has_pairs) {
    counts_.skipped_items += size_of(items_.items);
    return;
  }
  const Box& space = partners_.boxes.back();
  double extent = 0;
  for (int k = 0; k < 3; ++k) extent = std::max(extent, space.high[k] - space.low[k]);
  const int largest = std::ilogb(extent);
  const auto items = size_of(items_.items);
  exec_.put(partners_.boxes.data(), size_of(partners_.boxes), body_boxes_);
  exec_.put(partners_.start.data(), size_of(partners_.start), partner_start_);
  exec_.put(partners_.bodies.data(), size_of(partners_.bodies), partner_bodies_);
  exec_.for_each("collide/item_box", items,
                 ItemBoxBody{scene(), view(found_), view(body_boxes_), view(partner_start_),
                             view(partner_bodies_), largest, exec_.view(item_boxes_),
                             exec_.view(item_sizes_)});
  exec_.for_each("collide/item_box", (items + size_run - 1) / size_run,
                 SizeCountBody{view(item_sizes_), exec_.view(size_counts_)});
  exec_.for_each("collide/item_box", item_sizes,
                 SizeSumBody{view(size_counts_), exec_.view(size_sums_)});
  const View<const std::int32_t> counted = exec_.on_host(view(size_sums_), host_size_sums_);
  std::array<std::int64_t, item_sizes> counts{};
  std::copy_n(counted.data, item_sizes, counts.begin());
  const std::int64_t kept = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  counts_.skipped_items += items - kept;
  if (kept == 0) return;
  host_plan_ = make_grid_plan(counts, largest, space);
  const GridPlan* const plan = exec_.input(&host_plan_, 1, plan_).data;
  exec_.append("collide/item_cells", items,
               ItemCellsBody{plan, view(item_boxes_), view(item_sizes_)}, entries_);
  exec_.sort_pairs("collide/sort", entries_, host_plan_.key_bits);
  exec_.append("collide/entry_pairs", entries_.size(),
               EntryPairsBody{scene(), plan, entries_.view(), view(item_boxes_), view(item_sizes_)},
               pairs_, most_pairs(items));
  counts_.grid_entries += entries_.size();
  counts_.box_tests += pairs_.tally();
  counts_.box_pairs += pairs_.size();
}

/// Pairs of features of the motion, from the pairs of items and from planes.
template <class Exec>
void DetectorPipeline<Exec>::find_features(const SurfaceMotion& motion,
                                           double distance,
                                           std::span<const std::uint8_t> is_still) {
  partners_.find_planes(surfaces_, items_, motion, distance, is_still);
  exec_.put(partners_.plane_start.data(), size_of(partners_.plane_start), near_start_);
  exec_.put(partners_.planes.data(), size_of(partners_.planes), near_planes_);
  const std::int64_t vertices = partners_.has_planes ? size_of(surfaces_.vertex_body) : 0;
  exec_.append("collide/pair_features", pairs_.size() + vertices,
               PairFeaturesBody{scene(), pairs_.view(), motion_, distance,
                                PlaneView{view(near_start_), view(near_planes_)}},
               features_, 8 * most_pairs(size_of(items_.items)));
  counts_.pairs += features_.size();
}

template <class Exec>
void DetectorPipeline<Exec>::set_motion(const SurfaceMotion& motion) {
  check_sizes(motion.start);
  check_sizes(motion.end);
  if (!motion.frames.empty() && motion.frames.size() != surfaces_.bodies.size()) {
    throw std::invalid_argument("collision detection: frames of " +
                                std::to_string(motion.frames.size()) + " bodies, expected " +
                                std::to_string(surfaces_.bodies.size()));
  }
  if (is_given(motion.resident)) {
    motion_ = motion.resident;
    return;
  }
  motion_ = {points(motion.start.vertices, start_),
             points(motion.end.vertices, end_),
             exec_.input(motion.sagitta.data(), size_of(motion.sagitta), sagitta_),
             plane_numbers(motion.start.planes, plane_start_),
             plane_numbers(motion.end.planes, plane_end_),
             exec_.input(motion.frames.data(), size_of(motion.frames), frames_)};
}

template <class Exec>
void DetectorPipeline<Exec>::find_pairs(const SurfaceMotion& motion,
                                        const CcdLimits& limits,
                                        double near_at_start) {
  set_motion(motion);
  const double distance = std::max(near_at_start, limits.distance + limits.slack);
  const bool was_found = reuses_pairs_ && has_pairs_;
  if (was_found && make_boxes(distance, false, 0, 0)) {
    ++counts_.reused;
  } else {
    has_pairs_ = false;
    make_boxes(distance, true, found_thicknesses * surfaces_.thickness, found_fraction);
    find_item_pairs(is_still_);
    has_pairs_ = true;
  }
  find_features(motion, distance, is_still_);
  exec_.resize(results_, features_.size());
  exec_.for_each("collide/pair_touch", features_.size(),
                 PairTouchBody{scene(), motion_, limits, features_.view(), exec_.view(results_)});
  exec_.append("collide/pair_touch", features_.size(),
               TouchFilterBody{scene(), view(still_bodies_), features_.view(), view(results_),
                               near_at_start},
               touches_);
  counts_.evaluations += touches_.tally();
}

template <class Exec>
const std::vector<TouchingPair>& DetectorPipeline<Exec>::touching(const SurfaceMotion& motion,
                                                                  const CcdLimits& limits,
                                                                  double near_at_start) {
  find_pairs(motion, limits, near_at_start);
  const View<const FeatureTouch> touches = exec_.on_host(touches_.view(), host_touches_);
  touching_.clear();
  for (std::int64_t k = 0; k < touches.size; ++k) {
    const FeatureTouch& touch = touches[k];
    touching_.push_back(
        {touch.pair.kind, touch.pair.a, touch.pair.b, touch.time, touch.start_distance});
  }
  std::sort(touching_.begin(), touching_.end());
  return touching_;
}

template <class Exec>
std::int64_t DetectorPipeline<Exec>::find_touches(const SurfaceMotion& motion) {
  const double h = surfaces_.thickness;
  find_pairs(motion, detection_limits(h), step_.has_begun() ? -1 : 2 * h);
  reached_.clear();
  if (!is_still_.empty()) {
    exec_.append("collide/touches", touches_.size(),
                 ReachedBody{scene(), view(still_bodies_), touches_.view()}, reached_list_);
    const View<const std::int32_t> found = exec_.on_host(reached_list_.view(), host_reached_);
    reached_.assign(found.data, found.data + found.size);
    std::ranges::sort(reached_);
    reached_.erase(std::ranges::unique(reached_).begin(), reached_.end());
  }
  return step_.add(scene(), motion_, touches_);
}

template <class Exec>
PairGap DetectorPipeline<Exec>::nearest_of_features() {
  const std::int64_t runs = (features_.size() + gap_run - 1) / gap_run;
  exec_.resize(gaps_, runs);
  exec_.for_each("collide/pair_gap", runs,
                 PairGapBody{scene(), motion_, features_.view(), exec_.view(gaps_)});
  counts_.evaluations += features_.size();
  const View<const PairGap> gaps = exec_.on_host(view(gaps_), host_gaps_);
  PairGap nearest = gaps[0];
  for (std::int64_t r = 1; r < gaps.size; ++r) {
    if (is_nearer(gaps[r], nearest)) nearest = gaps[r];
  }
  return nearest;
}

/// Searches within small distances first: of many near pairs few are then compared. Pairs that the
/// step has found are kept where they suffice.
template <class Exec>
ClosestPair DetectorPipeline<Exec>::closest(const SurfacePlaces& places,
                                            double cap,
                                            const MotionView& resident) {
  check_sizes(places);
  if (!std::isfinite(cap))
    throw std::invalid_argument("collision detection: the cap is not finite");
  const bool were_found = reuses_pairs_ && has_pairs_ && is_still_.empty();
  has_pairs_ = false;
  if (is_given(resident)) {
    motion_ = resident;
  } else {
    const View<const double> vertices = points(places.vertices, start_);
    const View<const double> planes = plane_numbers(places.planes, plane_start_);
    motion_ = {vertices, vertices, view(memory_.no_sagitta), planes, planes, {}};
  }
  still_.start.planes = still_.end.planes = places.planes;
  ClosestPair closest;
  closest.distance = cap;
  bool suffice = were_found;
  for (double within = std::min(cap, 2 * surfaces_.thickness); within > 0;
       within = std::min(cap, 4 * within)) {
    suffice = suffice && make_boxes(within, false, 0, 0);
    if (suffice) {
      ++counts_.reused;
    } else {
      make_boxes(within, true, within, 0);
      find_item_pairs({});
    }
    find_features(still_, within, {});
    if (features_.size() > 0) {
      const PairGap gap = nearest_of_features();
      if (gap.distance < within) {
        return {gap.pair.kind, gap.pair.a, gap.pair.b, gap.distance};
      }
    }
    if (within >= cap) break;
  }
  return closest;
}

}  // namespace tetwarp
