/// @file sunk_hits.hpp
/// SunkHits: leaves out the hits of a step's first detection which other contacts forbid.
#pragma once
#include <cstdint>
#include <utility>

#include "host/collide/collision_surfaces.hpp"
#include "kernels/collide/sink_stages.hpp"

namespace tetwarp {

/// The stages of kernels/collide/sink_stages.hpp on an executor.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class SunkHits {
 public:
  SunkHits(Exec& exec, const CollisionSurfaces& surfaces)
      : exec_(exec),
        owners_{std::ssize(surfaces.vertex_body)},
        owner_count_(owners_.vertex_count + std::ssize(surfaces.bodies)) {
    while ((owner_count_ >> key_bits_) > 0) ++key_bits_;
  }

  /// @param pairs    of the first detection of a step
  /// @param touches  in and out, of these
  void leave_out(View<const FeatureTouch> pairs, const TouchView& view, View<PairTouch> touches) {
    const View<const PairTouch> all{touches.data, touches.size};
    exec_.append(label, touches.size, SinkOp{all, view, owners_}, sinks_);
    if (sinks_.size() == 0) return;
    exec_.sort_pairs(label, sinks_, key_bits_);
    exec_.append(label, sinks_.size(), FirstPushOp{all, sinks_.view()}, first_);
    exec_.resize(ways_, owner_count_);
    exec_.for_each(label, owner_count_, NoWayOutOp{exec_.view(ways_)});
    exec_.for_each(label, first_.size(), WayOutOp{all, first_.view(), exec_.view(ways_)});
    exec_.for_each(label, pairs.size,
                   SunkHitOp{pairs, view, owners_, exec_.view(std::as_const(ways_)), touches});
  }

 private:
  static constexpr const char* label = "collide/touches";

  Exec& exec_;
  SinkOwners owners_;
  std::int64_t owner_count_;
  int key_bits_ = 1;  ///< of the number of an owner
  typename Exec::template List<KeyValue> sinks_, first_;
  typename Exec::template Vector<KeyValue> ways_;
};

}  // namespace tetwarp
