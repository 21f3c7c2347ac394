/// @file simulate_warp.cpp
/// An elastic torso, fixed at its base, is pulled by a handle and let go; its image follows.
#include <algorithm>
#include <cstdio>
#include <tetwarp/tetwarp.hpp>
#include <vector>

int main() {
  tetwarp::Body torso;
  torso.name = "torso";
  tetwarp::Volume image = tetwarp::make_phantom({64, 40, 61});  // in mm
  for (double& spacing : image.grid.spacing) spacing *= 1e-3;
  for (double& origin : image.grid.origin) origin *= 1e-3;
  torso.geometry = tetwarp::ImageGeometry{image, 0.05};
  torso.lattice = tetwarp::Lattice{.cells = {{7, 5, 4}}};
  torso.transfer = {{0.05, {5e3, 0.4, 950}}, {0.5, {5e4, 0.4, 1050}}, {1.0, {5e6, 0.3, 1800}}};
  torso.fixed = {tetwarp::HalfSpaceSelection{{0, 0, -1}, 0.17}};

  tetwarp::Scene scene;
  scene.time_step = 0.01;
  scene.duration = 0.5;
  scene.gravity = {0, 0, 0};
  scene.bodies = {torso};
  scene.handles = {{.name = "hand",
                    .body = "torso",
                    .select = {tetwarp::HalfSpaceSelection{{0, 0, 1}, 0.17}},
                    .stiffness = 2e4}};

  tetwarp::Simulator simulator(scene);
  tetwarp::Warper warper(image, simulator.body(0).mesh);
  tetwarp::Volume warped;
  double highest = 0;
  for (int step = 0; step < scene.step_count(); ++step) {
    if (step < 25) simulator.move_handle("hand", {0.002 * step, 0, 0});  // where a hand moves it
    if (step == 25) simulator.release_handle("hand");
    if (!simulator.step()) return 1;
    highest = std::max(highest, simulator.record().energy.elastic);
    if (step % 10 == 9) warped = warper.step(simulator.positions(0));
  }
  const tetwarp::StepRecord& record = simulator.record();
  std::printf("t = %.2f s: elastic energy %.3g J of %.3g J at most, %lld tetrahedra inverted\n",
              record.time, record.energy.elastic, highest, static_cast<long long>(record.inverted));
  return record.converged && record.energy.elastic < highest && warped.data != image.data ? 0 : 1;
}
