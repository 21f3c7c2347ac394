/// @file body_part.hpp
/// A body on its way into a model.
#pragma once
#include <cstdint>
#include <string>

#include "host/scene/scene_geometry.hpp"

namespace tetwarp {

/// One body that is added to a model. Its nodes have been given numbers from `first_node` on.
struct BodyPart {
  const Body& body;
  const BodyGeometry& geometry;
  std::int32_t index = 0;  ///< in Scene::bodies
  std::int32_t first_node = 0;
};

/// "bodies[2] 'NAME': "
inline std::string error_prefix(const BodyPart& part) {
  return "bodies[" + std::to_string(part.index) + "] '" + part.body.name + "': ";
}

}  // namespace tetwarp
