/// @file step_touches.hpp
/// StepTouches: where the pairs touch that the detections of a step find, on an executor.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/collide/area_buffers.hpp"
#include "host/collide/known_hits.hpp"
#include "host/collide/sunk_hits.hpp"
#include "host/collide/touch_choice.hpp"
#include "host/collide/touch_lists.hpp"

namespace tetwarp {

/// The touch of a pair is made once, from the motion of the detection that found it, and kept until
/// the end of the step:
/// - nearest points and normal at the time of the hit, or at the start for a pair that is near
///   without a hit;
/// - `gap`: the distance at the start along the normal, less the thickness;
/// - the two points in the material at the start, moved along the normal until they are `gap`
///   apart. If one side does not move, its point is moved; else the point of a rigid body against a
///   deformable one; else both points by half each.
///
/// TouchChoice states which touches become contacts.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class StepTouches {
 public:
  /// @param surfaces  kept by the caller
  StepTouches(Exec& exec, const CollisionSurfaces& surfaces)
      : exec_(exec),
        thickness_(surfaces.thickness),
        areas_(exec, surfaces),
        known_(surfaces),
        sunk_(exec, surfaces),
        touches_(exec, std::ranges::any_of(surfaces.edge_radius, [](double r) { return r > 0; })),
        choice_(exec, surfaces) {}

  void begin_step() {
    pass_ = 0;
    known_.clear();
    touches_.clear();
  }

  /// Whether the pairs of the step's first detection have been added.
  bool has_begun() const { return pass_ > 0; }

  /// Makes touches of pairs of a detection.
  ///
  /// Of the first detection of a step: of all pairs. Of a later one: of the hits that no earlier
  /// detection of the step had as hits. If a later detection has none of these, the touches of its
  /// hits of two rigid bodies are made again, from its motion: such bodies turn, so that a contact
  /// along the normal of an earlier hit may not keep them apart. For deformable bodies this would
  /// cost more solves than it saves.
  /// @param found  of the first detection the pairs that are near or hit, of later ones those hit
  /// @returns the number of pairs of which touches were made
  std::int64_t add(const CollideView& scene,
                   const MotionView& motion,
                   View<const FeatureTouch> found) {
    scene_ = scene;
    start_ = motion.start;
    const std::int64_t made = pass_ == 0 ? add_first(motion, found) : add_later(motion, found);
    ++pass_;
    return made;
  }

  /// The touches of the step that become contacts: first those of vertices, by vertex and body, the
  /// nearest first; then those of edges. Valid until the next call.
  std::span<const ChosenTouch> choose() {
    return choice_.choose(touches_.view(), scene_, areas(), start_);
  }

 private:
  std::int64_t add_first(const MotionView& motion, View<const FeatureTouch> found) {
    first_end_view_ = exec_.keep(motion.end, first_end_);
    first_planes_view_ = exec_.keep(motion.plane_end, first_planes_);
    touches_.set_first(found, view_of(motion));
    sunk_.leave_out(found, view_of(motion), touches_.first());
    exec_.append(label, found.size, HitOp{found, std::as_const(touches_).first()}, hits_);
    exec_.wait();  // the caller may change the motion after this
    return found.size;
  }
  std::int64_t add_later(const MotionView& motion, View<const FeatureTouch> found) {
    if (pass_ == 1) known_.add(exec_.on_host(hits_.view(), host_hits_));
    exec_.append(label, found.size, NearestHitOp{found, view_of(motion)}, hits_);
    const std::vector<FeatureTouch>* pairs = &known_.add(exec_.on_host(hits_.view(), host_hits_));
    if (pairs->empty()) pairs = &known_.of_rigid_bodies();
    if (pairs->empty()) return 0;
    exec_.put(*pairs, later_pairs_);
    touches_.add_later(exec_.view(std::as_const(later_pairs_)), view_of(motion), pass_);
    exec_.wait();
    return std::ssize(*pairs);
  }
  TouchAreaView areas() const { return areas_.view(scene_.triangles); }
  TouchView view_of(const MotionView& motion) const {
    return {scene_, areas(), motion, first_end_view_, first_planes_view_, thickness_};
  }

  template <class T>
  using Vector = typename Exec::template Vector<T>;
  static constexpr const char* label = "collide/touches";

  Exec& exec_;
  double thickness_;
  AreaBuffers<Exec> areas_;
  KnownHits known_;
  SunkHits<Exec> sunk_;
  TouchLists<Exec> touches_;
  TouchChoice<Exec> choice_;

  std::int32_t pass_ = 0;  ///< detections of the step so far
  CollideView scene_;
  View<const double> start_;  ///< MotionView::start of the step
  /// Ends of the first motion of the step, and copies of them where the executor needs copies.
  View<const double> first_end_view_, first_planes_view_;
  Vector<double> first_end_, first_planes_;
  typename Exec::template List<FeatureTouch> hits_;  ///< last added, of features that are nearest
  Vector<FeatureTouch> later_pairs_;
  std::vector<FeatureTouch> host_hits_;
};

}  // namespace tetwarp
