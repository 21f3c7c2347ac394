/// @file part_motion.hpp
/// PartMotion: velocities in a part of a step, and how surfaces move with them.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/collide/collision_surfaces.hpp"
#include "host/simulate/step/resident_surfaces.hpp"
#include "host/simulate/step/stepper.hpp"
#include "host/simulate/surfaces/kept_places.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {

/// A detector requires that all motions of a part begin at the same places and stay in memory until
/// the part ends: each detection has a motion of its own here. A stepper on a device moves the
/// surfaces in memory of that device; the host then has the frames and planes alone, and vertices
/// only after find_vertices().
class PartMotion {
 public:
  /// @param surfaces, model  kept by the caller
  /// @param passes           number of motions, without that of shorten()
  PartMotion(const SceneSurfaces& surfaces, const Model& model, int threads, int passes);

  /// Takes the velocities without contact from a stepper. @returns whether they are finite
  bool take_velocities(const BodyStepper& stepper);
  /// Starts a part of a step of `time_step` seconds.
  /// @param start  kept by the caller until the part ends
  void begin(const ModelState& start, double time_step, BodyStepper& stepper);

  const ModelState& start() const { return *start_; }
  std::size_t passes() const { return motions_.size(); }
  /// Velocities of blocks, [block_count] [m/s, rad/s].
  const std::vector<Point3>& velocity() const { return velocity_; }
  bool is_finite() const;
  /// Whether velocity() is that without contact.
  bool is_free() const { return is_free_; }
  /// Sets velocity() to that without contact.
  void set_free();
  /// velocity(), to be replaced by one with contact.
  std::vector<Point3>& velocity_with_contact();

  /// The motion by velocity() over the part.
  /// @param pass  number of the motion, less than passes()
  const SurfaceMotion& move(std::size_t pass);
  /// The motion of bodies that move a fraction of the part; replaces that of the last shorten().
  /// @param fraction  [bodies, then obstacles] 0 to 1; empty: 1
  const SurfaceMotion& shorten(std::span<const double> fraction);
  /// Computes the vertices of last() on the host, which has them already without a device.
  /// @pre last() is a motion over the whole part
  void find_vertices();
  /// The motion of the last move() or shorten().
  const SurfaceMotion& last() const { return *last_; }

  /// Bodies at the start of the part; valid until it ends.
  const std::vector<BodyPlace>& bodies_at_start() const { return start_places_; }
  /// Bodies in a state; valid until the next call.
  const std::vector<BodyPlace>& bodies_in(const ModelState& state);
  /// Surfaces in a state; valid until the next call of a function that takes a state.
  const SurfacePlaces& surfaces_in(const ModelState& state) { return places_.of(state); }
  /// Surfaces in the state of the stepper of the last begin(), in memory of its device; of a
  /// stepper on the host nothing.
  MotionView surfaces_on_device();

 private:
  const SurfaceMotion& move_into(SurfaceMotion& motion, std::span<const double> fraction);
  void move_vertices(SurfaceMotion& motion, std::span<const double> fraction) const;
  SurfaceStep step_of(std::span<const double> fraction) const;
  void set_places(const ModelState& state,
                  const SurfacePlaces& of,
                  std::vector<BodyPlace>& places) const;

  const SceneSurfaces& surfaces_;
  const Model& model_;
  int threads_;
  const ModelState* start_ = nullptr;
  double time_step_ = 0;                  ///< [s]
  ResidentSurfaces* resident_ = nullptr;  ///< of the stepper; null: on the host
  std::vector<Point3> free_velocity_, velocity_;
  bool is_free_ = true;  ///< velocity_ is what the stepper has
  KeptPlaces places_;
  std::vector<SurfaceMotion> motions_;
  SurfaceMotion shortened_;
  SurfaceMotion* last_ = nullptr;  ///< the only motion that has the places at the start
  std::vector<BodyPlace> start_places_, end_places_;
};

}  // namespace tetwarp
