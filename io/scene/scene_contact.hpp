/// @file scene_contact.hpp
/// Reads contact and adhesion of a scene file.
#pragma once
#include <optional>

#include <tetwarp/scene.hpp>

#include "io/scene/scene_json.hpp"

namespace tetwarp {

/// Keys of `into` that are not there keep their values.
void read_contact_keys(SceneObject& object, SurfaceContact& into);

/// The key `contact` of a body or obstacle. @param scene  of bodies without their own
void read_contact(SceneObject& object,
                  const SurfaceContact& scene,
                  std::optional<SurfaceContact>& into);
SceneContact read_scene_contact(const SceneValue& value);

}  // namespace tetwarp
