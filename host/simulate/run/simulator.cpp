#include <tetwarp/simulate.hpp>

#include "host/simulate/run/simulator_impl.hpp"

namespace tetwarp {

Simulator::Simulator(Scene scene, const SimulateOptions& options)
    : impl_(std::make_unique<Impl>(std::move(scene), options)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

const Scene& Simulator::scene() const {
  return impl_->scene;
}
std::int64_t Simulator::step_index() const {
  return impl_->step_index;
}
double Simulator::time() const {
  return impl_->time_of(static_cast<double>(impl_->step_index));
}
Backend Simulator::backend() const {
  return impl_->backend;
}
std::string Simulator::device() const {
  return impl_->stepper->device();
}

bool Simulator::step() {
  return impl_->step();
}
const StepRecord& Simulator::record() {
  return impl_->record();
}

std::vector<ContactPoint> Simulator::contacts() const {
  return impl_->contact_points;
}
double Simulator::thickness() const {
  return impl_->contact_surfaces.surfaces.thickness;
}

const BodyMesh& Simulator::body(std::size_t index) const {
  impl_->check_body(index);
  return impl_->meshes[index];
}
PositionsView Simulator::positions(std::size_t index) const {
  return impl_->positions(index);
}
std::vector<Point3> Simulator::node_positions(std::size_t index) const {
  return impl_->node_positions(index);
}
std::vector<Point3> Simulator::node_velocities(std::size_t index) const {
  impl_->check_body(index);
  const auto first = impl_->state().velocity.begin() + impl_->model.body_node[index];
  return {first, first + (impl_->model.body_node[index + 1] - impl_->model.body_node[index])};
}
std::vector<Point3> Simulator::surface_positions(std::size_t index) const {
  return impl_->surface_positions(index);
}

void Simulator::move_handle(const std::string& name, const Point3& displacement) {
  impl_->drive.move_handle(name, displacement);
}
void Simulator::release_handle(const std::string& name) {
  impl_->drive.release_handle(name);
}
void Simulator::move_script(const std::string& name,
                            const Point3& displacement,
                            const Point3& axis_angle) {
  impl_->drive.move_script(name, {displacement, axis_angle});
}

std::vector<std::byte> Simulator::checkpoint() const {
  return impl_->checkpoint();
}
void Simulator::restore(std::span<const std::byte> checkpoint) {
  impl_->restore(checkpoint);
}

}  // namespace tetwarp
