#include "tests/simulate/stack_scenes.hpp"

#include <array>
#include <cstddef>

#include "tests/simulate/body_models.hpp"
#include "tests/simulate/random_contacts.hpp"

namespace tetwarp::test {

HandScene stack_scene(double youngs) {
  HandScene scene;
  Model& model = scene.model;
  model = empty_model();
  add_block(model, {.cells = {4, 4, 3}, .edge = 0.005, .youngs = youngs, .poisson = 0.4});
  const std::int32_t box = add_rigid(model, 0.02, {1e-6, 1e-6, 1e-6}, {0.01, 0.01, 0.02});
  const std::int32_t frame = add_frame(model, {0, 0, 0});
  scene.make_surfaces(0.02);
  const auto body_of = [&](std::int32_t rigid) {
    return model.rigid.body[static_cast<std::size_t>(rigid)];
  };
  for (std::int32_t node = 0; node < 25; node += 2) {
    const Point3& place = model.start.position[static_cast<std::size_t>(node)];
    Touch touch;
    touch.body_b = body_of(frame);
    touch.point_a = on_nodes({node, -1, -1}, {1, 0, 0});
    touch.point_b = on_rigid(place);
    touch.area = 1e-5;
    scene.touches.push_back(touch);
  }
  for (std::int32_t node = 75; node < 100; node += 3) {
    const Point3& place = model.start.position[static_cast<std::size_t>(node)];
    Touch touch;
    touch.body_b = body_of(box);
    touch.point_a = on_nodes({node, -1, -1}, {1, 0, 0});
    touch.point_b = on_rigid({place[0] - 0.01, place[1] - 0.01, -0.005});
    touch.normal = {0, 0, -1};
    touch.area = 1e-5;
    scene.touches.push_back(touch);
  }
  return scene;
}

HandScene tied_scene(double youngs, double spring) {
  HandScene scene;
  Model& model = scene.model;
  model = empty_model();
  BlockOptions block{.cells = {4, 4, 3}, .edge = 0.005, .youngs = youngs, .poisson = 0.4};
  add_block(model, block);
  block.origin[0] = 0.02;
  const std::int32_t second = add_block(model, block);
  const std::int32_t frame = add_frame(model, {0, 0, 0});
  for (std::int32_t node = 0; node < second; node += 5) {
    add_spring(model, node_point(model, node + 4), node_point(model, second + node), spring);
  }
  scene.make_surfaces(0.02);
  for (const std::int32_t first : {0, second}) {
    for (std::int32_t node = first; node < first + 25; node += 2) {
      Touch touch;
      touch.body_a = first == 0 ? 0 : 1;
      touch.body_b = model.rigid.body[static_cast<std::size_t>(frame)];
      touch.point_a = on_nodes({node - first, -1, -1}, {1, 0, 0});
      touch.point_b = on_rigid(model.start.position[static_cast<std::size_t>(node)]);
      touch.area = 1e-5;
      scene.touches.push_back(touch);
    }
  }
  return scene;
}

HandScene sheet_scene(double stiffness, std::int32_t cells) {
  HandScene scene;
  Model& model = scene.model;
  model = empty_model();
  add_sheet(model, cells, 0.005, stiffness, 0.01);
  const std::int32_t box = add_rigid(model, 0.02, {1e-6, 1e-6, 1e-6}, {0.015, 0.015, 0.005});
  const std::int32_t frame = add_frame(model, {0, 0, 0});
  scene.make_surfaces(0.02);
  const auto add_touch = [&](std::int32_t node, std::int32_t rigid, const Point3& center) {
    const Point3& place = model.start.position[static_cast<std::size_t>(node)];
    Touch touch;
    touch.body_b = model.rigid.body[static_cast<std::size_t>(rigid)];
    touch.point_a = on_nodes({node, -1, -1}, {1, 0, 0});
    touch.point_b = on_rigid({place[0] - center[0], place[1] - center[1], place[2] - center[2]});
    touch.normal = {0, 0, rigid == frame ? 1.0 : -1.0};
    touch.area = 1e-5;
    scene.touches.push_back(touch);
  };
  const std::int32_t count = model.node_count;
  for (std::int32_t node = 0; node < count; ++node) add_touch(node, frame, {0, 0, 0});
  for (std::int32_t node = cells + 2; node < count - cells - 2; node += 4) {
    add_touch(node, box, {0.015, 0.015, 0.005});
  }
  return scene;
}

HandScene tower_scene(double height, std::int32_t cells) {
  HandScene scene;
  Model& model = scene.model;
  model = empty_model();
  for (int block = 0; block < 3; ++block) {
    add_block(model, {.cells = {cells, cells, 1},
                      .edge = 0.005,
                      .origin = {0, 0, 0.005 * block},
                      .youngs = 3e4 * (1 + block),
                      .poisson = 0.4});
  }
  for (Point3& x : model.start.position) x[2] *= height;
  const std::int32_t layer = (cells + 1) * (cells + 1);
  const std::int32_t frame = add_frame(model, {0, 0, 0});
  scene.make_surfaces(0.02);
  for (std::int32_t block = 0; block < 3; ++block) {
    const std::int32_t stride =
        std::array<std::int32_t, 3>{1, 3, 2}[static_cast<std::size_t>(block)];
    for (std::int32_t node = 0; node < layer; node += stride) {
      Touch touch;
      touch.body_a = block;
      touch.point_a = on_nodes({node, -1, -1}, {1, 0, 0});
      if (block == 0) {
        touch.body_b = model.rigid.body[static_cast<std::size_t>(frame)];
        touch.point_b = on_rigid(model.start.position[static_cast<std::size_t>(node)]);
      } else {
        touch.body_b = block - 1;
        touch.point_b = on_nodes({layer + node, -1, -1}, {1, 0, 0});
      }
      touch.area = 1e-5;
      scene.touches.push_back(touch);
    }
  }
  return scene;
}

HandScene rods_scene() {
  HandScene scene;
  Model& model = scene.model;
  model = empty_model();
  add_frame(model, {0, 0, 0});  // body a of all contacts, which are sorted by it first
  const double end = 0.05, mass = 0.1, moment = mass * end * end;
  for (const double y : {0.0, 0.1}) add_rigid(model, mass, {1e-5, moment, moment}, {0, y, 0});
  add_spring(model, rigid_point(model, 1, {0, 0, 0}), rigid_point(model, 2, {0, 0, 0}), 1);
  scene.make_surfaces(0.02);
  int counts[2] = {0, 0};
  for (const char c : missed_contacts) {
    const int rod = c == '1' ? 0 : 1;
    const double x = counts[rod]++ % 2 == 0 ? end : -end;
    Touch touch;
    touch.body_b = 1 + rod;
    touch.point_a = on_rigid({x, 0.1 * rod, 0});
    touch.point_b = on_rigid({x, 0, 0});
    touch.normal = {-1, 0, 0};
    scene.touches.push_back(touch);
  }
  return scene;
}

}  // namespace tetwarp::test
