/// @file part_motion.cpp
/// Moves surfaces along the velocities of a part of a step, on the host or on a device.
#include "host/simulate/contact_step/part_motion.hpp"

#include <algorithm>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/step/device_stepper.hpp"

namespace tetwarp {
namespace {

bool are_finite(const std::vector<Point3>& list) {
  return std::all_of(list.begin(), list.end(), [](const Point3& x) { return is_finite(x); });
}

}  // namespace

PartMotion::PartMotion(const SceneSurfaces& surfaces, const Model& model, int threads, int passes)
    : surfaces_(surfaces),
      model_(model),
      threads_(threads),
      places_(surfaces, model, threads),
      motions_(index_of(passes)) {}

bool PartMotion::take_velocities(const BodyStepper& stepper) {
  stepper.get_velocities(free_velocity_);
  return are_finite(free_velocity_);
}

void PartMotion::begin(const ModelState& start, double time_step, BodyStepper& stepper) {
  start_ = &start;
  time_step_ = time_step;
  last_ = &motions_[0];
  places_.take(start, last_->start);
  set_places(start, last_->start, start_places_);
  DeviceStepper* const device = stepper.on_device();
  resident_ = device != nullptr ? &device->resident_surfaces() : nullptr;
  if (resident_ != nullptr) resident_->begin(binding_of(surfaces_));
}

bool PartMotion::is_finite() const {
  return are_finite(velocity_);
}

void PartMotion::set_free() {
  velocity_ = free_velocity_;
  is_free_ = true;
}

std::vector<Point3>& PartMotion::velocity_with_contact() {
  is_free_ = false;
  return velocity_;
}

const SurfaceMotion& PartMotion::move(std::size_t pass) {
  return move_into(motions_[pass], {});
}

const SurfaceMotion& PartMotion::shorten(std::span<const double> fraction) {
  return move_into(shortened_, fraction);
}

void PartMotion::find_vertices() {
  if (resident_ != nullptr) move_vertices(*last_, {});
}

SurfaceStep PartMotion::step_of(std::span<const double> fraction) const {
  return {surfaces_, model_, *start_, velocity_, time_step_, fraction};
}

const SurfaceMotion& PartMotion::move_into(SurfaceMotion& motion,
                                           std::span<const double> fraction) {
  if (&motion != last_) std::swap(motion.start, last_->start);
  last_ = &motion;
  frame_motion(step_of(fraction), motion);
  if (resident_ == nullptr) {
    move_vertices(motion, fraction);
  } else {
    const std::span<const Point3> velocity =
        is_free_ ? std::span<const Point3>{} : std::span(velocity_);
    motion.resident = view_of(resident_->move(velocity, time_step_, fraction));
  }
  return motion;
}

void PartMotion::move_vertices(SurfaceMotion& motion, std::span<const double> fraction) const {
  vertex_motion(step_of(fraction), threads_, motion);
}

void PartMotion::set_places(const ModelState& state,
                            const SurfacePlaces& of,
                            std::vector<BodyPlace>& places) const {
  places.resize(surfaces_.surfaces.bodies.size());
  for (std::size_t b = 0; b < places.size(); ++b) {
    places[b] = {};
    const CollisionBody& body = surfaces_.surfaces.bodies[b];
    if (body.is_rigid) {
      const auto rigid = index_of(surfaces_.body_rigid[b]);
      places[b].pose = {state.position[index_of(model_.node_count) + rigid], state.rotation[rigid]};
    } else {
      places[b].vertices = {of.vertices.data() + body.first_vertex,
                            index_of(body.vertex_end - body.first_vertex)};
    }
  }
}

const std::vector<BodyPlace>& PartMotion::bodies_in(const ModelState& state) {
  set_places(state, places_.of(state), end_places_);
  return end_places_;
}

MotionView PartMotion::surfaces_on_device() {
  if (resident_ == nullptr) return {};
  resident_->begin(binding_of(surfaces_));
  return view_of(resident_->move({}, 0, {}));
}

}  // namespace tetwarp
