#include "tests/simulate/mixed_contacts.hpp"

#include <random>

#include "host/base/point3.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
StepInput input_of(const Model& model) {
  StepInput input = input_for(model, mixed_step, {0, 0, -9.81});
  input.prescribed_velocity[0] = {0.1, 0, 0.2};
  input.prescribed_velocity[at(model.node_count) + 4] = {0.3, -0.2, 0.4};
  input.prescribed_velocity[at(model.node_count) + 5] = {1, 2, -1};
  return input;
}
}  // namespace

HandScene mixed_scene(unsigned seed, double adhesion_area) {
  HandScene scene;
  Model& model = scene.model;
  model = empty_model();
  const std::int32_t block = add_block(model, {.cells = {2, 2, 2}, .gamma = 1e-3});
  for (const std::int32_t node : {0, 1, 2}) prescribe(model, block + node);
  add_block(model, {.cells = {1, 2, 1}, .origin = {0, 0, 0.2}, .youngs = 3e4});
  add_sheet(model, 3, 0.1, 50, 0.2);
  add_block(model, {.cells = {1, 1, 1}, .origin = {5, 0, 0}});
  const std::int32_t one = add_rigid(model, 0.5, {1e-3, 2e-3, 2e-3}, {-0.2, 0.1, 0.1});
  add_rigid(model, 0.3, {1e-3, 1e-3, 2e-3}, {0.4, 0.1, 0.1});
  add_frame(model, {0, 0, -0.1});
  add_spring(model, rigid_point(model, one, {0.1, 0.02, 0}), node_point(model, block + 3), 500, 2);
  scene.make_surfaces(0.3);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  for (std::size_t i = 0; i < model.start.velocity.size(); ++i) {
    if (model.prescribed[i] == 0) {
      for (double& v : model.start.velocity[i]) v = 0.3 * normal(random);
    }
  }
  model.start.angular_momentum = {{1e-3, 2e-3, -1e-3}, {0, 3e-3, 1e-3}, {0, 0, 0}};
  const auto point_of = [&](std::int32_t body) {
    const std::int32_t nodes = model.body_node[at(body) + 1] - model.body_node[at(body)];
    if (nodes == 0) {
      return on_rigid({0.05 * normal(random), 0.05 * normal(random), 0.05 * normal(random)});
    }
    std::uniform_int_distribution<std::int32_t> any(0, nodes - 3);
    const std::int32_t first = any(random);
    return on_nodes({first, first + 1, first + 2}, {0.2, 0.3, 0.5});
  };
  const std::vector<std::array<std::int32_t, 2>> pairs = {{0, 1}, {0, 4}, {1, 5}, {1, 2}, {2, 6},
                                                          {4, 6}, {5, 6}, {0, 6}, {2, 5}, {2, 4}};
  for (const auto& [a, b] : pairs) {
    Touch touch;
    touch.body_a = a;
    touch.body_b = b;
    touch.point_a = point_of(a);
    touch.point_b = point_of(b);
    touch.normal = unit(Point3{normal(random), normal(random), normal(random)});
    touch.area = adhesion_area;
    scene.touches.push_back(touch);
  }
  return scene;
}

ContactTrackerOptions materials(double friction, double stiffness) {
  ContactTrackerOptions options;
  options.materials[0].friction = friction;
  options.materials[0].stiffness = stiffness;
  options.materials[0].energy = 1;
  options.materials[0].initial_intensity = stiffness > 0 ? 1 : 0;
  options.touch_distance = 1e3;
  return options;
}

HandScene stack_on_frame(std::int32_t count) {
  HandScene scene;
  scene.model = empty_model();
  for (std::int32_t b = 0; b < count; ++b) {
    add_rigid(scene.model, 1, {0.0125 / 3, 0.0125 / 3, 0.02 / 3}, {0, 0, 0.05 + 0.1 * b});
  }
  add_frame(scene.model, {0, 0, 0});
  scene.make_surfaces(0.2);
  for (std::int32_t b = 0; b < count; ++b) {
    for (const double x : {-0.1, 0.1}) {
      for (const double y : {-0.1, 0.1}) {
        Touch touch;
        touch.body_a = b == 0 ? 0 : b - 1;
        touch.body_b = b == 0 ? count : b;
        touch.point_a = on_rigid({x, y, b == 0 ? -0.05 : 0.05});
        touch.point_b = on_rigid({x, y, b == 0 ? 0 : -0.05});
        touch.normal = {0, 0, b == 0 ? 1.0 : -1.0};
        scene.touches.push_back(touch);
      }
    }
  }
  return scene;
}

ContactSystemOptions exact(Backend backend) {
  ContactSystemOptions options;
  options.solver.tolerance = 1e-11;
  options.solver.backend = backend;
  options.solver.threads = 1;
  return options;
}

Solved solve(const HandScene& scene,
             const ContactTrackerOptions& tracking,
             const ContactSystemOptions& options,
             std::optional<double> gap,
             int threads) {
  StepperOptions stepping;
  stepping.linear_tolerance = 1e-13;
  stepping.threads = threads;
  Solved solved;
  solved.stepper = make_cpu_stepper(scene.model, stepping);
  solved.stepper->solve(input_of(scene.model));
  solved.stepper->get_velocities(solved.free);
  ContactTracker tracker(tracking);
  std::vector<ReportedContact> reports = scene.reports(scene.model.start);
  for (ReportedContact& report : reports) {
    if (gap) report.point_b_world = minus(report.point_a_world, times(*gap, report.normal));
  }
  solved.contacts = tracker.begin_step(reports, scene.places(scene.model.start), mixed_step);
  ContactSystem system(scene.surfaces, scene.model, options);
  solved.velocity = solved.free;
  solved.outcome =
      system.solve(*solved.stepper, scene.model.start, tracker, solved.contacts, solved.velocity);
  solved.solution = system.solution();
  solved.impulses =
      scene.block_impulses(scene.model.start, solved.contacts, solved.solution.impulse);
  return solved;
}

}  // namespace tetwarp::test
