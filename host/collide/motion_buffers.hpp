/// @file motion_buffers.hpp
/// MotionBuffers: a motion of surfaces as stages read it.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// Checks the sizes of motions. Copies them where an executor needs a copy.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class MotionBuffers {
 public:
  /// @param surfaces  kept by the caller
  MotionBuffers(Exec& exec, const CollisionSurfaces& surfaces) : exec_(exec), surfaces_(surfaces) {
    const std::vector<double> zeros(surfaces.vertex_body.size());
    exec_.put(zeros, no_sagitta_);
  }

  /// @returns the motion, valid until the next call; motion.resident where that is given
  /// @throws std::invalid_argument  other numbers of vertices, planes or frames than the surfaces
  MotionView view_of(const SurfaceMotion& motion) {
    check(motion.start);
    check(motion.end);
    if (!motion.frames.empty() && motion.frames.size() != surfaces_.bodies.size()) {
      throw std::invalid_argument("collision detection: frames of " +
                                  std::to_string(motion.frames.size()) + " bodies, expected " +
                                  std::to_string(surfaces_.bodies.size()));
    }
    if (is_given(motion.resident)) return motion.resident;
    return {points(motion.start.vertices, start_),
            points(motion.end.vertices, end_),
            exec_.input(motion.sagitta.data(), std::ssize(motion.sagitta), sagitta_),
            plane_numbers(motion.start.planes, plane_start_),
            plane_numbers(motion.end.planes, plane_end_),
            exec_.input(motion.frames.data(), std::ssize(motion.frames), frames_)};
  }

  /// The same for surfaces that stay at their places.
  MotionView view_of(const SurfacePlaces& places, const MotionView& resident) {
    check(places);
    if (is_given(resident)) return resident;
    const View<const double> vertices = points(places.vertices, start_);
    const View<const double> planes = plane_numbers(places.planes, plane_start_);
    return {vertices, vertices, exec_.view(std::as_const(no_sagitta_)), planes, planes, {}};
  }

 private:
  template <class T>
  using Vector = typename Exec::template Vector<T>;

  static bool is_given(const MotionView& resident) {
    return resident.start.size > 0 || resident.plane_start.size > 0;
  }
  void check(const SurfacePlaces& places) const {
    if (places.vertices.size() == surfaces_.vertex_body.size() &&
        places.planes.size() == surfaces_.plane_body.size()) {
      return;
    }
    throw std::invalid_argument("collision detection: places of " +
                                std::to_string(places.vertices.size()) + " vertices and " +
                                std::to_string(places.planes.size()) + " planes, expected " +
                                std::to_string(surfaces_.vertex_body.size()) + " and " +
                                std::to_string(surfaces_.plane_body.size()));
  }
  View<const double> points(const std::vector<Point3>& host, Vector<double>& own) {
    return exec_.input(host.empty() ? nullptr : host[0].data(), 3 * std::ssize(host), own);
  }
  View<const double> plane_numbers(const std::vector<PlanePlace>& host, Vector<double>& own) {
    static_assert(sizeof(PlanePlace) == 6 * sizeof(double));
    return exec_.input(host.empty() ? nullptr : host[0].point.data(), 6 * std::ssize(host), own);
  }

  Exec& exec_;
  const CollisionSurfaces& surfaces_;
  Vector<double> start_, end_, sagitta_, no_sagitta_, plane_start_, plane_end_;
  Vector<TurningFrame> frames_;
};

}  // namespace tetwarp
