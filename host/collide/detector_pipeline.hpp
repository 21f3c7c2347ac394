/// @file detector_pipeline.hpp
/// DetectorPipeline: the stages of collision detection, on an executor.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/collide/body_partners.hpp"
#include "host/collide/collide_items.hpp"
#include "host/collide/detector.hpp"
#include "host/collide/grid_plan.hpp"
#include "host/collide/step_touches.hpp"
#include "kernels/collide/pair_features.hpp"
#include "kernels/collide/pair_gap.hpp"
#include "kernels/collide/pair_touch.hpp"

namespace tetwarp {

/// @tparam Exec  CpuDetectExec or CudaDetectExec
template <class Exec>
class DetectorPipeline {
 public:
  /// @param surfaces  kept by the caller
  DetectorPipeline(Exec& exec, const CollisionSurfaces& surfaces, const DetectorOptions& options)
      : exec_(exec),
        surfaces_(surfaces),
        reuses_pairs_(options.reuse_pairs),
        items_(make_collide_items(surfaces, options.skip_flat_edges)),
        memory_(exec, surfaces, items_),
        step_(exec, surfaces) {
    const auto vertices = static_cast<std::int64_t>(surfaces.vertex_body.size());
    exec_.resize(found_, vertices);
    exec_.resize(run_boxes_, size_of(items_.runs));
    exec_.resize(item_boxes_, size_of(items_.items));
    exec_.resize(item_sizes_, size_of(items_.items));
    exec_.resize(size_counts_, (size_of(items_.items) + size_run - 1) / size_run * item_sizes);
    exec_.resize(size_sums_, item_sizes);
  }

  void begin_step() {
    has_pairs_ = false;
    step_.begin_step();
  }
  void set_still(std::span<const std::uint8_t> is_still) {
    is_still_.assign(is_still.begin(), is_still.end());
    Memory::put(exec_, is_still_, still_bodies_);
    has_pairs_ = false;
  }

  const std::vector<TouchingPair>& detect(const SurfaceMotion& motion) {
    const double h = surfaces_.thickness;
    return touching(motion, detection_limits(h), 2 * h);
  }
  const std::vector<TouchingPair>& check(const SurfaceMotion& motion) {
    const double h = surfaces_.thickness;
    return touching(motion, end_check_limits(h), -1);
  }
  const std::vector<TouchingPair>& detect_hits(const SurfaceMotion& motion) {
    return touching(motion, detection_limits(surfaces_.thickness), -1);
  }
  std::int64_t find_touches(const SurfaceMotion& motion);
  const std::vector<std::int32_t>& reached() const { return reached_; }
  std::span<const ChosenTouch> touches() { return step_.choose(); }
  ClosestPair closest(const SurfacePlaces& places, double cap, const MotionView& resident);

  DetectionCounts take_counts() { return std::exchange(counts_, {}); }

 private:
  template <class T>
  using Vector = typename Exec::template Vector<T>;
  template <class T>
  using List = typename Exec::template List<T>;

  /// What does not change, in memory of the executor.
  struct Memory {
    Vector<CollideItem> items;
    Vector<CollideBody> bodies;
    Vector<std::int32_t> forbidden, vertex_body, edges, triangles, plane_body;
    Vector<double> vertex_radius, edge_radius;
    Vector<VertexRun> runs;
    Vector<double> no_sagitta;

    Memory(Exec& exec, const CollisionSurfaces& s, const CollideItems& made) {
      put(exec, made.items, items);
      put(exec, made.bodies, bodies);
      put(exec, made.forbidden, forbidden);
      put(exec, made.runs, runs);
      put(exec, s.vertex_body, vertex_body);
      put(exec, s.plane_body, plane_body);
      put(exec, s.vertex_radius, vertex_radius);
      put(exec, s.edge_radius, edge_radius);
      put(exec, std::vector<double>(s.vertex_body.size()), no_sagitta);
      exec.put(s.edges.empty() ? nullptr : s.edges[0].data(), 2 * size_of(s.edges), edges);
      exec.put(s.triangles.empty() ? nullptr : s.triangles[0].data(), 3 * size_of(s.triangles),
               triangles);
    }
    template <class T>
    static void put(Exec& exec, const std::vector<T>& from, Vector<T>& to) {
      exec.put(from.data(), size_of(from), to);
    }
  };

  template <class T>
  static std::int64_t size_of(const std::vector<T>& values) {
    return static_cast<std::int64_t>(values.size());
  }
  /// To be read by stages.
  template <class T>
  View<const T> view(const Vector<T>& values) const {
    return exec_.view(values);
  }
  CollideView scene() const {
    return {view(memory_.items),       view(memory_.bodies),        view(memory_.forbidden),
            view(memory_.vertex_body), view(memory_.vertex_radius), view(memory_.edges),
            view(memory_.edge_radius), view(memory_.triangles),     view(memory_.plane_body)};
  }

  void check_sizes(const SurfacePlaces& places) const {
    if (places.vertices.size() != surfaces_.vertex_body.size() ||
        places.planes.size() != surfaces_.plane_body.size()) {
      throw std::invalid_argument("collision detection: places of " +
                                  std::to_string(places.vertices.size()) + " vertices and " +
                                  std::to_string(places.planes.size()) + " planes, expected " +
                                  std::to_string(surfaces_.vertex_body.size()) + " and " +
                                  std::to_string(surfaces_.plane_body.size()));
    }
  }
  View<const double> points(const std::vector<Point3>& host, Vector<double>& own) {
    return exec_.input(host.empty() ? nullptr : host[0].data(), 3 * size_of(host), own);
  }
  View<const double> plane_numbers(const std::vector<PlanePlace>& host, Vector<double>& own) {
    static_assert(sizeof(PlanePlace) == 6 * sizeof(double));
    return exec_.input(host.empty() ? nullptr : host[0].point.data(), 6 * size_of(host), own);
  }

  static bool is_given(const MotionView& resident) {
    return resident.start.size > 0 || resident.plane_start.size > 0;
  }
  /// Makes the motion readable by stages.
  void set_motion(const SurfaceMotion& motion);
  /// Sets touches_.
  void find_pairs(const SurfaceMotion& motion, const CcdLimits& limits, double near_at_start);
  /// The same, sorted on the host.
  const std::vector<TouchingPair>& touching(const SurfaceMotion& motion,
                                            const CcdLimits& limits,
                                            double near_at_start);
  /// Computes the boxes of vertices and bodies; with `finds` those of a search, too.
  /// @returns whether all boxes lie within those found before
  bool make_boxes(double distance, bool finds, double found_distance, double fraction);
  void find_item_pairs(std::span<const std::uint8_t> is_still);
  void find_features(const SurfaceMotion& motion,
                     double distance,
                     std::span<const std::uint8_t> is_still);
  PairGap nearest_of_features();

  Exec& exec_;
  const CollisionSurfaces& surfaces_;
  bool reuses_pairs_;
  CollideItems items_;
  Memory memory_;
  StepTouches<Exec> step_;
  BodyPartners partners_;
  MotionView motion_;
  DetectionCounts counts_;
  bool has_pairs_ = false;
  std::vector<std::uint8_t> is_still_;  ///< [bodies], or empty
  Vector<std::uint8_t> still_bodies_;   ///< the same

  Vector<double> start_, end_, sagitta_, plane_start_, plane_end_;
  Vector<TurningFrame> frames_;
  Vector<Box> found_;  ///< of vertices
  Vector<RunBox> run_boxes_;
  std::vector<RunBox> host_run_boxes_;
  Vector<Box> body_boxes_, item_boxes_;
  Vector<std::int32_t> partner_start_, partner_bodies_, near_start_, near_planes_;
  Vector<std::int8_t> item_sizes_;
  Vector<std::int32_t> size_counts_, size_sums_;
  std::vector<std::int32_t> host_size_sums_;
  GridPlan host_plan_{};
  Vector<GridPlan> plan_;
  List<CellPair> entries_;
  List<ItemPair> pairs_;
  List<FeaturePair> features_;
  Vector<CcdResult> results_;
  List<FeatureTouch> touches_;
  std::vector<FeatureTouch> host_touches_;
  std::vector<TouchingPair> touching_;
  List<std::int32_t> reached_list_;
  std::vector<std::int32_t> host_reached_, reached_;
  Vector<PairGap> gaps_;
  std::vector<PairGap> host_gaps_;
  SurfaceMotion still_;  ///< of closest(): planes only
};

}  // namespace tetwarp

#include "host/collide/detector_pipeline-inl.hpp"  // IWYU pragma: export
