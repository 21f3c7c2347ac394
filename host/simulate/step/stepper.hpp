/// @file stepper.hpp
/// BodyStepper: advances the state of a Model by one step on some back end.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/mesh.hpp>
#include <tetwarp/simulate.hpp>

#include "host/simulate/model/model.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

class DeviceStepper;
class IslandFactors;
class RestFactors;
class StepClock;

/// What acts from outside in one step. Sizes are those of the model.
struct StepInput {
  double time_step = 0;                     ///< [s]
  Point3 gravity{0, 0, 0};                  ///< [m/s^2]
  std::vector<Point3> prescribed_velocity;  ///< [block_count], read where prescribed
  std::vector<Point3> block_force;      ///< [block_count] of loads: forces [N], of angular blocks
                                        ///< torques [N m]
  std::vector<Point3> anchor;           ///< [springs] world position at the end of the step of b of
                                        ///< the springs of handles
  std::vector<Point3> anchor_velocity;  ///< [springs] of it over the step [m/s]; their damping acts
                                        ///< on the velocity relative to it
  std::vector<std::uint8_t> is_active;  ///< [springs] 0: of a handle that has let go
  std::vector<std::uint8_t> is_asleep = {};  ///< [block_count] unknowns that stand still, coupled
                                             ///< to no other unknowns; or empty: none
  std::vector<Point3> guess = {};  ///< [block_count] velocities that the solve starts from, or
                                   ///< empty: those of the state
  double end_time = 0;             ///< [s] at which paths and loads have been sampled
};

/// What a step did.
struct StepOutcome {
  bool completed = true;  ///< false: `progress` ended it and the state is as before
  bool converged = true;
  std::int64_t linear_iterations = 0;  ///< of the island that took the most
  double linear_residual = 0;          ///< largest of an island, relative; infinite beyond numbers
  std::int64_t skipped_rotations = 0, skipped_blocks = 0;
  StepSeconds seconds;
};

struct StepperOptions {
  double linear_tolerance = 1e-6;  ///< |r|_{D^-1} <= tolerance |b|_{D^-1}
  std::int64_t max_iterations = 10000;
  int threads = 1;
  int device = 0;
  bool float32_solve = false;
  SimulateSkipOptions skip = {};
  std::shared_ptr<RestFactors> factors = {};  ///< of elastic bodies, or null: own ones; cpu only
  std::function<bool(std::int64_t linear_iterations)> progress = {};  ///< false ends the step
  StepClock* clock = nullptr;  ///< kept by the caller: where it is over the solve ends with the
                               ///< velocities that it has; null: no limit
};

/// The linear system A v = b of a step, in memory of the host: rows as SystemRows, blocks column by
/// column. b of rows with unknowns is without the prescribed columns.
struct StepSystem {
  SystemRows rows;
  View<const double> values;    ///< [places][9]
  View<const double> load;      ///< b, [rows][3]
  View<const double> velocity;  ///< v without contact, [rows][3]
  /// [coupling islands] those that the linear solve has made, or null: none.
  std::vector<IslandFactors>* factors = nullptr;
};

class BodyStepper {
 public:
  virtual ~BodyStepper() = default;
  virtual std::string device() const = 0;
  virtual void set_state(const ModelState& state) = 0;
  virtual void get_state(ModelState& state) const = 0;
  /// Solves for the velocities at the end of the step, without contact. Nothing moves.
  virtual StepOutcome solve(const StepInput& input) = 0;
  /// The system that solve() solved, copied at the first call after it; valid until move().
  virtual StepSystem system() = 0;
  /// Velocities of all blocks after solve(), [block_count].
  virtual void get_velocities(std::vector<Point3>& velocity) const = 0;
  /// Replaces them by those with contact.
  virtual void set_velocities(const std::vector<Point3>& velocity) = 0;
  /// Moves the bodies by their velocities and updates the angular momenta.
  /// @param fraction  [bodies, then obstacles] of the step that each moves, 0 to 1; empty: 1.
  ///                  Velocities and angular momenta are those of the whole step
  /// @returns the seconds that it took
  virtual double move(double time_step, std::span<const double> fraction) = 0;
  /// solve() and move().
  StepOutcome step(const StepInput& input) {
    StepOutcome outcome = solve(input);
    if (!outcome.completed) return outcome;
    outcome.seconds.update = move(input.time_step, {});
    outcome.seconds.total += outcome.seconds.update;
    return outcome;
  }
  /// Impulses [N s, N m s] that kept the prescribed blocks on their velocities in the last step:
  /// A v - b there, zero elsewhere; [block_count]. With contact those of contacts, J^T r, are part
  /// of them.
  virtual std::vector<Point3> support_impulses() const = 0;
  /// Positions of successive nodes, in memory of the back end, valid until the next step.
  virtual PositionsView positions(std::int32_t first_node, std::int32_t count) const = 0;
  /// This stepper, if its state is in memory of a device; else null.
  virtual DeviceStepper* on_device() { return nullptr; }
};

/// @param model  kept by the caller
std::unique_ptr<BodyStepper> make_cpu_stepper(const Model& model, const StepperOptions& options);
/// @throws CudaError  without CUDA or a usable device
std::unique_ptr<BodyStepper> make_cuda_stepper(const Model& model, const StepperOptions& options);

}  // namespace tetwarp
