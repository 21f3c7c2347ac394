/// @file feature_pairs.hpp
/// FeaturePairs: the pairs of vertices, edges, faces and planes that may come near each other.
#pragma once
#include <cstdint>
#include <span>
#include <utility>

#include "host/collide/broad_phase.hpp"
#include "host/collide/near_planes.hpp"
#include "kernels/collide/pair_features.hpp"

namespace tetwarp {

/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class FeaturePairs {
 public:
  /// @param surfaces, buffers, items  kept by the caller
  FeaturePairs(Exec& exec,
               const CollisionSurfaces& surfaces,
               const SurfaceBuffers<Exec>& buffers,
               const CollideItems& items)
      : exec_(exec), surfaces_(surfaces), buffers_(buffers), items_(items) {}

  /// Finds the pairs of a motion from pairs of items and from planes. Pairs that certainly stay
  /// farther apart are left out.
  /// @param planes    the motion on the host: planes and frames are read
  /// @param motion    the same for stages
  /// @param distance  that is looked for [m]
  /// @param is_still  as of NearPlanes::find()
  void find(const BroadPhase<Exec>& broad,
            const SurfaceMotion& planes,
            const MotionView& motion,
            double distance,
            std::span<const std::uint8_t> is_still,
            DetectionCounts& counts) {
    near_.find(surfaces_, items_, broad.partners(), planes, distance, is_still);
    exec_.put(near_.start, start_);
    exec_.put(near_.planes, planes_);
    const std::int64_t vertices = near_.planes.empty() ? 0 : std::ssize(surfaces_.vertex_body);
    exec_.append("collide/pair_features", broad.pairs().size + vertices,
                 PairFeaturesOp{buffers_.scene(), broad.pairs(), motion, distance,
                                PlaneView{exec_.view(std::as_const(start_)),
                                          exec_.view(std::as_const(planes_))}},
                 pairs_, 8 * most_pairs(broad.item_count()));
    counts.pairs += pairs_.size();
  }

  View<const FeaturePair> view() const { return pairs_.view(); }

 private:
  Exec& exec_;
  const CollisionSurfaces& surfaces_;
  const SurfaceBuffers<Exec>& buffers_;
  const CollideItems& items_;
  NearPlanes near_;
  typename Exec::template Vector<std::int32_t> start_, planes_;  ///< of near_
  typename Exec::template List<FeaturePair> pairs_;
};

}  // namespace tetwarp
