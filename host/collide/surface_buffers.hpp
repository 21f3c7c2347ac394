/// @file surface_buffers.hpp
/// SurfaceBuffers: the surfaces of a scene in memory of an executor.
#pragma once
#include <cstdint>
#include <vector>

#include "host/collide/collide_items.hpp"
#include "host/collide/collision_surfaces.hpp"
#include "kernels/collide/collide_item.hpp"
#include "kernels/collide/vertex_box.hpp"

namespace tetwarp {

/// Constant during a simulation.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class SurfaceBuffers {
 public:
  SurfaceBuffers(Exec& exec, const CollisionSurfaces& surfaces, const CollideItems& made)
      : exec_(exec) {
    exec_.put(made.items, items_);
    exec_.put(made.bodies, bodies_);
    exec_.put(made.forbidden, forbidden_);
    exec_.put(made.runs, runs_);
    exec_.put(surfaces.vertex_body, vertex_body_);
    exec_.put(surfaces.plane_body, plane_body_);
    exec_.put(surfaces.vertex_radius, vertex_radius_);
    exec_.put(surfaces.edge_radius, edge_radius_);
    const auto& edges = surfaces.edges;
    exec_.put(edges.empty() ? nullptr : edges[0].data(), 2 * std::ssize(edges), edges_);
    const auto& triangles = surfaces.triangles;
    exec_.put(triangles.empty() ? nullptr : triangles[0].data(), 3 * std::ssize(triangles),
              triangles_);
  }

  CollideView scene() const {
    return {view(items_), view(bodies_),      view(forbidden_), view(vertex_body_), radii(),
            view(edges_), view(edge_radius_), view(triangles_), view(plane_body_)};
  }
  /// CollideItems::runs.
  View<const VertexRun> runs() const { return view(runs_); }
  /// Of vertices.
  View<const double> radii() const { return view(vertex_radius_); }

 private:
  template <class T>
  using Vector = typename Exec::template Vector<T>;

  template <class T>
  View<const T> view(const Vector<T>& values) const {
    return exec_.view(values);
  }

  Exec& exec_;
  Vector<CollideItem> items_;
  Vector<CollideBody> bodies_;
  Vector<std::int32_t> forbidden_, vertex_body_, edges_, triangles_, plane_body_;
  Vector<double> vertex_radius_, edge_radius_;
  Vector<VertexRun> runs_;
};

}  // namespace tetwarp
