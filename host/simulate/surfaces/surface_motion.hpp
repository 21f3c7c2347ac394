/// @file surface_motion.hpp
/// Where the surfaces of a scene are, and how they move in a step.
#pragma once
#include <span>
#include <vector>

#include "host/collide/collision_surfaces.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/step/resident_surfaces.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// The surfaces as ResidentSurfaces needs them.
/// @param scene  kept by the caller
SurfaceBinding binding_of(const SceneSurfaces& scene);
/// The motion of ResidentSurfaces as a Detector on the same device needs it.
MotionView view_of(const ResidentMotion& motion);

/// World positions of all vertices and planes.
/// @param places  out; memory is kept
void surface_places(const SceneSurfaces& scene,
                    const Model& model,
                    const ModelState& state,
                    int threads,
                    SurfacePlaces& places);

/// The input of frame_motion() and vertex_motion(): nodes move straight, rigid bodies by exp(dt
/// omega), as in BodyStepper::move(). Owns nothing.
struct SurfaceStep {
  const SceneSurfaces& scene;
  const Model& model;
  const ModelState& state;                ///< at the start
  const std::vector<Point3>& velocity;    ///< [block_count] [m/s, rad/s]
  double time_step = 0;                   ///< [s]
  std::span<const double> fraction = {};  ///< [bodies, then obstacles] of the step that each moves,
                                          ///< 0 to 1; empty: 1
};
/// How frames and planes move; sets the sizes of the lists of vertices.
/// @param motion  in: its start from surface_places()
void frame_motion(const SurfaceStep& step, SurfaceMotion& motion);
/// Ends and sagittas of vertices, after frame_motion().
/// @param threads  any number: same motion
void vertex_motion(const SurfaceStep& step, int threads, SurfaceMotion& motion);

}  // namespace tetwarp
