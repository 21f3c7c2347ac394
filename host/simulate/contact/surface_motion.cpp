#include <algorithm>
#include <cmath>

#include "host/base/parallel.hpp"
#include "host/simulate/body_points.hpp"
#include "host/simulate/contact/scene_surfaces.hpp"
#include "host/simulate/rotations.hpp"
#include "kernels/body/rigid_midpoint.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t vertices_per_task = 512;

/// task(begin, end) for ranges that cover [0, count).
template <class Task>
void for_ranges(int threads, std::int64_t count, const Task& task) {
  const std::int64_t tasks = (count + vertices_per_task - 1) / vertices_per_task;
  parallel_tasks(threads, tasks, [&](std::int64_t t) {
    task(t * vertices_per_task, std::min(count, (t + 1) * vertices_per_task));
  });
}

/// Where a frame is after a part of a step.
struct MovedFrame {
  std::int32_t rigid = -1;
  Point3 start{0, 0, 0}, end{0, 0, 0};  ///< centre
  Quaternion rotation{1, 0, 0, 0};      ///< at the end
  Point3 axis{0, 0, 0};                 ///< unit, of the turn
  double angle = 0;                     ///< of the turn [rad]
};

class StepMotion {
 public:
  StepMotion(const Model& model,
             const ModelState& state,
             const std::vector<Point3>& velocity,
             double time_step,
             std::span<const double> fraction)
      : model_(model),
        state_(state),
        velocity_(velocity),
        time_step_(time_step),
        fraction_(fraction) {}

  double seconds_of(std::int32_t body) const {
    return fraction_.empty() ? time_step_ : time_step_ * fraction_[static_cast<std::size_t>(body)];
  }

  MovedFrame moved_frame(std::int32_t rigid, double seconds) const {
    const std::int32_t block = model_.node_count + 2 * rigid;
    MovedFrame frame;
    frame.rigid = rigid;
    frame.start = at(state_.position, model_.node_count + rigid);
    frame.end = plus(frame.start, times(seconds, at(velocity_, block)));
    frame.rotation = at(state_.rotation, rigid);
    const Point3 turn = times(seconds, at(velocity_, block + 1));
    frame.angle = norm(turn);
    frame.axis = unit(turn);
    if (frame.angle > 0) turn_by_vector(turn.data(), frame.rotation.data());
    return frame;
  }

  /// Of a point that is not fixed in a frame, as position_of().
  Point3 moved_point(const ModelPoint& point, double seconds) const {
    if (point.node[0] < 0) return point.local;
    Point3 x{0, 0, 0};
    for (std::size_t a = 0; a < 4 && point.node[a] >= 0; ++a) {
      const Point3 node =
          plus(at(state_.position, point.node[a]), times(seconds, at(velocity_, point.node[a])));
      x = plus(x, times(point.weight[a], node));
    }
    return x;
  }

 private:
  const Model& model_;
  const ModelState& state_;
  const std::vector<Point3>& velocity_;
  double time_step_;
  std::span<const double> fraction_;
};

/// The farthest that a point on a circle of radius r, which turns by an angle, is from the point
/// that goes straight from its start to its end: linear interpolation errs by at most 1/8 of the
/// second derivative.
double sagitta_of(const MovedFrame& frame, const Point3& arm) {
  const double radius = norm(cross(frame.axis, arm));
  return radius * frame.angle * frame.angle / 8;
}

}  // namespace

void surface_places(const SceneSurfaces& scene,
                    const Model& model,
                    const ModelState& state,
                    int threads,
                    SurfacePlaces& places) {
  const auto count = static_cast<std::int64_t>(scene.vertex_point.size());
  places.vertices.resize(scene.vertex_point.size());
  for_ranges(threads, count, [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
      places.vertices[v] = position_of(scene.vertex_point[v], state, model.node_count);
    }
  });
  places.planes.resize(scene.plane_local.size());
  for (std::size_t p = 0; p < scene.plane_local.size(); ++p) {
    const std::int32_t rigid = scene.plane_rigid[p];
    const Quaternion& rotation = at(state.rotation, rigid);
    const PlanePlace& local = scene.plane_local[p];
    places.planes[p] = {
        plus(at(state.position, model.node_count + rigid), rotate(rotation, local.point)),
        unit(rotate(rotation, local.normal))};
  }
}

void surface_motion(const SceneSurfaces& scene,
                    const Model& model,
                    const ModelState& state,
                    const std::vector<Point3>& velocity,
                    double time_step,
                    std::span<const double> fraction,
                    int threads,
                    SurfaceMotion& motion) {
  const StepMotion step(model, state, velocity, time_step, fraction);
  const auto count = static_cast<std::int64_t>(scene.vertex_point.size());
  motion.end.vertices.resize(scene.vertex_point.size());
  motion.sagitta.resize(scene.vertex_point.size());
  for_ranges(threads, count, [&](std::int64_t begin, std::int64_t end) {
    MovedFrame frame;  // successive vertices are often of the same body
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
      const ModelPoint& point = scene.vertex_point[v];
      const double seconds = step.seconds_of(scene.surfaces.vertex_body[v]);
      motion.sagitta[v] = 0;
      if (point.rigid < 0) {
        motion.end.vertices[v] = step.moved_point(point, seconds);
        continue;
      }
      if (frame.rigid != point.rigid) frame = step.moved_frame(point.rigid, seconds);
      motion.end.vertices[v] = plus(frame.end, rotate(frame.rotation, point.local));
      if (frame.angle > 0) {
        motion.sagitta[v] = sagitta_of(frame, minus(motion.start.vertices[v], frame.start));
      }
    }
  });
  motion.frames.resize(scene.body_rigid.size());
  for (std::size_t b = 0; b < scene.body_rigid.size(); ++b) {
    motion.frames[b] = {};
    if (scene.body_rigid[b] < 0) continue;
    const double seconds = step.seconds_of(static_cast<std::int32_t>(b));
    const MovedFrame frame = step.moved_frame(scene.body_rigid[b], seconds);
    for (std::size_t i = 0; i < 3 && frame.angle > 0; ++i) {
      motion.frames[b].centre[i] = frame.start[i];
      motion.frames[b].motion[i] = frame.end[i] - frame.start[i];
      motion.frames[b].turn[i] = frame.angle * frame.axis[i];
    }
  }
  motion.end.planes.resize(scene.plane_local.size());
  for (std::size_t p = 0; p < scene.plane_local.size(); ++p) {
    const MovedFrame frame =
        step.moved_frame(scene.plane_rigid[p], step.seconds_of(scene.surfaces.plane_body[p]));
    const PlanePlace& local = scene.plane_local[p];
    motion.end.planes[p] = {plus(frame.end, rotate(frame.rotation, local.point)),
                            unit(rotate(frame.rotation, local.normal))};
  }
}

}  // namespace tetwarp
