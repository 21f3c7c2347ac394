/// @file resident_surfaces_cuda.cuh
/// ResidentSurfaces on a device: only velocities and fractions that the host has changed are copied
/// there.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/step/body_arrays.hpp"
#include "host/simulate/step/resident_surfaces.hpp"
#include "kernels/body/surface_move.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

class CudaResidentSurfaces final : public ResidentSurfaces {
 public:
  /// @param exec, model, now  kept by the caller
  CudaResidentSurfaces(CudaExec& exec, const Model& model, const StepArrays<CudaExec>& now)
      : exec_(exec), model_(model), now_(now) {}

  void begin(const SurfaceBinding& surfaces) override {
    const DeviceScope scope = exec_.enter();
    points(surfaces);
    exec_.for_each(label, count(),
                   SurfaceStartOp{view(points_), view(plane_local_), view(plane_rigid_), state(),
                                  start_.view(), plane_start_.view()});
  }

  /// What the vertices are bound to, in memory of the device.
  View<const SurfacePoint> points(const SurfaceBinding& surfaces) {
    if (!is_bound_) bind(surfaces);
    return view(points_);
  }

  ResidentMotion move(std::span<const Point3> velocity,
                      double time_step,
                      std::span<const double> fraction) override {
    const DeviceScope scope = exec_.enter();
    SurfaceVelocity by = {view(now_.velocity), model_.node_count, time_step, {}};
    if (!velocity.empty()) {
      exec_.renew(velocity.data()->data(), 3 * static_cast<std::int64_t>(velocity.size()),
                  velocity_);
      by.velocity = view(velocity_);
    }
    if (!fraction.empty()) {
      exec_.renew(fraction.data(), static_cast<std::int64_t>(fraction.size()), fraction_);
      by.fraction = view(fraction_);
    }
    exec_.for_each(label, view(body_rigid_).size,
                   FrameMoveOp{view(body_rigid_), state(), by, moved_.view(), frames_.view()});
    exec_.for_each(
        label, count(),
        SurfaceMoveOp{view(points_), view(plane_local_), view(plane_body_), state(), by,
                      view(moved_), view(start_), end_.view(), sagitta_.view(), plane_end_.view()});
    exec_.wait();  // whoever reads them does so on a stream of its own
    return {view(start_),       view(end_),       view(sagitta_),
            view(plane_start_), view(plane_end_), view(frames_)};
  }

 private:
  static constexpr const char* label = "body/surfaces";

  template <class T>
  static View<const T> view(const DeviceVector<T>& values) {
    return values.view();
  }
  std::int64_t count() const { return view(points_).size + view(plane_body_).size; }
  SurfaceState state() const {
    return {view(now_.position), view(now_.center), view(now_.rotation)};
  }
  template <class T>
  void put(std::span<const T> host, DeviceVector<T>& own) {
    exec_.put(host.data(), static_cast<std::int64_t>(host.size()), own);
  }

  void bind(const SurfaceBinding& surfaces) {
    std::vector<SurfacePoint> points(surfaces.vertex_point.size());
    for (std::size_t v = 0; v < points.size(); ++v) {
      const ModelPoint& from = surfaces.vertex_point[v];
      SurfacePoint& to = points[v];
      std::copy(from.node.begin(), from.node.end(), to.node);
      std::copy(from.weight.begin(), from.weight.end(), to.weight);
      std::copy(from.local.begin(), from.local.end(), to.local);
      to.rigid = from.rigid;
      to.body = surfaces.vertex_body[v];
    }
    put(std::span<const SurfacePoint>(points), points_);
    put(surfaces.body_rigid, body_rigid_);
    put(surfaces.plane_rigid, plane_rigid_);
    put(surfaces.plane_body, plane_body_);
    put(surfaces.plane_local, plane_local_);
    const std::int64_t vertices = view(points_).size, planes = view(plane_body_).size;
    const std::int64_t bodies = view(body_rigid_).size;
    for (auto* const places : {&start_, &end_}) places->resize(3 * vertices);
    for (auto* const places : {&plane_start_, &plane_end_}) places->resize(6 * planes);
    sagitta_.resize(vertices);
    moved_.resize(bodies);
    frames_.resize(9 * bodies);
    is_bound_ = true;
  }

  CudaExec& exec_;
  const Model& model_;
  const StepArrays<CudaExec>& now_;
  bool is_bound_ = false;
  DeviceVector<SurfacePoint> points_;
  DeviceVector<std::int32_t> body_rigid_, plane_rigid_, plane_body_;
  DeviceVector<double> plane_local_;
  CudaExec::Input<double> velocity_, fraction_;
  DeviceVector<MovedFrame> moved_;
  DeviceVector<double> start_, end_, sagitta_, plane_start_, plane_end_, frames_;
};

}  // namespace tetwarp
