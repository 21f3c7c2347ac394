/// @file area_buffers.hpp
/// AreaBuffers: the areas of vertices in memory of an executor.
#pragma once
#include <cstdint>
#include <vector>

#include "host/collide/touch_areas.hpp"

namespace tetwarp {

/// Constant during a simulation.
/// @tparam Exec  CpuDetectExec or CudaDetectExec
template <class Exec>
class AreaBuffers {
 public:
  AreaBuffers(Exec& exec, const CollisionSurfaces& surfaces) : exec_(exec) {
    const TouchAreas areas(surfaces);
    put(areas.start, start_);
    put(areas.triangle, triangle_);
    put(areas.mean_area, mean_area_);
    put(surfaces.vertex_area, vertex_area_);
  }

  /// @param corners  of triangles, [triangles][3]
  TouchAreaView view(View<const std::int32_t> corners) const {
    return {exec_.view(start_), exec_.view(triangle_), corners, exec_.view(vertex_area_),
            exec_.view(mean_area_)};
  }

 private:
  template <class T>
  using Vector = typename Exec::template Vector<T>;

  template <class T>
  void put(const std::vector<T>& host, Vector<T>& own) {
    exec_.put(host.data(), std::ssize(host), own);
  }

  Exec& exec_;
  Vector<std::int32_t> start_, triangle_;
  Vector<double> vertex_area_, mean_area_;
};

}  // namespace tetwarp
