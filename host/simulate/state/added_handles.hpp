/// @file added_handles.hpp
/// Handles that a simulation gets while it runs.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/simulate/model/model.hpp"

namespace tetwarp {

struct SimulatedScene;

/// A handle that was added: springs between points of a body and anchors.
struct AddedHandle {
  std::string name;
  std::size_t body = 0;             ///< in Scene::bodies
  double stiffness = 0;             ///< in total [N/m]
  double damping = 0;               ///< in total [N s/m]
  std::vector<std::int32_t> nodes;  ///< of the body; rigid: none
  Point3 local{0, 0, 0};            ///< rigid: the point that is held, as ModelPoint::local
  std::vector<Point3> anchors;      ///< of each point where it started [m]

  bool operator==(const AddedHandle&) const = default;
};

/// Checks a handle and finds its points.
/// @param now  state of the bodies
/// @throws std::invalid_argument  in one line naming the member and the remedy
AddedHandle make_added_handle(const SimulatedScene& scene,
                              const PointHandle& handle,
                              const ModelState& now);

/// Whether a handle read from a checkpoint is one of the scene.
bool is_of_scene(const SimulatedScene& scene, const AddedHandle& handle);

/// Replaces the added handles of a scene and their springs in its model.
void set_added_handles(SimulatedScene& scene, const std::vector<AddedHandle>& added);

}  // namespace tetwarp
