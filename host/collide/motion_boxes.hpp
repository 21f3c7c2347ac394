/// @file motion_boxes.hpp
/// MotionBoxes: the space that vertices and bodies pass through in a motion.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "host/collide/collide_items.hpp"
#include "host/collide/surface_buffers.hpp"
#include "kernels/collide/vertex_box.hpp"

namespace tetwarp {

/// Boxes of vertices, and their unions over runs of vertices up to one box for each body.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class MotionBoxes {
 public:
  /// @param surfaces, items  kept by the caller
  MotionBoxes(Exec& exec, const SurfaceBuffers<Exec>& surfaces, const CollideItems& items)
      : exec_(exec), surfaces_(surfaces), levels_(items.levels) {
    exec_.resize(found_, surfaces.radii().size);
    exec_.resize(run_boxes_, std::ssize(items.runs));
  }

  /// Finds the boxes of a search, which of_vertices() keeps.
  /// @param distance  within which pairs are searched [m]
  /// @param fraction  of a vertex's way: added to its box on all sides
  /// @returns boxes of bodies, by the last runs of CollideItems; valid until the next call
  View<const RunBox> find(const MotionView& motion, double distance, double fraction) {
    return unite(motion, distance, fraction, true);
  }
  /// Finds the boxes of a motion without a margin, and compares them with those of the last search.
  /// @returns as find(); RunBox::leaves is set where a box is not within that of the search
  View<const RunBox> compare(const MotionView& motion, double distance) {
    return unite(motion, distance, 0, false);
  }

  /// Of the last search.
  View<const Box> of_vertices() const { return exec_.view(std::as_const(found_)); }

 private:
  template <class T>
  using Vector = typename Exec::template Vector<T>;

  View<const RunBox> unite(const MotionView& motion, double distance, double fraction, bool finds) {
    exec_.for_each(
        "collide/vertex_box", levels_[1],
        VertexBoxOp{surfaces_.runs(), motion, surfaces_.radii(), distance / 2, distance / 2,
                    fraction, finds ? 1 : 0, exec_.view(found_), exec_.view(run_boxes_)});
    for (std::size_t k = 1; k + 1 < levels_.size(); ++k) {
      exec_.for_each("collide/vertex_box", levels_[k + 1] - levels_[k],
                     BoxUniteOp{surfaces_.runs(), levels_[k], exec_.view(run_boxes_)});
    }
    const std::int64_t last = levels_[levels_.size() - 2];
    return exec_.on_host(
        View<const RunBox>{exec_.view(run_boxes_).data + last, levels_.back() - last},
        host_run_boxes_);
  }

  Exec& exec_;
  const SurfaceBuffers<Exec>& surfaces_;
  const std::vector<std::int64_t>& levels_;  ///< CollideItems::levels
  Vector<Box> found_;                        ///< of vertices
  Vector<RunBox> run_boxes_;
  std::vector<RunBox> host_run_boxes_;
};

}  // namespace tetwarp
