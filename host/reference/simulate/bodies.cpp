/// @file bodies.cpp
/// Steps, states and records of the reference simulator.
#include "host/reference/simulate/bodies.hpp"

#include <optional>
#include <stdexcept>

#include "host/reference/simulate/body_motion.hpp"
#include "host/reference/simulate/energy.hpp"
#include "host/reference/simulate/forces.hpp"
#include "host/reference/simulate/make_system.hpp"
#include "host/reference/simulate/step_system.hpp"
#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {
namespace {

std::vector<Point3> points_of(const std::vector<Vector3d>& vectors, int first, int count) {
  std::vector<Point3> result;
  for (int i = first; i < first + count; ++i) {
    result.push_back(point_of(vectors[static_cast<std::size_t>(i)]));
  }
  return result;
}

Vector3d sum_of_blocks(const System& system, const BodyPlace& place, const VectorXd& impulse) {
  if (place.rigid >= 0) return impulse.segment<3>(3 * system.linear_block(place.rigid));
  Vector3d sum = Vector3d::Zero();
  for (int n = place.first_node; n < place.first_node + place.node_count; ++n) {
    sum += impulse.segment<3>(3 * n);
  }
  return sum;
}

void add_to(Point3& sum, const Vector3d& part) {
  sum = point_of(vector_of(sum) + part);
}

/// Forces of the last step on bodies, obstacles and couplings.
void record_forces(const System& system, const StepResult& last, StepRecord& record) {
  const double per_time = 1 / system.scene.time_step;
  const std::size_t body_count = system.scene.bodies.size();
  for (std::size_t b = 0; b < body_count; ++b) {
    const BodyPlace& place = system.places[b];
    BodyRecord& of = record.bodies[b];
    add_to(of.support_force, per_time * sum_of_blocks(system, place, last.support));
    for (const VectorXd& load : last.loads) {
      add_to(of.load_force, per_time * sum_of_blocks(system, place, load));
    }
  }
  for (std::size_t s = 0; s < system.springs.size(); ++s) {
    const BindingSpring& spring = system.springs[s];
    const Vector3d force = per_time * last.spring_impulse[s];
    const auto end = [&](const MaterialPoint& point, const Vector3d& on) {
      if (point.body < 0) return;
      const auto b = static_cast<std::size_t>(point.body);
      if (b >= body_count) return;
      add_to(spring.handle >= 0 ? record.bodies[b].handle_force : record.bodies[b].coupling_force,
             on);
    };
    end(spring.a, force);
    end(spring.b, -force);
    if (spring.coupling >= 0) {
      add_to(record.coupling_forces[static_cast<std::size_t>(spring.coupling)], force);
    }
  }
}

}  // namespace

struct ReferenceBodies::Parts {
  System system;
  State state;
  Overrides overrides;
  Prescribed prescribed;  ///< where the state is
  std::int64_t steps = 0;
  std::optional<StepResult> last;
  double work = 0;  ///< by scripts, anchors and loads [J]
};

ReferenceBodies::ReferenceBodies(const Scene& scene, const SceneGeometry& geometry)
    : parts_(std::make_unique<Parts>()) {
  parts_->system = make_system(scene, geometry);
  parts_->state = start_of(parts_->system);
  parts_->overrides = Overrides::none_of(scene);
  parts_->prescribed = prescribed_at(parts_->system, parts_->overrides, 0);
}
ReferenceBodies::~ReferenceBodies() = default;
ReferenceBodies::ReferenceBodies(ReferenceBodies&&) noexcept = default;
ReferenceBodies& ReferenceBodies::operator=(ReferenceBodies&&) noexcept = default;

std::int64_t ReferenceBodies::step_index() const {
  return parts_->steps;
}

double ReferenceBodies::time() const {
  return static_cast<double>(parts_->steps) * parts_->system.scene.time_step;
}

void ReferenceBodies::step() {
  StepDrive drive;
  drive.time_step = parts_->system.scene.time_step;
  drive.end_time = static_cast<double>(parts_->steps + 1) * drive.time_step;
  drive.before = parts_->prescribed;
  drive.after = prescribed_at(parts_->system, parts_->overrides, drive.end_time);
  parts_->last = step_once(parts_->system, parts_->state, drive);
  parts_->work += work_of(parts_->system, drive, *parts_->last);
  parts_->state = parts_->last->state;
  parts_->prescribed = drive.after;
  ++parts_->steps;
}

std::vector<Point3> ReferenceBodies::node_positions(std::size_t body) const {
  const BodyPlace& place = parts_->system.places.at(body);
  return points_of(parts_->state.node, place.first_node, place.node_count);
}

std::vector<Point3> ReferenceBodies::node_velocities(std::size_t body) const {
  const BodyPlace& place = parts_->system.places.at(body);
  return points_of(parts_->state.velocity, place.first_node, place.node_count);
}

std::vector<Point3> ReferenceBodies::surface_positions(std::size_t body) const {
  const System& system = parts_->system;
  std::vector<Point3> result;
  for (const MaterialPoint& point : system.surfaces.at(body)) {
    result.push_back(point_of(position_of(system, parts_->state, point)));
  }
  return result;
}

BodiesState ReferenceBodies::state() const {
  const System& system = parts_->system;
  const State& state = parts_->state;
  BodiesState result;
  result.node_positions = points_of(state.node, 0, system.node_count());
  result.node_velocities = points_of(state.velocity, 0, system.node_count());
  for (std::size_t r = 0; r < system.rigids.size(); ++r) {
    const auto block = static_cast<std::size_t>(system.linear_block(static_cast<int>(r)));
    result.centers.push_back(point_of(state.frame[r].position));
    result.rotations.push_back(quaternion_of(state.frame[r].rotation));
    result.velocities.push_back(point_of(state.velocity[block]));
    result.angular_momenta.push_back(point_of(state.angular_momentum[r]));
  }
  return result;
}

void ReferenceBodies::set_state(const BodiesState& from) {
  const System& system = parts_->system;
  State& state = parts_->state;
  for (std::size_t n = 0; n < state.node.size(); ++n) {
    state.node[n] = vector_of(from.node_positions.at(n));
    state.velocity[n] = vector_of(from.node_velocities.at(n));
  }
  for (std::size_t r = 0; r < system.rigids.size(); ++r) {
    const auto block = static_cast<std::size_t>(system.linear_block(static_cast<int>(r)));
    state.frame[r] = {vector_of(from.centers.at(r)), rotation_of(from.rotations.at(r))};
    state.velocity[block] = vector_of(from.velocities.at(r));
    state.angular_momentum[r] = vector_of(from.angular_momenta.at(r));
    if (system.rigids[r].mass == 0) continue;
    state.velocity[block + 1] = inertia_of(system.rigids[r], state.frame[r].rotation)
                                    .llt()
                                    .solve(state.angular_momentum[r]);
  }
}

std::vector<double> ReferenceBodies::masses(std::size_t body) const {
  const BodyPlace& place = parts_->system.places.at(body);
  if (place.rigid >= 0) {
    return {parts_->system.rigids[static_cast<std::size_t>(place.rigid)].mass};
  }
  const VectorXd sums = parts_->system.mass.rowwise().sum();
  return {sums.data() + place.first_node, sums.data() + place.first_node + place.node_count};
}

std::array<double, 9> ReferenceBodies::inertia(std::size_t body) const {
  const Matrix3d inertia = motion_of(parts_->system, parts_->state, body).inertia;
  std::array<double, 9> rows;
  for (std::size_t i = 0; i < 9; ++i) {
    rows[i] = inertia(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
  }
  return rows;
}

void ReferenceBodies::move_handle(const std::string& name, const Point3& displacement) {
  parts_->overrides.handles[handle_named(parts_->system.scene, name)] =
      Overrides::Handle{false, vector_of(displacement)};
}

void ReferenceBodies::release_handle(const std::string& name) {
  parts_->overrides.handles[handle_named(parts_->system.scene, name)] =
      Overrides::Handle{true, Vector3d::Zero()};
}

void ReferenceBodies::move_script(const std::string& name,
                                  const Point3& displacement,
                                  const Point3& axis_angle) {
  parts_->overrides.bodies[script_named(parts_->system.scene, name)] =
      PathPlace{vector_of(displacement), vector_of(axis_angle)};
}

StepRecord ReferenceBodies::record() const {
  const System& system = parts_->system;
  const State& state = parts_->state;
  StepRecord record;
  record.time = time();
  record.energy = energy_of(system, state, parts_->prescribed);
  record.energy.work = parts_->work;
  record.bodies.resize(system.scene.bodies.size());
  record.obstacle_forces.resize(system.scene.obstacles.size());
  record.coupling_forces.resize(system.scene.couplings.size());
  for (std::size_t b = 0; b < record.bodies.size(); ++b) {
    const BodyMotion motion = motion_of(system, state, b);
    const Vector3d momentum = motion.mass * motion.velocity;
    BodyRecord& of = record.bodies[b];
    of.center = point_of(motion.center);
    of.velocity = point_of(motion.velocity);
    of.angular_momentum = point_of(motion.angular_momentum);
    add_to(record.momentum, momentum);
    add_to(record.angular_momentum, motion.center.cross(momentum) + motion.angular_momentum);
    if (system.places[b].rigid < 0) continue;
    const int block = system.linear_block(system.places[b].rigid) + 1;
    of.rotation =
        quaternion_of(state.frame[static_cast<std::size_t>(system.places[b].rigid)].rotation);
    of.angular_velocity = point_of(state.velocity[static_cast<std::size_t>(block)]);
  }
  for (const Element& element : system.elements) {
    const Matrix3d deformation = positions_of(element, state) * element.gradients.transpose();
    record.inverted += deformation.determinant() < 0;
  }
  if (parts_->last) record_forces(system, *parts_->last, record);
  return record;
}

}  // namespace tetwarp::reference
