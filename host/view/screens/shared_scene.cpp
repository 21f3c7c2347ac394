/// @file shared_scene.cpp
/// A scene as bytes.
#include "host/view/screens/shared_scene.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <type_traits>
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

void check(const SharedBody& body) {
  require(body.form <= BodyForm::pose, "no form of a body");
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
  require(are_below(body.triangles, static_cast<std::int64_t>(point_count(body))),
          "a point that is not there");
}

void check(const PlaneObstacle& plane) {
  require(is_finite(plane.point) && is_finite(plane.normal) && norm(plane.normal) > 0, "no plane");
}
void check(const SphereObstacle& sphere) {
  require(is_finite(sphere.center) && std::isfinite(sphere.radius), "no sphere");
}
void check(const CapsuleObstacle& capsule) {
  require(is_finite(capsule.from) && is_finite(capsule.to) && std::isfinite(capsule.radius),
          "no capsule");
}
void check(const Surface& surface) {
  require(are_finite(surface.points) &&
              are_below(surface.triangles, static_cast<std::int64_t>(surface.points.size())),
          "no surface");
}

void check(const Obstacle& obstacle) {
  std::visit([](const auto& geometry) { check(geometry); }, obstacle.geometry);
  for (std::size_t p = 0; p < obstacle.path.size(); ++p) {
    const PathPoint& point = obstacle.path[p];
    require(std::isfinite(point.time) && is_finite(point.displacement.value_or(Point3{})) &&
                is_finite(point.axis_angle) && (p == 0 || point.time > obstacle.path[p - 1].time),
            "no path");
  }
}

void check(const SharedVolume& volume, const std::vector<SharedBody>& bodies) {
  const VolumeBody& source = volume.source.body;
  require(source.body < bodies.size(), "a volume of no body");
  require(std::isfinite(source.low) && std::isfinite(source.high) && source.low < source.high,
          "no range of values");
  check_mesh(volume.mesh);
  const SharedBody& moving = bodies[source.body];
  require(moving.form == BodyForm::nodes &&
              static_cast<std::size_t>(moving.moving_count) == volume.mesh.rest_positions.size(),
          "a volume whose nodes are not those of its body");
}

std::vector<std::int16_t> samples_of(const Volume& volume) {
  if (volume.type != PixelType::int16) return {};
  const auto samples = volume.samples<std::int16_t>();
  return {samples.begin(), samples.end()};
}

/// @throws std::invalid_argument  the samples do not fill the grid
Volume volume_of(const Grid& grid, const std::vector<std::int16_t>& samples) {
  check_grid(grid, "volume");
  require(samples.size() == static_cast<std::size_t>(grid.voxel_count()), "a wrong count");
  Volume volume = make_volume(grid, PixelType::int16);
  std::ranges::copy(samples, volume.samples<std::int16_t>().begin());
  return volume;
}
}  // namespace

std::size_t point_count(const SharedBody& body) {
  if (body.form == BodyForm::nodes) return body.nodes.size();
  return body.form == BodyForm::pose ? body.rest_points.size()
                                     : static_cast<std::size_t>(body.moving_count);
}

// Each of these functions writes with a ByteWriter and reads with a ByteReader.

template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, SharedBody>
void exchange_members(Stream& stream, Value& body) {
  auto& [form, triangles, moving_count, nodes, weights, rest_points] = body;
  stream(form, triangles, moving_count, nodes, weights, rest_points);
}

template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, Surface>
void exchange_members(Stream& stream, Value& surface) {
  stream(surface.points, surface.triangles);
}

template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, SharedVolume>
void exchange_members(Stream& stream, Value& volume) {
  auto& [body, image, holds_labels] = volume.source;
  Grid grid = image.grid;
  std::vector<std::int16_t> samples = samples_of(image);
  stream(body, holds_labels, grid, samples, volume.mesh.rest_positions, volume.mesh.tets);
  if constexpr (!std::is_const_v<Value>) image = volume_of(grid, samples);
}

template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, SharedScene>
void exchange_members(Stream& stream, Value& scene) {
  auto& [name, preset, center, size, voxels, bodies, obstacles, volumes] = scene;
  stream(name, preset, center, size, voxels, bodies);
  stream.pass_list(obstacles, [](auto& of, auto& obstacle) {
    of(obstacle.geometry);
    of.pass_list(obstacle.path, [](auto& path, auto& point) {
      path(point.time, point.displacement, point.axis_angle);
    });
  });
  stream(volumes);
}

Bytes bytes_of(const SharedScene& scene) {
  return bytes_of_values(scene);
}

SharedScene scene_of(std::span<const std::byte> bytes) {
  auto scene = read_values<SharedScene>(bytes);
  require(is_finite(scene.center) && scene.size > 0 && std::isfinite(scene.size) &&
              scene.voxels > 0 && (scene.preset == "ct" || scene.preset == "mr"),
          "no head of a scene");
  for (const SharedBody& body : scene.bodies) check(body);
  for (const Obstacle& obstacle : scene.obstacles) check(obstacle);
  for (const SharedVolume& volume : scene.volumes) check(volume, scene.bodies);
  return scene;
}

}  // namespace tetwarp::view
