#include "host/simulate/run/simulator_impl.hpp"

#include <algorithm>
#include <stdexcept>

#include "host/base/parallel.hpp"
#include "host/simulate/model/body_points.hpp"
#include "host/simulate/start/prepare_start.hpp"
#include "host/simulate/step/reference_stepper.hpp"

namespace tetwarp {
namespace {

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
      state_(model.start),
      loads_(scene, geometry, model),
      rest_factors_(std::make_shared<RestFactors>(model)),
      sleep_(scene, geometry, model) {
  if (options.max_iterations < 1) {
    throw std::invalid_argument("max_iterations: expected 1 or more, got " +
                                std::to_string(options.max_iterations));
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) meshes.push_back(mesh_of(b));
  surfaces_.resize(scene.bodies.size());
  scripted_positions_.resize(scene.bodies.size());
  sums_.reset(scene.bodies.size(), scene.obstacles.size(), scene.couplings.size());
  backend = options.backend == Backend::automatic ? Backend::cpu : options.backend;
  make_contact();
  stepper = make_stepper();
  largest_spin_ = largest_spin();
  // Records of contacts and the choice of sleeping bodies are on the host.
  resident_ = contact_ || sleep_.is_on() ? nullptr : stepper->resident_state();
  if (resident_ == nullptr) return;
  StatePlaces places;
  drive.add_places(places);
  loads_.add_places(places);
  for (auto* list : {&places.nodes, &places.rigid}) {
    std::sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  resident_->watch(places);
}

std::unique_ptr<BodyStepper> Simulator::Impl::make_stepper() {
  StepperOptions of;
  of.linear_tolerance = scene.solver.linear_tolerance;
  of.max_iterations = options.max_iterations;
  of.threads = thread_count(options.threads);
  of.device = options.device;
  of.float32_solve = options.float32_solve;
  of.skip = options.skip;
  of.factors = rest_factors_;
  if (options.progress) {
    of.progress = [this](std::int64_t iterations) {
      const double start = time_of(static_cast<double>(step_index));
      return options.progress({step_index, start, iterations_before_ + iterations});
    };
  }
  if (backend == Backend::cuda) return make_cuda_stepper(model, of);
  if (backend == Backend::reference) {
    return make_reference_stepper(scene, geometry, model, drive, of);
  }
  return make_cpu_stepper(model, of);
}

void Simulator::Impl::make_contact() {
  contact_surfaces = make_scene_surfaces(scene, geometry, model);
  if (!ContactStep::can_touch(contact_surfaces.surfaces)) return;
  ContactStepOptions of;
  of.backend = backend;
  of.threads = thread_count(options.threads);
  of.device = options.device;
  of.skip = options.skip;
  of.sleeps = sleep_.is_on();
  of.factors = rest_factors_;
  if (options.progress) {
    of.progress = [this] {
      const double start = time_of(static_cast<double>(step_index));
      return options.progress({step_index, start, iterations_before_});
    };
  }
  contact_ = std::make_unique<ContactStep>(scene, model, contact_surfaces, of);
  const StartParts parts{scene, geometry, contact_surfaces, contact_->detector(), of.threads};
  growth_ = prepare_start(parts, options.untangle, model);
  state_ = model.start;
  if (backend == Backend::reference && !growth_.empty()) {
    throw std::invalid_argument(
        "untangle: backend reference cannot let bodies grow; use backend cpu");
  }
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
  // A script that was stopped is between two places of its path; one that a hand has moved follows
  // from the next step on.
  const bool is_on_path = drive.delays()[index] == 0 && !drive.overrides().scripts[index];
  if (scene.bodies[index].kind == BodyKind::scripted && is_on_path) {
    return drive.scripted_positions(index, time_of(static_cast<double>(step_index)));
  }
  const auto first = state().position.begin() + model.body_node[index];
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
      positions.push_back(position_of(p, state(), model.node_count));
    }
    return positions;
  }
  ModelState scripted;
  scripted.position.resize(static_cast<std::size_t>(model.body_node[index]));
  const std::vector<Point3> nodes = node_positions(index);
  scripted.position.insert(scripted.position.end(), nodes.begin(), nodes.end());
  for (const ModelPoint& p : surface) {
    positions.push_back(p.rigid >= 0 ? position_of(p, state(), model.node_count)
                                     : position_of(p, scripted, model.node_count));
  }
  return positions;
}

}  // namespace tetwarp
