/// @file simulator.cpp
/// Public calls of Simulator, passed on to the classes that do the work.
#include <tetwarp/simulate.hpp>

#include <utility>

#include "host/simulate/run/body_places.hpp"
#include "host/simulate/run/checkpoint.hpp"
#include "host/simulate/run/divided_step.hpp"
#include "host/simulate/run/moving_bodies.hpp"
#include "host/simulate/run/simulated_scene.hpp"
#include "host/simulate/run/step_count.hpp"
#include "host/simulate/run/step_records.hpp"

namespace tetwarp {

/// The parts of a Simulator; each refers to those above it.
class Simulator::Impl {
 public:
  Impl(Scene scene_of_caller, const SimulateOptions& options)
      : scene(std::move(scene_of_caller), options),
        count(scene.scene.time_step, options.progress),
        clock(options.max_step_seconds),
        bodies(scene, count, clock),
        steps(scene, count, clock, bodies),
        records(scene, count, bodies, steps.last()),
        places(scene, count, bodies) {}

  SimulationState state() {
    return {count.done(),         steps.division(), steps.last(),
            bodies.state().get(), bodies.memory(),  bodies.drive().overrides()};
  }
  void set_state(const SimulationState& state) {
    const auto& [done, division, last, of_bodies, memory, overrides] = state;
    bodies.set_memory(memory);
    bodies.drive().overrides() = overrides;
    bodies.state().set(of_bodies);
    steps.restore(last, division);
    count.set_done(done);
    records.forget();
  }

  SimulatedScene scene;
  StepCount count;
  StepClock clock;
  MovingBodies bodies;
  DividedStep steps;
  StepRecords records;
  BodyPlaces places;
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
  return impl_->bodies.stepper().device();
}

bool Simulator::step() {
  if (!impl_->steps.step()) return false;
  impl_->records.forget();
  return true;
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
  impl_->bodies.drive().move_handle(name, displacement);
}
void Simulator::release_handle(const std::string& name) {
  impl_->bodies.drive().release_handle(name);
}
void Simulator::move_script(const std::string& name,
                            const Point3& displacement,
                            const Point3& axis_angle) {
  impl_->bodies.drive().move_script(name, {displacement, axis_angle});
}

std::vector<std::byte> Simulator::checkpoint() const {
  return write_checkpoint(impl_->scene, impl_->state());
}
void Simulator::restore(std::span<const std::byte> checkpoint) {
  impl_->set_state(read_checkpoint(checkpoint, impl_->scene, impl_->state()));
}

}  // namespace tetwarp
