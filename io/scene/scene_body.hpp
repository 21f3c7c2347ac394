/// @file scene_body.hpp
/// Reads a body of a scene file.
#pragma once
#include <tetwarp/scene.hpp>

#include "io/scene/scene_files.hpp"
#include "io/scene/scene_json.hpp"

namespace tetwarp {

void read_body(const SceneValue& value,
               const SurfaceContact& contact,
               SceneFiles& files,
               Body& into);

}  // namespace tetwarp
