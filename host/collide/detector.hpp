/// @file detector.hpp
/// Detector: the pairs of vertices, edges, faces and planes that touch during a motion.
///
/// No pair whose surfaces touch is missed, at any speed; a pair may be reported that only comes
/// within the thickness. Sources: Li, Kaufman and Jiang 2021 (additive continuous collision
/// detection); slack, thickness and the bound of turning bodies are ours.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/collide/collision_surfaces.hpp"
#include "kernels/base/pair_limit.hpp"
#include "kernels/collide/pair_kind.hpp"
#include "kernels/collide/touch.hpp"

namespace tetwarp {

struct TouchingPair {
  PairKind kind = PairKind::vertex_face;
  std::int32_t a = 0, b = 0;
  double time = 2;            ///< fraction of the motion at which the surfaces come within the
                              ///< detection distance, 0 to 1; above 1: they do not
  double start_distance = 0;  ///< between the surfaces at the start, radii subtracted [m]

  auto operator<=>(const TouchingPair&) const = default;
};

/// What a detection did; adds up until read.
struct DetectionCounts {
  std::int64_t skipped_items = 0;  ///< triangles, capsules, spheres that are far from all bodies
  std::int64_t grid_entries = 0;   ///< (cell, item) entries of the broad phase
  std::int64_t box_tests = 0;      ///< of two boxes
  std::int64_t box_pairs = 0;      ///< whose boxes overlap
  std::int64_t pairs = 0;          ///< of features, tested by the narrow phase
  std::int64_t evaluations = 0;    ///< of distances
  std::int64_t reused = 0;         ///< detections that kept the pairs of an earlier one
  std::int64_t skipped_edges = 0;  ///< within flat faces, in all searches
};

struct ClosestPair {
  PairKind kind = PairKind::vertex_face;
  std::int32_t a = -1, b = -1;  ///< -1: nothing is nearer than the cap
  double distance = 0;          ///< [m]; without a pair the cap
};

struct DetectorOptions {
  int threads = 1;              ///< of the cpu; any number: same pairs
  int device = 0;               ///< CUDA device number
  bool reuse_pairs = true;      ///< pairs of the broad phase suffice while boxes lie within its own
  bool skip_flat_edges = true;  ///< CollisionSurfaces::edge_is_flat and vertex_is_flat are read
  bool skip_clear_bodies = true;  ///< of the cpu: bodies that hardly deform are not compared with
                                  ///< themselves, see SelfClearance
};

class Detector {
 public:
  virtual ~Detector() = default;

  /// Starts a step: pairs and touches of earlier motions are discarded.
  virtual void begin_step() = 0;
  /// Sets the bodies that do not move until the next call of this function: pairs of two of them
  /// are left out, except by closest().
  /// @param is_still  [bodies], or empty: none
  virtual void set_still(std::span<const std::uint8_t> is_still) = 0;
  /// Pairs that come within half the thickness, and pairs within twice the thickness at the start;
  /// sorted, each once. Valid until the next call.
  virtual const std::vector<TouchingPair>& detect(const SurfaceMotion& motion) = 0;
  /// Only pairs that come within half the thickness, for a further motion from the same places:
  /// detect() has found the pairs that are near at the start. Valid as there.
  virtual const std::vector<TouchingPair>& detect_hits(const SurfaceMotion& motion) = 0;
  /// Pairs that come within a tenth of the thickness, sorted, each once: the final motion of a step
  /// must have none. A pair that starts farther apart and does not move is not among them.
  virtual const std::vector<TouchingPair>& check(const SurfaceMotion& motion) = 0;
  /// Finds the pairs of a motion, as detect() in the first call of a step and as detect_hits() in
  /// later ones, and makes their touches, as StepTouches::add(). All motions of a step have the
  /// same start, and are kept by the caller.
  /// @returns the number of pairs of which touches were made. First call of a step: all pairs.
  ///          Later calls: the hits that no earlier call of the step found as hits; without such
  ///          hits, all hits of two rigid bodies
  virtual std::int64_t find_touches(const SurfaceMotion& motion) = 0;
  /// Bodies in pairs of the last find_touches() that have unknowns and do not move, ascending.
  virtual const std::vector<std::int32_t>& reached() const = 0;
  /// The touches of the step that become contacts, as StepTouches::choose(). PairTouch::way is that
  /// of the first motion. Call it after find_touches() and before any other detection; valid until
  /// the next call.
  virtual std::span<const ChosenTouch> touches() = 0;
  /// The pair of the smallest distance below `cap` [m]; the first in sorted order among equals. The
  /// cap is smaller where too many pairs would have to be compared, at least twice the thickness.
  /// @throws TooManyPairs  there are as many within twice the thickness
  /// @param resident  a motion that starts and ends at these places, as SurfaceMotion::resident
  virtual ClosestPair closest(const SurfacePlaces& places,
                              double cap,
                              const MotionView& resident) = 0;
  ClosestPair closest(const SurfacePlaces& places, double cap) { return closest(places, cap, {}); }

  /// Of all calls since the last counts().
  virtual DetectionCounts counts() = 0;
};

/// @param surfaces  kept by the caller
std::unique_ptr<Detector> make_cpu_detector(const CollisionSurfaces& surfaces,
                                            const DetectorOptions& options);
/// @throws CudaError  without CUDA or a usable device
std::unique_ptr<Detector> make_cuda_detector(const CollisionSurfaces& surfaces,
                                             const DetectorOptions& options);

}  // namespace tetwarp
