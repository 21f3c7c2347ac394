/// @file surface_motion.cpp
/// Moves vertices and planes by the same functions as a device.
#include "host/simulate/surfaces/surface_motion.hpp"

#include <algorithm>

#include "host/base/parallel.hpp"
#include "host/simulate/model/state_view.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t vertices_per_task = 512;

/// Calls task(begin, end) for ranges that cover [0, count).
template <class Task>
void for_ranges(int threads, std::size_t count, const Task& task) {
  const auto size = static_cast<std::int64_t>(count);
  const std::int64_t tasks = (size + vertices_per_task - 1) / vertices_per_task;
  parallel_tasks(threads, tasks, [&](std::int64_t t) {
    task(static_cast<std::size_t>(t * vertices_per_task),
         static_cast<std::size_t>(std::min(size, (t + 1) * vertices_per_task)));
  });
}

/// A PlanePlace or a TurningFrame as the numbers that stages write.
template <class T>
double* numbers_of(T& value) {
  return reinterpret_cast<double*>(&value);
}
template <class T>
const double* numbers_of(const T& value) {
  return reinterpret_cast<const double*>(&value);
}
static_assert(sizeof(PlanePlace) == 6 * sizeof(double));
static_assert(sizeof(TurningFrame) == 9 * sizeof(double));

SurfaceState state_of(const SurfaceStep& step) {
  return view_of_state(step.state, step.model.node_count);
}
SurfaceVelocity velocity_of(const SurfaceStep& step) {
  return view_of_velocity(step.velocity, step.model.node_count, step.time_step, step.fraction);
}

}  // namespace

SurfaceBinding binding_of(const SceneSurfaces& scene) {
  const auto& local = scene.plane_local;
  return {scene.vertex_point,
          scene.surfaces.vertex_body,
          scene.body_rigid,
          scene.plane_rigid,
          scene.surfaces.plane_body,
          {local.empty() ? nullptr : numbers_of(local[0]), 6 * local.size()}};
}

MotionView view_of(const ResidentMotion& motion) {
  return {motion.start,
          motion.end,
          motion.sagitta,
          motion.plane_start,
          motion.plane_end,
          {reinterpret_cast<const TurningFrame*>(motion.frames.data), motion.frames.size / 9}};
}

void surface_places(const SceneSurfaces& scene,
                    const Model& model,
                    const ModelState& state,
                    int threads,
                    SurfacePlaces& places) {
  const SurfaceState at = view_of_state(state, model.node_count);
  places.vertices.resize(scene.vertex_point.size());
  for_ranges(threads, scene.vertex_point.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      start_of(scene.vertex_point[v], at, places.vertices[v].data());
    }
  });
  places.planes.resize(scene.plane_local.size());
  for (std::size_t p = 0; p < scene.plane_local.size(); ++p) {
    const std::int64_t rigid = scene.plane_rigid[p];
    frame_plane(at.center.data + 3 * rigid, at.rotation.data + 4 * rigid,
                numbers_of(scene.plane_local[p]), numbers_of(places.planes[p]));
  }
}

void vertex_motion(const SurfaceStep& step, int threads, SurfaceMotion& motion) {
  const SceneSurfaces& scene = step.scene;
  const SurfaceState at = state_of(step);
  const SurfaceVelocity by = velocity_of(step);
  for_ranges(threads, scene.vertex_point.size(), [&](std::size_t begin, std::size_t end) {
    MovedFrame frame{};
    std::int32_t rigid = -1;  // frame of the last vertex; successive ones often have the same
    for (std::size_t v = begin; v < end; ++v) {
      const ModelPoint& point = scene.vertex_point[v];
      const double seconds = by.seconds_of(scene.surfaces.vertex_body[v]);
      if (point.rigid >= 0 && point.rigid != rigid) {
        rigid = point.rigid;
        frame = moved_frame(at, by, rigid, seconds);
      }
      motion.sagitta[v] = move_point(point, at, by, seconds, frame, motion.start.vertices[v].data(),
                                     motion.end.vertices[v].data());
    }
  });
}

void frame_motion(const SurfaceStep& step, SurfaceMotion& motion) {
  const SceneSurfaces& scene = step.scene;
  const SurfaceState at = state_of(step);
  const SurfaceVelocity by = velocity_of(step);
  motion.end.vertices.resize(scene.vertex_point.size());
  motion.sagitta.resize(scene.vertex_point.size());
  motion.frames.resize(scene.body_rigid.size());
  for (std::size_t b = 0; b < scene.body_rigid.size(); ++b) {
    MovedFrame frame{};
    if (const std::int32_t rigid = scene.body_rigid[b]; rigid >= 0) {
      frame = moved_frame(at, by, rigid, by.seconds_of(static_cast<std::int64_t>(b)));
    }
    turn_of(frame, numbers_of(motion.frames[b]));
  }
  motion.end.planes.resize(scene.plane_local.size());
  for (std::size_t p = 0; p < scene.plane_local.size(); ++p) {
    const MovedFrame frame =
        moved_frame(at, by, scene.plane_rigid[p], by.seconds_of(scene.surfaces.plane_body[p]));
    frame_plane(frame.end, frame.rotation, numbers_of(scene.plane_local[p]),
                numbers_of(motion.end.planes[p]));
  }
}

}  // namespace tetwarp
