/// @file scene_motion.hpp
/// Reads selections, paths and motions of a scene file.
#pragma once
#include <tetwarp/scene.hpp>

#include "io/scene/scene_json.hpp"

namespace tetwarp {

Selection read_selection(const SceneValue& value);
Path read_path(const SceneValue& value);

/// Reads path, hinge or wave, of which at most one may be there.
void read_motion(SceneObject& object, Motion& into);

}  // namespace tetwarp
