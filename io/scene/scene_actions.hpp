/// @file scene_actions.hpp
/// Reads obstacles, couplings, handles and loads of a scene file.
#pragma once
#include <tetwarp/scene.hpp>

#include "io/scene/scene_files.hpp"
#include "io/scene/scene_json.hpp"

namespace tetwarp {

void read_obstacle(const SceneValue& value,
                   const SurfaceContact& contact,
                   SceneFiles& files,
                   Obstacle& into);
Coupling read_coupling(const SceneValue& value);
Handle read_handle(const SceneValue& value);
Load read_load(const SceneValue& value);

}  // namespace tetwarp
