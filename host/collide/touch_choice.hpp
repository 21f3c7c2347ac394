/// @file touch_choice.hpp
/// TouchChoice: the touches of a step that become contacts.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/collide/collision_surfaces.hpp"
#include "kernels/collide/touch_stages.hpp"

namespace tetwarp {

/// A vertex touches another body at its nearest part: a face, a plane, a sphere or a capsule. The
/// nearest part is that of the smallest distance among parts that are near at the start, else the
/// one that is hit first. Of a pair with touches from several detections the last touch counts.
///
/// - A touch counts only if its nearest points are what is nearest of both surfaces around them,
/// and
///   no other contact of the step forbids it; see TouchOp and sink_stages.hpp.
/// - A vertex and a body: the touch at the nearest part becomes a contact. A touch at another part
///   of the body becomes a contact, too, if its normal differs by more than 5 degrees from the
///   normals of all nearer parts that became contacts, so that a ball in a ring has contacts all
///   around. What is round and sinks into a deformable body has a contact with each part: each
///   gives way by itself. A touch whose nearest point lies on an edge or a corner that a nearer
///   part shares does not become a contact.
/// - Two edges: their touch becomes a contact if the nearest points are inside both edges, that is,
///   where the edges cross. A nearest point at an end is a vertex, which has a touch of its own.
/// - Two capsules: the touch at their nearest points becomes a contact. If they are parallel to 10
///   degrees and overlap along their axes, the touches at both ends of the overlap become contacts,
///   and that at the nearest points only where the gap is smaller by a tenth of the thickness.
///
/// Area of a contact: that of its vertex, projected along the normal, so that the areas of the
/// contacts of a surface add up to the area that touches; of two meshes that touch, the finer one
/// has the larger share. Contacts of edges and of round parts have none, nor have further contacts
/// of a vertex whose normals differ by less than 45 degrees from a nearer one.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class TouchChoice {
 public:
  TouchChoice(Exec& exec, const CollisionSurfaces& surfaces)
      : exec_(exec), vertex_count_(std::ssize(surfaces.vertex_body)) {
    const std::int64_t features = vertex_count_ + std::ssize(surfaces.edges);
    while ((features >> key_bits_) > 0) ++key_bits_;
  }

  /// @param start  places of vertices at the start of the step, as MotionView::start
  /// @returns as StepTouches::choose()
  std::span<const ChosenTouch> choose(const TouchList& touches,
                                      const CollideView& scene,
                                      const TouchAreaView& areas,
                                      View<const double> start) {
    exec_.fill(label, touches.size(), TouchKeyOp{touches, vertex_count_}, order_);
    exec_.sort_pairs(label, order_, key_bits_);
    exec_.resize(mark_, order_.size());
    exec_.resize(ordered_, order_.size());
    exec_.for_each(
        label, order_.size(),
        TouchChoiceOp{touches, scene, order_.view(), exec_.view(ordered_), exec_.view(mark_)});
    exec_.append(label, order_.size(),
                 ChosenTouchOp{touches, areas, start, exec_.view(std::as_const(ordered_)),
                               exec_.view(std::as_const(mark_))},
                 chosen_);
    const View<const ChosenTouch> chosen = exec_.on_host(chosen_.view(), host_chosen_);
    return {chosen.data, static_cast<std::size_t>(chosen.size)};
  }

 private:
  template <class T>
  using Vector = typename Exec::template Vector<T>;
  template <class T>
  using List = typename Exec::template List<T>;
  static constexpr const char* label = "collide/touches";

  Exec& exec_;
  std::int64_t vertex_count_;
  int key_bits_ = 1;          ///< of the number of a feature
  List<KeyValue> order_;      ///< feature, number of a touch; sorted by feature
  Vector<KeyValue> ordered_;  ///< the same, of each vertex by body and distance
  Vector<std::int8_t> mark_;
  List<ChosenTouch> chosen_;
  std::vector<ChosenTouch> host_chosen_;
};

}  // namespace tetwarp
