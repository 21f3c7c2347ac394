/// @file scene_drive.hpp
/// What scripts, paths, anchors and loads prescribe at the end of a step.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/model/motion.hpp"
#include "host/simulate/step/resident_state.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// What callers have moved away from its path.
struct DriveOverrides {
  /// [handles] displacement of the anchors: nothing: by the path; nothing inside: released.
  std::vector<std::optional<std::optional<Point3>>> handles;
  std::vector<std::optional<PathPlace>> scripts;  ///< [bodies, then obstacles]
};

/// What goes on from step to step.
struct DriveState {
  /// [handles] displacement of the anchors at the end of the last step; nothing: let go.
  std::vector<std::optional<Point3>> handles;
  /// [bodies, then obstacles] by how much each is behind its path [s].
  std::vector<double> delays;
};

class SceneDrive {
 public:
  /// @param scene, geometry, model  kept by the caller
  SceneDrive(const Scene& scene, const SceneGeometry& geometry, const Model& model);

  /// Fills velocities, anchors and forces of a step that begins in `state`.
  /// @param end_time   [s], at which paths are sampled
  /// @param time_step  [s] of this step, a part of the scene's where it is divided
  void fill(const ModelState& state, double end_time, double time_step, StepInput& input);
  /// Adds the places that fill() reads of a state.
  void add_places(StatePlaces& places) const;
  /// Call when the step that fill() prepared has been made.
  void accept() { now_.handles = next_handles_; }
  /// Delays the paths of bodies and obstacles that moved only a part of a step.
  /// @param fraction  [bodies, then obstacles] of the step that each moved
  void delay(std::span<const double> fraction, double time_step);

  /// World positions of the nodes of a scripted body where its path is at a time, delayed, without
  /// the rounding of steps: a period of a wave returns the same bits.
  std::vector<Point3> scripted_positions(std::size_t body, double time) const;

  /// @throws std::invalid_argument  naming what there is
  void move_handle(const std::string& name, const Point3& displacement);
  void release_handle(const std::string& name);
  void move_script(const std::string& name, const PathPlace& place);

  const DriveState& state() const { return now_; }
  void set_state(const DriveState& state) { now_ = state; }
  DriveOverrides& overrides() { return overrides_; }
  const DriveOverrides& overrides() const { return overrides_; }

 private:
  std::size_t handle_named(const std::string& name) const;
  /// Of bodies, then obstacles; `time` is delayed already.
  Pose frame_of(std::size_t body, double time) const;
  std::optional<Point3> handle_at(std::size_t handle, double time) const;
  void fill_prescribed(const ModelState& state, double end_time, double dt, StepInput& input) const;
  void fill_anchors(double end_time, double dt, StepInput& input);

  const Scene& scene_;
  const SceneGeometry& geometry_;
  const Model& model_;
  std::vector<WaveMotion> waves_;  ///< [bodies]; of bodies that are not scripted: no points
  DriveOverrides overrides_;
  DriveState now_;
  std::vector<std::optional<Point3>> next_handles_;
};

}  // namespace tetwarp
