/// @file simulator.cpp
/// Public calls of Simulator, passed on to the classes that do the work.
#include <tetwarp/simulate.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>

#include "host/simulate/run/body_places.hpp"
#include "host/simulate/run/divided_step.hpp"
#include "host/simulate/run/moving_bodies.hpp"
#include "host/simulate/run/step_records.hpp"
#include "host/simulate/state/added_handles.hpp"
#include "host/simulate/state/checkpoint.hpp"
#include "host/simulate/state/fingerprint.hpp"
#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/state/step_count.hpp"

namespace tetwarp {

/// The parts of a Simulator; each refers to those above it.
class Simulator::Impl {
 public:
  Impl(Scene scene_of_caller, const SimulateOptions& options)
      : scene(std::move(scene_of_caller), options),
        count(scene.scene.time_step, options.progress),
        clock(options.max_step_seconds),
        bodies(std::in_place, scene, count, clock),
        steps(scene, count, clock, *bodies),
        records(scene, count, *bodies, steps.last()),
        places(scene, count, *bodies) {}

  /// @param limit  nothing: the clock
  bool step(const std::optional<StepLimit>& limit) {
    clock.follow(limit);
    if (!steps.step()) return false;
    records.forget();
    return true;
  }

  std::uint64_t own_fingerprint() {
    if (!fingerprint) fingerprint = fingerprint_of(scene);
    return *fingerprint;
  }

  SimulationState state() {
    return {count.done(),     steps.division(),
            steps.last(),     bodies->state().get(),
            bodies->memory(), bodies->drive().overrides(),
            scene.added};
  }
  void set_state(const SimulationState& state) {
    const auto& [done, division, last, of_bodies, memory, overrides, added] = state;
    if (added != scene.added) set_handles(added);
    bodies->set_memory(memory);
    bodies->drive().overrides() = overrides;
    bodies->state().set(of_bodies);
    steps.restore(last, division);
    count.set_done(done);
    records.forget();
  }

  /// Adds a handle that nothing has moved yet.
  void add(const AddedHandle& handle) {
    own_fingerprint();  // of the scene alone
    SimulationState next = state();
    const std::size_t own = scene.scene.handles.size() - scene.added.size();
    const auto place = std::ranges::find(next.added, handle.name, &AddedHandle::name);
    const std::size_t index = own + static_cast<std::size_t>(place - next.added.begin());
    if (place != next.added.end()) {
      *place = handle;
    } else {
      next.added.push_back(handle);
    }
    next.memory.drive.handles.resize(own + next.added.size());
    next.overrides.handles.resize(own + next.added.size());
    next.memory.drive.handles[index].reset();
    next.overrides.handles[index].reset();
    set_state(next);
  }

  /// Makes the bodies anew, at the same place: the other parts refer to them.
  void set_handles(const std::vector<AddedHandle>& added) {
    RestGrowth growth = bodies->growth();
    set_added_handles(scene, added);
    bodies.emplace(scene, count, clock, std::move(growth));
  }

  SimulatedScene scene;
  StepCount count;
  StepClock clock;
  std::optional<MovingBodies> bodies;
  DividedStep steps;
  StepRecords records;
  BodyPlaces places;
  std::optional<std::uint64_t> fingerprint;  ///< of the scene without added handles
};

Simulator::Simulator(Scene scene, const SimulateOptions& options)
    : impl_(std::make_unique<Impl>(std::move(scene), options)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

const Scene& Simulator::scene() const {
  return impl_->scene.scene;
}
std::int64_t Simulator::step_index() const {
  return impl_->count.done();
}
double Simulator::time() const {
  return impl_->count.time();
}
Backend Simulator::backend() const {
  return impl_->scene.backend;
}
std::string Simulator::device() const {
  return impl_->bodies->stepper().device();
}

bool Simulator::step() {
  return impl_->step({});
}
bool Simulator::step(const StepLimit& limit) {
  if (!impl_->clock.is_limited()) {
    throw std::invalid_argument("step: ends at counts only where max_step_seconds is finite");
  }
  return impl_->step(limit);
}
StepLimit Simulator::step_limit() const {
  return impl_->clock.limit();
}
const StepRecord& Simulator::record() {
  return impl_->records.get();
}

std::vector<ContactPoint> Simulator::contacts() const {
  return impl_->steps.last().points;
}
double Simulator::thickness() const {
  return impl_->scene.surfaces.surfaces.thickness;
}

const BodyMesh& Simulator::body(std::size_t index) const {
  return impl_->places.mesh(index);
}
PositionsView Simulator::positions(std::size_t index) const {
  return impl_->places.positions(index);
}
std::vector<Point3> Simulator::node_positions(std::size_t index) const {
  return impl_->places.node_positions(index);
}
std::vector<Point3> Simulator::node_velocities(std::size_t index) const {
  return impl_->places.node_velocities(index);
}
std::vector<Point3> Simulator::surface_positions(std::size_t index) const {
  return impl_->places.surface_positions(index);
}

void Simulator::move_handle(const std::string& name, const Point3& displacement) {
  impl_->bodies->drive().move_handle(name, displacement);
}
void Simulator::release_handle(const std::string& name) {
  impl_->bodies->drive().release_handle(name);
}
void Simulator::add_handle(const PointHandle& handle) {
  impl_->add(make_added_handle(impl_->scene, handle, impl_->bodies->state().get()));
}
void Simulator::move_script(const std::string& name,
                            const Point3& displacement,
                            const Point3& axis_angle) {
  impl_->bodies->drive().move_script(name, {displacement, axis_angle});
}

std::vector<std::byte> Simulator::checkpoint() const {
  return write_checkpoint(impl_->own_fingerprint(), impl_->state());
}
void Simulator::restore(std::span<const std::byte> checkpoint) {
  impl_->set_state(
      read_checkpoint(checkpoint, impl_->own_fingerprint(), impl_->scene, impl_->state()));
}

}  // namespace tetwarp
