#include "host/simulate/simulator_impl.hpp"

#include <algorithm>
#include <stdexcept>

#include "host/base/parallel.hpp"
#include "host/simulate/body_points.hpp"
#include "host/simulate/checkpoint.hpp"
#include "host/simulate/reference_stepper.hpp"
#include "host/simulate/rotations.hpp"
#include "host/simulate/scene_record.hpp"

namespace tetwarp {
namespace {

constexpr std::uint64_t checkpoint_version = 0x7477'7363'0000'0001;  // "twsc", 1

double mass_of(const Model& model, std::size_t body) {
  double mass = 0;
  for (std::int32_t n = model.body_node[body]; n < model.body_node[body + 1]; ++n) {
    mass += model.node_mass[static_cast<std::size_t>(n)];
  }
  const std::int32_t rigid = model.body_rigid[body];
  return rigid < 0 ? mass : model.rigid.mass[static_cast<std::size_t>(rigid)];
}

Scene checked(Scene scene) {
  check_scene(scene);
  return scene;
}

}  // namespace

Simulator::Impl::Impl(Scene scene_of_caller, const SimulateOptions& options_of_caller)
    : scene(checked(std::move(scene_of_caller))),
      options(options_of_caller),
      geometry(make_scene_geometry(scene)),
      model(make_model(scene, geometry)),
      drive(scene, geometry, model),
      state(model.start),
      loads_(scene, geometry, model) {
  if (options.max_iterations < 1) {
    throw std::invalid_argument("max_iterations: expected 1 or more, got " +
                                std::to_string(options.max_iterations));
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) meshes.push_back(mesh_of(b));
  surfaces_.resize(scene.bodies.size());
  scripted_positions_.resize(scene.bodies.size());
  sums_.reset(scene.bodies.size(), scene.couplings.size());
  stepper = make_stepper();
}

std::unique_ptr<BodyStepper> Simulator::Impl::make_stepper() {
  StepperOptions of;
  of.linear_tolerance = scene.solver.linear_tolerance;
  of.max_iterations = options.max_iterations;
  of.threads = thread_count(options.threads);
  of.device = options.device;
  of.float32_solve = options.float32_solve;
  of.skip = options.skip;
  if (options.progress) {
    of.progress = [this](std::int64_t iterations) {
      const double start = time_of(static_cast<double>(step_index));
      return options.progress({step_index, start, iterations_before_ + iterations});
    };
  }
  backend = options.backend == Backend::automatic ? Backend::cpu : options.backend;
  if (backend == Backend::cuda) return make_cuda_stepper(model, of);
  if (backend == Backend::reference) {
    return make_reference_stepper(scene, geometry, model, drive, of);
  }
  return make_cpu_stepper(model, of);
}

BodyMesh Simulator::Impl::mesh_of(std::size_t body) const {
  const BodyGeometry& of = geometry.bodies[body];
  BodyMesh mesh;
  mesh.kind = scene.bodies[body].kind;
  mesh.mass = mass_of(model, body);
  mesh.cells_across = of.cells_across;
  mesh.mesh = {of.nodes, of.tets};
  mesh.surface = of.surface;
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    const std::int32_t node = model.tets.nodes[t][0];
    if (node >= model.body_node[body] && node < model.body_node[body + 1]) {
      mesh.shear_modulus.push_back(model.tets.mu[t]);
    }
  }
  return mesh;
}

void Simulator::Impl::check_body(std::size_t index) const {
  if (index < scene.bodies.size()) return;
  throw std::invalid_argument("body " + std::to_string(index) + ": the scene has " +
                              std::to_string(scene.bodies.size()) + " bodies, counted from 0");
}

std::vector<Point3> Simulator::Impl::node_positions(std::size_t index) const {
  check_body(index);
  if (scene.bodies[index].kind == BodyKind::scripted) {
    return drive.scripted_positions(index, time_of(static_cast<double>(step_index)));
  }
  const auto first = state.position.begin() + model.body_node[index];
  return {first, first + (model.body_node[index + 1] - model.body_node[index])};
}

PositionsView Simulator::Impl::positions(std::size_t index) {
  check_body(index);
  if (scene.bodies[index].kind == BodyKind::scripted) {
    scripted_positions_[index] = node_positions(index);
    return scripted_positions_[index];
  }
  const std::int32_t first = model.body_node[index];
  return stepper->positions(first, model.body_node[index + 1] - first);
}

std::vector<Point3> Simulator::Impl::surface_positions(std::size_t index) {
  check_body(index);
  auto& surface = surfaces_[index];
  if (surface.empty()) {
    surface = bound_surface(model, geometry, static_cast<std::int32_t>(index));
  }
  std::vector<Point3> positions;
  positions.reserve(surface.size());
  if (scene.bodies[index].kind != BodyKind::scripted) {
    for (const ModelPoint& p : surface) {
      positions.push_back(position_of(p, state, model.node_count));
    }
    return positions;
  }
  ModelState scripted;
  scripted.position.resize(static_cast<std::size_t>(model.body_node[index]));
  const std::vector<Point3> nodes = node_positions(index);
  scripted.position.insert(scripted.position.end(), nodes.begin(), nodes.end());
  for (const ModelPoint& p : surface) {
    positions.push_back(p.rigid >= 0 ? position_of(p, state, model.node_count)
                                     : position_of(p, scripted, model.node_count));
  }
  return positions;
}

const StepRecord& Simulator::Impl::record() {
  if (record_) return *record_;
  StepRecord& record = record_.emplace();
  record.time = time_of(static_cast<double>(step_index));
  record.bodies.resize(scene.bodies.size());
  record.obstacle_forces.assign(scene.obstacles.size(), {0, 0, 0});
  record.coupling_forces.assign(scene.couplings.size(), {0, 0, 0});
  record_state(model, state, scene.gravity, drive.handles(), thread_count(options.threads), record);
  record.energy.work = work_;
  if (step_index == 0) {
    record.inverted = 0;
    return record;
  }
  const auto force = [&](const Point3& impulse) { return times(1 / scene.time_step, impulse); };
  for (std::size_t b = 0; b < record.bodies.size(); ++b) {
    record.bodies[b].support_force = force(sums_.support[b]);
    record.bodies[b].handle_force = force(sums_.handle[b]);
    record.bodies[b].coupling_force = force(sums_.coupling[b]);
    record.bodies[b].load_force = force(sums_.load[b]);
  }
  for (std::size_t c = 0; c < sums_.on_a.size(); ++c) {
    record.coupling_forces[c] = force(sums_.on_a[c]);
  }
  record.islands = model.island_count;
  record.substeps = substeps_;
  record.linear_iterations = outcome_.linear_iterations;
  record.linear_residual = outcome_.linear_residual;
  record.converged = outcome_.converged;
  record.skipped_rotations = outcome_.skipped_rotations;
  record.skipped_blocks = outcome_.skipped_blocks;
  record.seconds = outcome_.seconds;
  return record;
}

std::vector<std::byte> Simulator::Impl::checkpoint() const {
  CheckpointWriter writer;
  writer.add(checkpoint_version);
  writer.add(fingerprint_of(scene, model));
  writer.add(step_index);
  writer.add(work_);
  writer.add(substeps_);
  writer.add(outcome_.linear_iterations);
  writer.add(outcome_.linear_residual);
  writer.add(static_cast<std::uint8_t>(outcome_.converged));
  writer.add(state.position);
  writer.add(state.rotation);
  writer.add(state.velocity);
  writer.add(state.angular_momentum);
  for (const auto* list :
       {&sums_.support, &sums_.handle, &sums_.coupling, &sums_.load, &sums_.on_a}) {
    writer.add(*list);
  }
  for (const auto& handle : drive.handles()) writer.add(handle);
  for (const auto& handle : drive.overrides().handles) writer.add(handle);
  for (const auto& script : drive.overrides().scripts) writer.add(script);
  return writer.take();
}

void Simulator::Impl::restore(std::span<const std::byte> bytes) {
  CheckpointReader reader(bytes);
  std::uint64_t version = 0, fingerprint = 0;
  reader.read(version);
  if (version != checkpoint_version) {
    throw std::invalid_argument(
        "checkpoint: not a checkpoint of this version of tetwarp on this kind of machine");
  }
  reader.read(fingerprint);
  if (fingerprint != fingerprint_of(scene, model)) {
    throw std::invalid_argument(
        "checkpoint: it belongs to another scene; restart the scene that wrote it, unchanged");
  }
  // All is read before anything changes.
  std::int64_t steps = 0, substeps = 0;
  double work = 0;
  std::uint8_t converged = 0;
  StepOutcome outcome;
  ModelState read = state;
  StepSums sums = sums_;
  auto handles = drive.handles();
  DriveOverrides overrides = drive.overrides();
  reader.read(steps);
  reader.read(work);
  reader.read(substeps);
  reader.read(outcome.linear_iterations);
  reader.read(outcome.linear_residual);
  reader.read(converged);
  reader.read(read.position);
  reader.read(read.rotation);
  reader.read(read.velocity);
  reader.read(read.angular_momentum);
  for (auto* list : {&sums.support, &sums.handle, &sums.coupling, &sums.load, &sums.on_a}) {
    reader.read(*list);
  }
  for (auto& handle : handles) reader.read(handle);
  for (auto& handle : overrides.handles) reader.read(handle);
  for (auto& script : overrides.scripts) reader.read(script);
  if (!reader.is_at_end() || steps < 0) {
    throw std::invalid_argument("checkpoint: damaged, it is longer than the state of its scene");
  }
  if (!is_finite_state(read)) {
    throw std::invalid_argument("checkpoint: damaged, a position or velocity is not a number");
  }
  step_index = steps;
  work_ = work;
  substeps_ = substeps;
  outcome.converged = converged != 0;
  outcome_ = outcome;
  state = std::move(read);
  sums_ = std::move(sums);
  drive.handles() = std::move(handles);
  drive.overrides() = std::move(overrides);
  record_.reset();
  stepper->set_state(state);
}

}  // namespace tetwarp
