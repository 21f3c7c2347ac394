/// @file detector_pipeline.hpp
/// DetectorPipeline: the stages of collision detection, on an executor. Start at find_pairs(),
/// which calls them in order.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "host/collide/broad_phase.hpp"
#include "host/collide/collide_items.hpp"
#include "host/collide/detector.hpp"
#include "host/collide/feature_gaps.hpp"
#include "host/collide/feature_pairs.hpp"
#include "host/collide/feature_touches.hpp"
#include "host/collide/motion_buffers.hpp"
#include "host/collide/step_touches.hpp"
#include "host/collide/still_bodies.hpp"
#include "host/collide/surface_buffers.hpp"

namespace tetwarp {

/// @tparam Exec  CpuDetectExec or CudaDetectExec
template <class Exec>
class DetectorPipeline {
 public:
  /// @param surfaces  kept by the caller
  DetectorPipeline(Exec& exec, const CollisionSurfaces& surfaces, const DetectorOptions& options)
      : thickness_(surfaces.thickness),
        reuses_pairs_(options.reuse_pairs),
        items_(make_collide_items(surfaces, options.skip_flat_edges)),
        buffers_(exec, surfaces, items_),
        motions_(exec, surfaces),
        still_(exec),
        broad_(exec, buffers_, items_),
        features_(exec, surfaces, buffers_, items_),
        touches_(exec),
        gaps_(exec),
        step_(exec, surfaces) {}

  void begin_step() {
    has_pairs_ = false;
    step_.begin_step();
  }
  void set_still(std::span<const std::uint8_t> is_still) {
    still_.set(is_still);
    has_pairs_ = false;
  }

  const std::vector<TouchingPair>& detect(const SurfaceMotion& motion) {
    find_pairs(motion, detection_limits(thickness_), 2 * thickness_);
    return touches_.sorted();
  }
  const std::vector<TouchingPair>& check(const SurfaceMotion& motion) {
    find_pairs(motion, end_check_limits(thickness_), nowhere);
    return touches_.sorted();
  }
  const std::vector<TouchingPair>& detect_hits(const SurfaceMotion& motion) {
    find_pairs(motion, detection_limits(thickness_), nowhere);
    return touches_.sorted();
  }
  std::int64_t find_touches(const SurfaceMotion& motion) {
    const MotionView own = find_pairs(motion, detection_limits(thickness_),
                                      step_.has_begun() ? nowhere : 2 * thickness_);
    still_.find_reached(buffers_.scene(), touches_.view());
    return step_.add(buffers_.scene(), own, touches_.view());
  }
  const std::vector<std::int32_t>& reached() const { return still_.reached(); }
  std::span<const ChosenTouch> touches() { return step_.choose(); }

  /// Searches within twice the thickness first: where surfaces touch, few of many near pairs are
  /// then compared. Pairs that the step has found are kept where they suffice. Where the cap has
  /// many pairs of items, distances between both are tried; where one has too many, the cap is the
  /// one before.
  ClosestPair closest(const SurfacePlaces& places, double cap, const MotionView& resident) {
    if (!std::isfinite(cap)) {
      throw std::invalid_argument("collision detection: the cap is not finite");
    }
    const MotionView motion = motions_.view_of(places, resident);
    at_rest_.start.planes = at_rest_.end.planes = places.planes;
    double within = std::min(cap, 2 * thickness_), searched = 0;
    const bool are_kept = std::exchange(has_pairs_, false) && still_.are_none() &&
                          broad_.pairs_suffice(motion, within, counts_);
    if (!are_kept) broad_.search(motion, within, 0, {}, counts_);
    try {
      while (within > searched) {
        const PairGap gap = nearest_within(motion, within);
        if (gap.distance < within) {
          return {gap.pair.kind, gap.pair.a, gap.pair.b, gap.distance};
        }
        searched = within;
        within = cap;
        if (within == searched || finds_few_pairs(motion, cap)) continue;
        within = std::min(cap, 4 * searched);
        broad_.search(motion, within, 0, {}, counts_);
      }
    } catch (const TooManyPairs&) {
      if (searched == 0) throw;
    }
    return {.distance = searched};
  }

  DetectionCounts take_counts() { return std::exchange(counts_, {}); }

 private:
  static constexpr double nowhere = -1;          ///< no pair counts as near at the start
  static constexpr std::int64_t few_pairs = 16;  ///< per item

  /// Searches pairs of items at rest. @returns whether these are so few that all are compared
  bool finds_few_pairs(const MotionView& motion, double within) {
    try {
      broad_.search(motion, within, 0, {}, counts_);
    } catch (const TooManyPairs&) {
      return false;
    }
    return broad_.pairs().size <= few_pairs * broad_.item_count();
  }
  /// The nearest pair of features at rest, of the pairs of items of the last search.
  /// @returns a distance of `within` where there is none below
  PairGap nearest_within(const MotionView& motion, double within) {
    features_.find(broad_, at_rest_, motion, within, {}, counts_);
    const View<const FeaturePair> pairs = features_.view();
    if (pairs.size == 0) return {{}, within};
    counts_.evaluations += pairs.size;
    return gaps_.nearest(buffers_.scene(), motion, pairs);
  }

  /// All stages of a detection, in order: boxes, pairs of items, pairs of features, touches.
  /// @param near_at_start  pairs within this distance at the start are found, too [m]
  /// @returns the motion as stages read it
  MotionView find_pairs(const SurfaceMotion& motion,
                        const CcdLimits& limits,
                        double near_at_start) {
    const MotionView own = motions_.view_of(motion);
    const double distance = std::max(near_at_start, limits.distance + limits.slack);
    if (!has_pairs_ || !broad_.pairs_suffice(own, distance, counts_)) {
      has_pairs_ = false;
      broad_.search(own, found_thicknesses * thickness_, found_fraction, still_.host(), counts_);
      has_pairs_ = reuses_pairs_;
    }
    features_.find(broad_, motion, own, distance, still_.host(), counts_);
    touches_.find(buffers_.scene(), own, limits, near_at_start, features_.view(), still_.view(),
                  counts_);
    return own;
  }

  double thickness_;
  bool reuses_pairs_;
  bool has_pairs_ = false;  ///< broad_ has pairs of the step that later motions may reuse
  CollideItems items_;
  SurfaceBuffers<Exec> buffers_;
  MotionBuffers<Exec> motions_;
  StillBodies<Exec> still_;
  BroadPhase<Exec> broad_;
  FeaturePairs<Exec> features_;
  FeatureTouches<Exec> touches_;
  FeatureGaps<Exec> gaps_;
  StepTouches<Exec> step_;
  DetectionCounts counts_;
  SurfaceMotion at_rest_;  ///< of closest(): planes only; memory is kept
};

}  // namespace tetwarp
