/// @file shared_scene.hpp
/// SharedScene: what a screen gets once, when it joins: all that it draws but does not move.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/mesh.hpp>
#include <tetwarp/simulate.hpp>

#include "host/view/live_volumes.hpp"
#include "host/view/pick.hpp"
#include "host/view/screens/message_bytes.hpp"

namespace tetwarp::view {

/// What moves a body in a state.
enum class BodyForm : std::uint8_t {
  nodes,   ///< its nodes; points of the surface are weighted means of four of them
  points,  ///< the points of its surface
  pose     ///< a rotation and a place: bodies that keep their shape
};

struct SharedBody {
  BodyForm form = BodyForm::points;
  Triangles triangles;                                  ///< of points of the surface
  std::int64_t moving_count = 0;                        ///< nodes or points of a state; pose: 4
  std::vector<std::array<std::int32_t, 4>> nodes = {};  ///< [points], of form nodes
  std::vector<std::array<double, 4>> weights = {};      ///< [points], of form nodes
  std::vector<Point3> rest_points = {};                 ///< [points], of form pose
};

/// How many points of a body are drawn.
std::size_t point_count(const SharedBody& body);

/// A volume and the mesh that warps it, whose nodes are those of its body.
struct SharedVolume {
  RestVolume source;
  Mesh mesh;
};

struct SharedScene {
  std::string name, preset;
  Point3 center{};          ///< of the bodies at the start [m]
  double size = 1;          ///< diagonal of their box [m]
  std::int64_t voxels = 0;  ///< at most, of all warped volumes
  std::vector<SharedBody> bodies;
  std::vector<Obstacle> obstacles;
  std::vector<SharedVolume> volumes;
};

Bytes bytes_of(const SharedScene& scene);

/// Checks every index, count and number, so that what is drawn needs no more checks.
/// @throws std::invalid_argument  the bytes are not a scene
SharedScene scene_of(std::span<const std::byte> bytes);

}  // namespace tetwarp::view
