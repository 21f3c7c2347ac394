/// @file scene_loft.hpp
/// Reads shapes of type loft.
#pragma once
#include <tetwarp/scene.hpp>

#include "io/scene/scene_files.hpp"
#include "io/scene/scene_json.hpp"

namespace tetwarp {

/// Reads `stations` and `ends`, or `tubes`, of a shape whose type has been read. The surface or
/// tetrahedra of the body are made once all of its keys have been read.
/// @param into  of a kind that has been read; kept by the caller until files.read_all()
void read_loft(const SceneValue& shape, SceneObject& object, SceneFiles& files, Body& into);

}  // namespace tetwarp
