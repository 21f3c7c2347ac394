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
#include "host/collide/self_clearance.hpp"
#include "host/collide/step_touches.hpp"
#include "host/collide/still_bodies.hpp"
#include "host/collide/surface_buffers.hpp"

namespace tetwarp {

/// @tparam Exec  CpuExec or CudaExec
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
        clearance_(surfaces, items_, Exec::reads_are_free && options.skip_clear_bodies),
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
    const bool are_kept =
        std::exchange(has_pairs_, false) && still_.are_none() && pairs_suffice(motion, within);
    if (!are_kept) search(motion, within, 0, {});
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
        search(motion, within, 0, {});
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
      search(motion, within, 0, {});
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
    if (!has_pairs_ || !pairs_suffice(own, distance)) {
      has_pairs_ = false;
      const double found = found_thicknesses * thickness_;
      clearance_.update(own, found, [&](std::int32_t body, double limit) {
        return self_distance(motion, own, body, limit);
      });
      search(own, found, found_fraction, still_.host());
      has_pairs_ = reuses_pairs_;
    }
    features_.find(broad_, motion, own, distance, still_.host(), counts_);
    touches_.find(buffers_.scene(), own, limits, near_at_start, features_.view(), still_.view(),
                  counts_);
    return own;
  }

  /// Whether the pairs of the last search hold all that come within a distance in a motion.
  bool pairs_suffice(const MotionView& motion, double distance) {
    return clearance_.are_clear(motion, distance) &&
           broad_.pairs_suffice(motion, distance, counts_);
  }
  /// As BroadPhase::search().
  void search(const MotionView& motion,
              double distance,
              double fraction,
              std::span<const std::uint8_t> is_still) {
    broad_.search(motion, distance, fraction, clearance_.find(motion, distance), is_still, counts_);
  }
  /// The smallest distance below a limit of two features of a body, at the start of a motion in
  /// memory of the host; the limit if there is none, 0 where it cannot be found.
  /// @param planes  the motion on the host: planes are read
  double self_distance(const SurfaceMotion& planes,
                       const MotionView& motion,
                       std::int32_t body,
                       double limit) {
    MotionView at_start = motion;
    at_start.end = motion.start;
    at_start.plane_end = motion.plane_start;
    at_start.frames = {};
    at_rest_.start.planes = at_rest_.end.planes = planes.start.planes;
    std::vector<CollideBody> alone = items_.bodies;
    for (CollideBody& other : alone) other.touches_itself = 0;
    alone[static_cast<std::size_t>(body)].touches_itself = 1;
    try {
      DetectionCounts uncounted;
      broad_.search(at_start, limit, 0, alone, {}, uncounted);
      features_.find(broad_, at_rest_, at_start, limit, {}, uncounted);
    } catch (const TooManyPairs&) {
      return 0;
    }
    const PairGapOp gaps{buffers_.scene(), at_start, features_.view(), {}};
    double least = limit;
    for (std::int64_t i = 0; i < gaps.pairs.size; ++i) {
      std::int32_t bodies[2];
      bodies_of(gaps.scene, gaps.pairs[i], bodies);
      if (bodies[0] != body || bodies[1] != body) continue;
      least = std::min(least, gaps.gap_of(gaps.pairs[i]).distance);
    }
    return least;
  }

  double thickness_;
  bool reuses_pairs_;
  bool has_pairs_ = false;  ///< broad_ has pairs of the step that later motions may reuse
  CollideItems items_;
  SurfaceBuffers<Exec> buffers_;
  MotionBuffers<Exec> motions_;
  StillBodies<Exec> still_;
  SelfClearance clearance_;
  BroadPhase<Exec> broad_;
  FeaturePairs<Exec> features_;
  FeatureTouches<Exec> touches_;
  FeatureGaps<Exec> gaps_;
  StepTouches<Exec> step_;
  DetectionCounts counts_;
  SurfaceMotion at_rest_;  ///< of closest(): planes only; memory is kept
};

}  // namespace tetwarp
