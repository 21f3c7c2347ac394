/// @file live_scene.hpp
/// A small scene for tests of live windows.
#pragma once
#include <cstdint>
#include <thread>
#include <utility>

#include "host/view/live_simulation.hpp"

namespace tetwarp::test {

/// A block of tissue that stands fast, with a volume, and a ball on it.
inline Scene live_scene() {
  Scene scene;
  scene.time_step = 0.01;
  Grid grid{.dims = {8, 8, 12}, .origin = {-0.07, -0.07, -0.11}, .spacing = {0.02, 0.02, 0.02}};
  Volume volume = make_volume(grid, PixelType::float32);
  for (float& sample : volume.samples<float>()) sample = 1;
  Body block;
  block.name = "block";
  block.geometry = ImageGeometry{std::move(volume), 0.5};
  block.lattice = Lattice{.cells = {{2, 2, 3}}};
  block.material = {1e4, 0.3, 1000};
  block.fixed = {HalfSpaceSelection{{0, 0, -1}, 0.1}};
  Body ball;
  ball.name = "ball";
  ball.kind = BodyKind::rigid;
  ball.geometry = Shape{EllipsoidShape{{0.03, 0.03, 0.03}}};
  ball.pose.position = {0, 0, 0.17};
  scene.bodies = {block, ball};
  return scene;
}

/// Waits for a frame of at least so many steps.
inline view::LiveFrame& frame_at(view::LiveSimulation& simulation, std::int64_t tick) {
  while (!simulation.frames().take() || simulation.frames().front().tick < tick) {
    std::this_thread::yield();
  }
  return simulation.frames().front();
}

}  // namespace tetwarp::test
