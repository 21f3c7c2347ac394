#include "tests/support/parity_scenes.hpp"

#include <cmath>

#include "tests/support/body_scenes.hpp"

namespace tetwarp::test {
namespace {

/// Between low and high.
double within(Noise& noise, double low, double high) {
  return low + (high - low) * (noise() + 1) / 2;
}

Pose random_pose(Noise& noise, const Point3& position) {
  const Point3 axis = noise.point(1);
  const double w = 1 + noise();
  const double norm = std::sqrt(w * w + axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  return {position, {w / norm, axis[0] / norm, axis[1] / norm, axis[2] / norm}};
}

Material random_material(Noise& noise) {
  return {std::pow(10, within(noise, 3, 7)), within(noise, -0.2, 0.45), within(noise, 300, 2000)};
}

Body elastic_shape(Noise& noise, const std::string& name, const Shape& shape) {
  Body body = elastic_box(name, {1, 1, 1}, {2, 2, 2}, random_material(noise));
  body.geometry = shape;
  body.pose = random_pose(noise, noise.point(0.1));
  body.velocity = noise.point(1);
  body.angular_velocity = noise.point(3);
  body.damping = {within(noise, 0, 2), within(noise, 0, 4e-3)};
  return body;
}

Scene base(Noise& noise) {
  return scene_of(within(noise, 1e-3, 1e-2), 10, {noise(), noise(), -9.81});
}

/// Bodies pass through one another: the reference that steps are compared with knows no contact.
Scene without_contact(Scene scene) {
  for (Body& body : scene.bodies) body.collide = false;
  return scene;
}

Scene elastic_shapes(std::uint64_t seed) {
  Noise noise(seed);
  Scene scene = base(noise);
  scene.bodies = {elastic_shape(noise, "egg", EllipsoidShape{{0.1, 0.07, 0.08}}),
                  elastic_shape(noise, "ring", TorusShape{0.1, 0.04}),
                  elastic_shape(noise, "strip", BentStripShape{0.2, 0.05, 0.05, 0.02})};
  scene.bodies[0].mass = MassKind::lumped;
  scene.bodies[2].fixed = {NodeSelection{{0, 1, 2}}};
  return without_contact(scene);
}

Volume random_volume(Noise& noise) {
  Grid grid;
  grid.dims = {9, 8, 7};
  grid.spacing = {0.02, 0.025, 0.03};
  grid.origin = noise.point(1);
  Volume volume = make_volume(grid, PixelType::int16);
  auto samples = volume.samples<std::int16_t>();
  for (std::size_t v = 0; v < samples.size(); ++v) {
    samples[v] = static_cast<std::int16_t>(std::lround(within(noise, -0.49, 3.49)));
  }
  return volume;
}

Scene images(std::uint64_t seed) {
  Noise noise(seed);
  Scene scene = base(noise);
  for (const bool is_label : {false, true}) {
    Body body = elastic_shape(noise, is_label ? "labels" : "values", BoxShape{});
    body.geometry = ImageGeometry{random_volume(noise), 0.5};
    body.lattice = Lattice{std::array<std::int64_t, 3>{2, 2, 2}, {}, {}};
    body.lookup = is_label ? TransferLookup::label : TransferLookup::linear;
    body.mean = is_label ? MaterialMean::harmonic : MaterialMean::arithmetic;
    body.transfer = {{1, random_material(noise)}, {is_label ? 3.0 : 2.5, random_material(noise)}};
    scene.bodies.push_back(body);
  }
  scene.bodies[1].fixed = {NodeSelection{{0, 4}}};
  return without_contact(scene);
}

Scene rigid_bodies(std::uint64_t seed) {
  Noise noise(seed);
  Scene scene = base(noise);
  const std::vector<Shape> shapes{BoxShape{{0.1, 0.05, 0.02}}, EllipsoidShape{{0.1, 0.1, 0.06}},
                                  CapsuleShape{0.05, 0.1}};
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    Body body = rigid_box("rigid" + std::to_string(i), {1, 1, 1}, within(noise, 100, 3000));
    body.geometry = shapes[i];
    body.surface = std::int64_t{80};
    body.pose = random_pose(noise, noise.point(1));
    body.velocity = noise.point(1);
    body.angular_velocity = noise.point(10);
    body.damping.alpha = within(noise, 0, 1);
    scene.bodies.push_back(body);
  }
  scene.bodies[0].rigid.mass = 2;
  scene.bodies[0].rigid.inertia = {0.02, 0.03, 0.025, 0.002, -0.003, 0.001};
  Load load;
  load.body = "rigid1";
  load.select = {HalfSpaceSelection{{0, 0, 1}, scene.bodies[1].pose.position[2]}};
  load.force = noise.point(5);
  load.from = 2.5 * scene.time_step;
  load.to = 7 * scene.time_step;
  scene.loads = {load};
  return without_contact(scene);
}

Cloth random_cloth(Noise& noise) {
  return {within(noise, 0.1, 1), within(noise, 100, 1000), within(noise, 20, 200),
          within(noise, 0, 1e-3)};
}

Scene cloths(std::uint64_t seed) {
  Noise noise(seed);
  Scene scene = base(noise);
  Body sheet = sheet_body("sheet", {0.3, 0.2}, {4, 3}, random_cloth(noise));
  sheet.damping = {within(noise, 0, 1), within(noise, 0, 4e-3)};
  sheet.pose = random_pose(noise, {0, 0, 0});
  sheet.fixed = {NodeSelection{{0}}};
  DrivenNodes driven;
  driven.select = {NodeSelection{{4, 9}}};
  driven.path = {{0, Point3{0, 0, 0}, {0, 0, 0}}, {0.05, noise.point(0.05), noise.point(0.5)}};
  sheet.driven = {driven};
  Body patch = sheet_body("patch", {1, 1}, {1, 1}, random_cloth(noise));
  Surface surface;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      surface.points.push_back(
          {0.1 * i + 0.02 * noise(), 0.1 * j + 0.02 * noise(), 1 + 0.03 * noise()});
    }
  }
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const int a = i + 4 * j;
      surface.triangles.push_back({a, a + 1, a + 5});
      surface.triangles.push_back({a, a + 5, a + 4});
    }
  }
  patch.geometry = surface;
  patch.velocity = noise.point(2);
  patch.angular_velocity = noise.point(5);
  scene.bodies = {sheet, patch};
  Load pressure;
  pressure.body = "patch";
  pressure.select = {AllSelection{}};
  pressure.pressure = within(noise, -20, 20);
  scene.loads = {pressure};
  return without_contact(scene);
}

Coupling coupling_of(const std::string& a, const std::string& b, Selection select, Noise& noise) {
  Coupling coupling;
  coupling.a = a;
  coupling.b = b;
  coupling.select_a = std::move(select);
  coupling.stiffness = std::pow(10, within(noise, 1, 4));
  coupling.damping = within(noise, 0, 5);
  return coupling;
}

Scene coupled(std::uint64_t seed) {
  Noise noise(seed);
  Scene scene = base(noise);
  Body block = elastic_box("block", {0.1, 0.1, 0.1}, {1, 1, 2}, random_material(noise));
  block.pose = random_pose(noise, {0.05, 0, 0});
  Body other = elastic_shape(noise, "other", EllipsoidShape{{0.1, 0.08, 0.08}});
  other.lattice = Lattice{std::array<std::int64_t, 3>{1, 2, 2}, {}, {}};
  other.pose.position = {0.3, 0, 0};
  Body brick = rigid_box("brick", {0.1, 0.05, 0.07}, within(noise, 100, 3000));
  brick.pose = random_pose(noise, {0, 0.3, 0});
  brick.angular_velocity = noise.point(3);
  Body flag = sheet_body("flag", {0.2, 0.2}, {2, 2}, random_cloth(noise));
  flag.pose.position = {0.1, 0.1, 0.2};
  scene.bodies = {block, other, brick, flag};
  SphereObstacle ball{{0.5, 0, 0}, 0.1};
  scene.obstacles = {{"ball", ball, {}, {{0, Point3{0, 0, 0}}, {0.1, noise.point(0.2)}}},
                     {"floor", PlaneObstacle{{0, 0, 1}, {0, 0, -0.4}}, {}, {}}};
  Coupling points = coupling_of("block", "brick", {}, noise);
  points.points = {noise.point(0.2), noise.point(0.3)};
  points.within = 10;
  Coupling close = coupling_of("other", "block", {AllSelection{}}, noise);
  close.within = 0.25;
  scene.couplings = {points,
                     close,
                     coupling_of("flag", "brick", {NodeSelection{{0, 1, 5}}}, noise),
                     coupling_of("block", "flag", {NodeSelection{{3, 4}}}, noise),
                     coupling_of("brick", "world", {NodeSelection{{0, 7}}}, noise),
                     coupling_of("other", "ball", {NodeSelection{{1}}}, noise),
                     coupling_of("brick", "floor", {NodeSelection{{2}}}, noise)};
  return without_contact(scene);
}

Scene handled(std::uint64_t seed) {
  Noise noise(seed);
  Scene scene = base(noise);
  Body block = elastic_box("block", {0.1, 0.1, 0.1}, {2, 1, 1}, random_material(noise));
  block.damping.gamma = 2e-3;
  block.fixed = {HalfSpaceSelection{{-1, 0, 0}, 0.099}};
  Body brick = rigid_box("brick", {0.1, 0.05, 0.07}, within(noise, 100, 3000));
  brick.pose = random_pose(noise, {0, 0.3, 0});
  scene.bodies = {block, brick};
  Handle pull;
  pull.name = "pull";
  pull.body = "block";
  pull.select = {HalfSpaceSelection{{1, 0, 0}, 0.099}};
  pull.stiffness = within(noise, 10, 1000);
  pull.damping = within(noise, 0, 10);
  pull.path = {{0, Point3{0, 0, 0}},
               {5 * scene.time_step, noise.point(0.1)},
               {8 * scene.time_step, std::nullopt}};
  Handle hold = pull;
  hold.name = "";
  hold.body = "brick";
  hold.select = {NodeSelection{{1, 2, 3}}};
  hold.path = {{0.5 * scene.time_step, noise.point(0.01)}, {1, noise.point(2)}};
  scene.handles = {pull, hold};
  Load force, pressure;
  force.body = "block";
  force.select = {AllSelection{}};
  force.force = noise.point(10);
  pressure.body = "block";
  pressure.select = {HalfSpaceSelection{{0, 0, 1}, 0.099}};
  pressure.pressure = within(noise, 10, 100);
  pressure.from = 2 * scene.time_step;
  pressure.to = 6 * scene.time_step;
  scene.loads = {force, pressure};
  return without_contact(scene);
}

Scene scripted(std::uint64_t seed) {
  Noise noise(seed);
  Scene scene = base(noise);
  Body fish = elastic_box("fish", {0.05, 0.05, 0.2}, {1, 1, 2}, {});
  fish.kind = BodyKind::scripted;
  fish.pose = random_pose(noise, {0.3, 0, 0});
  Wave wave;
  wave.envelope = {0.02, 0.08, 0.16};
  wave.phase = noise();
  fish.motion = wave;
  Body jaw;
  jaw.name = "jaw";
  jaw.kind = BodyKind::scripted;
  jaw.pose = random_pose(noise, {0, 0, 0.2});
  Hinge hinge;
  hinge.point = noise.point(0.2);
  hinge.axis = {0.6, 0, 0.8};
  hinge.angle = {{{0, 0.1}}, {{0.03, 0.4}}, {{0.2, -0.2}}};
  jaw.motion = hinge;
  Body wall = elastic_box("wall", {0.1, 0.02, 0.1}, {1, 1, 1}, {});
  wall.kind = BodyKind::scripted;
  wall.pose.position = {0, 0.2, 0};
  wall.motion = Path{{0, noise.point(0.01), {0, 0, 0}}, {0.1, noise.point(0.1), noise.point(1)}};
  Body block = elastic_box("block", {0.1, 0.1, 0.1}, {1, 1, 1}, random_material(noise));
  scene.bodies = {fish, jaw, wall, block};
  scene.couplings = {coupling_of("block", "fish", {NodeSelection{{0, 1, 2}}}, noise),
                     coupling_of("block", "jaw", {NodeSelection{{3, 7}}}, noise),
                     coupling_of("block", "wall", {AllSelection{}}, noise)};
  return without_contact(scene);
}

}  // namespace

const std::vector<NamedScene>& parity_scenes() {
  static const std::vector<NamedScene> scenes{{"elastic_shapes", elastic_shapes},
                                              {"images", images},
                                              {"rigid_bodies", rigid_bodies},
                                              {"cloths", cloths},
                                              {"coupled", coupled},
                                              {"handled", handled},
                                              {"scripted", scripted}};
  return scenes;
}

}  // namespace tetwarp::test
