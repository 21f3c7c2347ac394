/// @file area_buffers.hpp
/// AreaBuffers: the areas of vertices in memory of an executor.
#pragma once
#include <cstdint>
#include <vector>

#include "host/collide/touch_areas.hpp"

namespace tetwarp {

/// Constant during a simulation.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class AreaBuffers {
 public:
  AreaBuffers(Exec& exec, const CollisionSurfaces& surfaces) : exec_(exec) {
    const TouchAreas areas(surfaces);
    exec_.put(areas.start, start_);
    exec_.put(areas.triangle, triangle_);
    exec_.put(areas.mean_area, mean_area_);
    exec_.put(surfaces.vertex_area, vertex_area_);
  }

  /// @param corners  of triangles, [triangles][3]
  TouchAreaView view(View<const std::int32_t> corners) const {
    return {exec_.view(start_), exec_.view(triangle_), corners, exec_.view(vertex_area_),
            exec_.view(mean_area_)};
  }

 private:
  template <class T>
  using Vector = typename Exec::template Vector<T>;

  Exec& exec_;
  Vector<std::int32_t> start_, triangle_;
  Vector<double> vertex_area_, mean_area_;
};

}  // namespace tetwarp
