/// @file shared_scene.cpp
/// A scene as bytes.
#include "host/view/screens/shared_scene.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
constexpr std::int64_t pose_numbers = 4;  // rows of an origin and three axes

bool are_finite(const std::vector<Point3>& points) {
  return std::ranges::all_of(points, [](const Point3& x) { return is_finite(x); });
}

/// Whether all indices of all items are below a count.
template <class Items>
bool are_below(const Items& items, std::int64_t count) {
  return std::ranges::all_of(items, [&](const auto& item) {
    return std::ranges::all_of(item, [&](std::int32_t i) { return i >= 0 && i < count; });
  });
}

void write(ByteWriter& to, const SharedBody& body) {
  to.add(body.form);
  to.add_list(body.triangles);
  to.add(body.moving_count);
  to.add_list(body.nodes);
  to.add_list(body.weights);
  to.add_list(body.rest_points);
}

SharedBody read_body(ByteReader& from) {
  SharedBody body;
  body.form = from.get<BodyForm>();
  require(body.form <= BodyForm::pose, "no form of a body");
  body.triangles = from.get_list<std::array<std::int32_t, 3>>();
  body.moving_count = from.get<std::int64_t>();
  body.nodes = from.get_list<std::array<std::int32_t, 4>>();
  body.weights = from.get_list<std::array<double, 4>>();
  body.rest_points = from.get_list<Point3>();
  require(body.moving_count >= 0 && body.moving_count <= INT32_MAX, "a wrong count");
  const bool is_pose = body.form == BodyForm::pose, is_bound = body.form == BodyForm::nodes;
  require(!is_pose || body.moving_count == pose_numbers, "a wrong count");
  require(body.nodes.size() == body.weights.size() && is_bound >= !body.nodes.empty(),
          "a wrong binding");
  require(is_pose || body.rest_points.empty(), "rest points of a body that moves otherwise");
  require(are_below(body.nodes, body.moving_count), "a node that is not there");
  require(are_finite(body.rest_points), "a number that is not finite");
  for (const auto& weights : body.weights) {
    require(std::ranges::all_of(weights, [](double w) { return std::isfinite(w); }),
            "a number that is not finite");
  }
  const std::size_t points = is_bound  ? body.nodes.size()
                             : is_pose ? body.rest_points.size()
                                       : static_cast<std::size_t>(body.moving_count);
  require(are_below(body.triangles, static_cast<std::int64_t>(points)),
          "a point that is not there");
  return body;
}

void write(ByteWriter& to, const Obstacle& obstacle) {
  to.add(static_cast<std::uint8_t>(obstacle.geometry.index()));
  std::visit(
      [&](const auto& geometry) {
        using T = std::decay_t<decltype(geometry)>;
        if constexpr (std::is_same_v<T, Surface>) {
          to.add_list(geometry.points);
          to.add_list(geometry.triangles);
        } else {
          to.add(geometry);
        }
      },
      obstacle.geometry);
  to.add(static_cast<std::uint64_t>(obstacle.path.size()));
  for (const PathPoint& point : obstacle.path) {
    to.add(point.time);
    to.add(point.displacement.value_or(Point3{}));
    to.add(point.axis_angle);
  }
}

Obstacle read_obstacle(ByteReader& from) {
  Obstacle obstacle;
  const auto kind = from.get<std::uint8_t>();
  if (kind == 0) {
    const auto plane = from.get<PlaneObstacle>();
    require(is_finite(plane.point) && is_finite(plane.normal) && norm(plane.normal) > 0,
            "no plane");
    obstacle.geometry = plane;
  } else if (kind == 1) {
    const auto sphere = from.get<SphereObstacle>();
    require(is_finite(sphere.center) && std::isfinite(sphere.radius), "no sphere");
    obstacle.geometry = sphere;
  } else if (kind == 2) {
    const auto capsule = from.get<CapsuleObstacle>();
    require(is_finite(capsule.from) && is_finite(capsule.to) && std::isfinite(capsule.radius),
            "no capsule");
    obstacle.geometry = capsule;
  } else {
    require(kind == 3, "no kind of an obstacle");
    Surface surface;
    surface.points = from.get_list<Point3>();
    surface.triangles = from.get_list<std::array<std::int32_t, 3>>();
    require(are_finite(surface.points) &&
                are_below(surface.triangles, static_cast<std::int64_t>(surface.points.size())),
            "no surface");
    obstacle.geometry = std::move(surface);
  }
  const std::size_t points = from.get_count(7 * sizeof(double));
  for (std::size_t p = 0; p < points; ++p) {
    PathPoint& point = obstacle.path.emplace_back();
    point.time = from.get<double>();
    point.displacement = from.get<Point3>();
    point.axis_angle = from.get<Point3>();
    require(std::isfinite(point.time) && is_finite(*point.displacement) &&
                is_finite(point.axis_angle) && (p == 0 || point.time > obstacle.path[p - 1].time),
            "no path");
  }
  return obstacle;
}

void write(ByteWriter& to, const SharedVolume& volume) {
  const RestVolume& source = volume.source;
  to.add(static_cast<std::uint64_t>(source.body.body));
  to.add(source.body.low);
  to.add(source.body.high);
  to.add(static_cast<std::uint8_t>(source.holds_labels));
  to.add(source.volume.grid);
  const auto samples = source.volume.samples<std::int16_t>();
  to.add_list(std::vector<std::int16_t>(samples.begin(), samples.end()));
  to.add_list(volume.mesh.rest_positions);
  to.add_list(volume.mesh.tets);
}

SharedVolume read_volume(ByteReader& from, const std::vector<SharedBody>& bodies) {
  SharedVolume volume;
  RestVolume& source = volume.source;
  const auto body = from.get<std::uint64_t>();
  require(body < bodies.size(), "a volume of no body");
  source.body = {static_cast<std::size_t>(body), from.get<double>(), from.get<double>()};
  require(std::isfinite(source.body.low) && std::isfinite(source.body.high) &&
              source.body.low < source.body.high,
          "no range of values");
  source.holds_labels = from.get_bool();
  const auto grid = from.get<Grid>();
  check_grid(grid, "volume");
  const auto samples = from.get_list<std::int16_t>();
  require(samples.size() == static_cast<std::size_t>(grid.voxel_count()), "a wrong count");
  source.volume = make_volume(grid, PixelType::int16);
  std::ranges::copy(samples, source.volume.samples<std::int16_t>().begin());
  volume.mesh.rest_positions = from.get_list<Point3>();
  volume.mesh.tets = from.get_list<std::array<std::int32_t, 4>>();
  check_mesh(volume.mesh);
  const SharedBody& moving = bodies[source.body.body];
  require(moving.form == BodyForm::nodes &&
              static_cast<std::size_t>(moving.moving_count) == volume.mesh.rest_positions.size(),
          "a volume whose nodes are not those of its body");
  return volume;
}
}  // namespace

Bytes bytes_of(const SharedScene& scene) {
  ByteWriter to;
  to.add_text(scene.name);
  to.add_text(scene.preset);
  to.add(scene.center);
  to.add(scene.size);
  to.add(scene.voxels);
  to.add(static_cast<std::uint64_t>(scene.bodies.size()));
  for (const SharedBody& body : scene.bodies) write(to, body);
  to.add(static_cast<std::uint64_t>(scene.obstacles.size()));
  for (const Obstacle& obstacle : scene.obstacles) write(to, obstacle);
  to.add(static_cast<std::uint64_t>(scene.volumes.size()));
  for (const SharedVolume& volume : scene.volumes) write(to, volume);
  return to.take();
}

SharedScene scene_of(std::span<const std::byte> bytes) {
  ByteReader from(bytes);
  SharedScene scene;
  scene.name = from.get_text();
  scene.preset = from.get_text();
  scene.center = from.get<Point3>();
  scene.size = from.get<double>();
  scene.voxels = from.get<std::int64_t>();
  require(is_finite(scene.center) && scene.size > 0 && std::isfinite(scene.size) &&
              scene.voxels > 0 && (scene.preset == "ct" || scene.preset == "mr"),
          "no head of a scene");
  for (std::size_t n = from.get_count(1); n > 0; --n) scene.bodies.push_back(read_body(from));
  for (std::size_t n = from.get_count(1); n > 0; --n) {
    scene.obstacles.push_back(read_obstacle(from));
  }
  for (std::size_t n = from.get_count(1); n > 0; --n) {
    scene.volumes.push_back(read_volume(from, scene.bodies));
  }
  from.end();
  return scene;
}

}  // namespace tetwarp::view
