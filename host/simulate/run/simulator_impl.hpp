/// @file simulator_impl.hpp
/// What a Simulator holds: the scene as a model, its drive, a stepper, the state after the last
/// step.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/run/contact_step.hpp"
#include "host/simulate/run/island_sleep.hpp"
#include "host/simulate/start/rest_growth.hpp"
#include "host/simulate/step/scene_drive.hpp"
#include "host/simulate/step/scene_loads.hpp"
#include "host/simulate/step/step_sums.hpp"
#include "host/simulate/step/stepper.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

class Simulator::Impl {
 public:
  Impl(Scene scene_of_caller, const SimulateOptions& options);

  bool step();
  const StepRecord& record();
  /// World positions of a body's nodes.
  std::vector<Point3> node_positions(std::size_t index) const;
  std::vector<Point3> surface_positions(std::size_t index);
  PositionsView positions(std::size_t index);
  std::vector<std::byte> checkpoint() const;
  void restore(std::span<const std::byte> bytes);

  double time_of(double steps) const { return steps * scene.time_step; }
  void check_body(std::size_t index) const;

  Scene scene;
  SimulateOptions options;
  Backend backend = Backend::cpu;
  SceneGeometry geometry;  ///< refers to paths of `scene`
  Model model;
  SceneDrive drive;
  std::vector<BodyMesh> meshes;
  std::unique_ptr<BodyStepper> stepper;
  SceneSurfaces contact_surfaces;
  std::vector<ContactPoint> contact_points;  ///< at the end of the last step
  std::int64_t step_index = 0;
  /// The state after the last step in memory of the host, copied there if it is not yet.
  const ModelState& state() const;

 private:
  /// How a division of a step into parts went.
  struct Attempt {
    bool is_completed = true;  ///< false: `progress` ended it
    bool is_good = true;       ///< converged, finite, no body turned too far or was held up
    bool is_finite = true;
    StepOutcome outcome;  ///< of all parts
    ContactPart contact;  ///< of all parts
  };
  Attempt attempt(int parts);
  bool advance(int part, double time_step, Attempt& result);
  bool is_good(const Attempt& result, const ContactPart& part, double time_step);
  void end_part(double time_step);
  const std::vector<BodyLink>& sleeping_links() const;
  void begin_sleep();
  void wake(std::span<const std::int32_t> bodies);
  void fall_asleep(const Attempt& made);
  void accept(const Attempt& made, int parts, const StepSeconds& seconds);
  int parts_for_spin() const;
  bool turns_too_far(double time_step) const;
  double largest_spin() const;
  void set_state(const ModelState& next);
  void keep_state();
  void return_to_kept_state();
  bool take_state();
  bool take_steps();
  struct Saved;
  Saved saved() const;
  std::unique_ptr<BodyStepper> make_stepper();
  void make_contact();
  BodyMesh mesh_of(std::size_t body) const;

  mutable ModelState state_;  ///< after the last step, or where a device has that: watched places
  mutable bool is_state_here_ = true;  ///< whether all of state_ is that of the last step
  ResidentState* resident_ = nullptr;  ///< null: every step copies the state to the host
  double largest_spin_ = 0;            ///< of a rigid body after the last step [rad/s]
  double kept_spin_ = 0;               ///< largest_spin_ of the kept state
  SceneLoads loads_;
  std::shared_ptr<RestFactors> rest_factors_;
  ModelState step_start_, part_start_;  ///< kept, so that steps do not allocate them
  StepInput input_;
  StepSums sums_;  ///< of the last step
  double work_ = 0;
  std::unique_ptr<ContactStep> contact_;  ///< null: no two surfaces may touch
  RestGrowth growth_;                     ///< of bodies that started smaller
  IslandSleep sleep_;
  SleepState sleep_start_;            ///< of the running step
  std::int64_t sleeping_ = 0;         ///< contact islands that sleep
  ContactMemory contact_start_;       ///< of the running step
  ContactPart contact_of_step_;       ///< of the last step
  std::int64_t inverted_ = -1;        ///< inverted tetrahedra in state_; -1: not counted
  std::int64_t held_steps_ = 0;       ///< successive ones whose bodies hardly moved
  std::int64_t undivided_steps_ = 0;  ///< to come, which contact does not divide
  std::int64_t substeps_ = 0;
  std::int64_t iterations_before_ = 0;  ///< of the parts of the running step that are done
  StepOutcome outcome_;
  std::optional<StepRecord> record_;
  std::vector<std::vector<ModelPoint>> surfaces_;        ///< [bodies], made when asked for
  std::vector<std::vector<Point3>> scripted_positions_;  ///< [bodies] that positions() refers to
};

}  // namespace tetwarp
