/// @file step_touches.hpp
/// StepTouches: where the pairs touch that the detections of a step find, on an executor.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <span>
#include <tuple>
#include <vector>

#include "host/collide/pair_bodies.hpp"
#include "host/collide/touch_areas.hpp"
#include "kernels/collide/touch_stages.hpp"

namespace tetwarp {

/// Touches are made once for each pair, with the motion in which it was found, and kept to the end
/// of the step.
///
/// Of each pair: the nearest points and the normal at the time of the hit, or at the start where it
/// is near only; gap at the start less the thickness. The points are those of the material at the
/// start, moved along the normal so that they are `gap` apart: on the side that does not move, else
/// on that of a rigid body against a deformable one, else by half on each.
///
/// Which touches become contacts:
/// - A vertex touches another body once, at the nearest face, plane or round part. Other parts of
///   the body count, too, where they face elsewhere: by more than 45 degrees, or by more than 5 at
///   a point inside a face. A round part touches by more than 5 degrees elsewhere also what is at
///   most a quarter of the thickness further at the start: a ball in a ring touches the whole ring.
///   No part counts at an edge or corner that they share with a nearer one. A
///   vertex next to an edge between even faces so has one contact, and slides over the edge.
/// - Two edges touch where they cross. Where an end of one is nearest, its vertex touches already.
///   Edges that are near without a hit must be what is nearest of their surfaces: an edge within an
///   even face does not hold up what passes over it.
/// - Two capsules touch where they are nearest; side by side, to 10 degrees, at both ends of their
///   overlap, and between these where they are nearer there by a tenth of the thickness.
///
/// Areas are those of the vertices that touch, seen along the normal, so that they add up to the
/// area that touches; those of two meshes are shared by fineness. Edges and round parts have none.
/// @tparam Exec  CpuDetectExec or CudaDetectExec
template <class Exec>
class StepTouches {
  template <class T>
  using Vector = typename Exec::template Vector<T>;
  template <class T>
  using List = typename Exec::template List<T>;

 public:
  /// @param surfaces  kept by the caller
  StepTouches(Exec& exec, const CollisionSurfaces& surfaces)
      : exec_(exec),
        surfaces_(surfaces),
        thickness_(surfaces.thickness),
        vertex_count_(size_of(surfaces.vertex_body)),
        feature_count_(vertex_count_ + size_of(surfaces.edges)),
        has_capsules_(std::ranges::any_of(surfaces.edge_radius, [](double r) { return r > 0; })) {
    const TouchAreas areas(surfaces);
    put(areas.start, area_start_);
    put(areas.triangle, area_triangle_);
    put(areas.mean_area, mean_area_);
    put(surfaces.vertex_area, vertex_area_);
  }

  void begin_step() {
    pass_ = 0;
    known_.clear();
    exec_.resize(first_, 0);
    ends_.clear();
    later_count_ = 0;
  }

  /// Whether pairs of the step's first detection have been added.
  bool has_begun() const { return pass_ > 0; }

  /// Adds the pairs of a detection.
  /// @param found    of the first detection of a step all that are near or hit, of later ones those
  ///                 that are hit
  /// @returns the number of those that are new, or were only near and are hit now; if there are
  ///          none, of those of two rigid bodies that are hit again
  std::int64_t add(const CollideView& scene, const MotionView& motion, List<FeatureTouch>& found) {
    scene_ = scene;
    start_ = motion.start;
    if (pass_ == 0) {
      first_end_view_ = exec_.keep(motion.end, first_end_);
      first_planes_view_ = exec_.keep(motion.plane_end, first_planes_);
      make(found.view(), motion, first_, ends_);
      exec_.append(label, found.size(), HitBody{found.view()}, hits_);
      exec_.wait();  // the caller may change the motion after this
      ++pass_;
      return found.size();
    }
    if (pass_ == 1) keep_new(exec_.on_host(hits_.view(), host_hits_));
    keep_new(exec_.on_host(found.view(), host_hits_));
    if (new_.empty()) add_hit_again();
    if (!new_.empty()) {
      put(new_, new_pairs_);
      make(exec_.view(std::as_const(new_pairs_)), motion, fresh_, fresh_ends_);
      add_later();
      exec_.wait();
    }
    ++pass_;
    return size_of(new_);
  }

  /// The touches of the step that become contacts: those of a vertex and another body follow each
  /// other, the nearest first; edges come last. Valid until the next call.
  std::span<const ChosenTouch> choose() {
    const TouchList touches{exec_.view(std::as_const(first_)), ends_.view(), later()};
    exec_.fill(label, touches.size(), TouchKeyBody{touches, vertex_count_}, order_);
    int bits = 1;
    while ((feature_count_ >> bits) > 0) ++bits;
    exec_.sort_pairs(label, order_, bits);
    exec_.resize(mark_, order_.size());
    exec_.resize(ordered_, order_.size());
    exec_.for_each(label, order_.size(),
                   TouchChoiceBody{touches, scene_, thickness_, order_.view(), exec_.view(ordered_),
                                   exec_.view(mark_)});
    exec_.append(label, order_.size(),
                 ChosenTouchBody{touches, areas(), start_, exec_.view(std::as_const(ordered_)),
                                 exec_.view(std::as_const(mark_))},
                 chosen_);
    const View<const ChosenTouch> chosen = exec_.on_host(chosen_.view(), host_chosen_);
    return {chosen.data, static_cast<std::size_t>(chosen.size)};
  }

 private:
  static constexpr const char* label = "collide/touches";

  template <class T>
  static std::int64_t size_of(const std::vector<T>& values) {
    return static_cast<std::int64_t>(values.size());
  }
  template <class T>
  void put(const std::vector<T>& host, Vector<T>& own) {
    exec_.put(host.data(), size_of(host), own);
  }
  TouchAreaView areas() const {
    return {exec_.view(area_start_), exec_.view(area_triangle_), scene_.triangles,
            exec_.view(vertex_area_), exec_.view(mean_area_)};
  }
  TouchView view_of(const MotionView& motion) const {
    return {scene_, areas(), motion, first_end_view_, first_planes_view_, thickness_};
  }
  View<const PairTouch> later() const {
    return {exec_.view(later_[later_now_]).data, later_count_};
  }

  static auto key_of(const FeatureTouch& touch) {
    return std::tuple(touch.pair.kind, touch.pair.a, touch.pair.b);
  }
  static bool is_less(const FeatureTouch& p, const FeatureTouch& q) {
    return key_of(p) < key_of(q);
  }
  /// Sets new_ to the hits that no earlier detection found, and adds them to the known ones.
  void keep_new(View<const FeatureTouch> hits) {
    sorted_.assign(hits.data, hits.data + hits.size);
    std::sort(sorted_.begin(), sorted_.end(), is_less);
    new_.clear();
    std::set_difference(sorted_.begin(), sorted_.end(), known_.begin(), known_.end(),
                        std::back_inserter(new_), is_less);
    const auto middle = static_cast<std::ptrdiff_t>(known_.size());
    known_.insert(known_.end(), new_.begin(), new_.end());
    std::inplace_merge(known_.begin(), known_.begin() + middle, known_.end(), is_less);
  }
  /// Adds the hits of two rigid bodies: their ways bend as they turn, so that a contact along the
  /// normal at an earlier hit may not keep them apart. Of deformable bodies that costs more, in
  /// solves, than it helps.
  void add_hit_again() {
    std::ranges::copy_if(sorted_, std::back_inserter(new_), [this](const FeatureTouch& touch) {
      return std::ranges::all_of(bodies_of(touch.pair, surfaces_), [this](std::int32_t body) {
        return at(surfaces_.bodies, body).is_rigid;
      });
    });
  }
  /// @param touches  out, [pairs]
  /// @param ends     out
  void make(View<const FeatureTouch> pairs,
            const MotionView& motion,
            Vector<PairTouch>& touches,
            List<PairTouch>& ends) {
    exec_.resize(touches, pairs.size);
    exec_.for_each(label, pairs.size,
                   TouchBody{pairs, view_of(motion), pass_, exec_.view(touches)});
    ends.clear();
    if (!has_capsules_) return;
    exec_.append(label, pairs.size,
                 EndTouchBody{pairs, exec_.view(std::as_const(touches)), view_of(motion), pass_},
                 ends);
  }
  void add_later() {
    const View<const PairTouch> fresh = exec_.view(std::as_const(fresh_));
    const std::int64_t count = later_count_ + fresh.size + fresh_ends_.size();
    Vector<PairTouch>& joined = later_[1 - later_now_];
    exec_.resize(joined, count + count / 2);
    exec_.for_each(label, count,
                   TouchCopyBody{{later(), fresh, fresh_ends_.view()}, exec_.view(joined)});
    later_now_ = 1 - later_now_;
    later_count_ = count;
  }

  Exec& exec_;
  const CollisionSurfaces& surfaces_;
  double thickness_;
  std::int64_t vertex_count_, feature_count_;
  bool has_capsules_;
  Vector<std::int32_t> area_start_, area_triangle_;
  Vector<double> vertex_area_, mean_area_;

  // Of the step.
  std::int32_t pass_ = 0;
  CollideView scene_;
  View<const double> start_;
  Vector<double> first_end_, first_planes_;
  View<const double> first_end_view_, first_planes_view_;
  std::vector<FeatureTouch> known_;         ///< hits, sorted
  Vector<PairTouch> first_;                 ///< of the first detection
  List<PairTouch> ends_;                    ///< the same, at ends of overlaps
  std::array<Vector<PairTouch>, 2> later_;  ///< of later ones: one of both
  std::size_t later_now_ = 0;
  std::int64_t later_count_ = 0;

  // Of the running call; kept, so that steps do not allocate them.
  List<FeatureTouch> hits_;
  std::vector<FeatureTouch> host_hits_, sorted_, new_;
  Vector<FeatureTouch> new_pairs_;
  Vector<PairTouch> fresh_;
  List<PairTouch> fresh_ends_;
  List<CellPair> order_;
  Vector<CellPair> ordered_;
  Vector<std::int8_t> mark_;
  List<ChosenTouch> chosen_;
  std::vector<ChosenTouch> host_chosen_;
};

}  // namespace tetwarp
