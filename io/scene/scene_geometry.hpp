/// @file scene_geometry.hpp
/// Reads shapes, volumes, meshes, sheets, lattices, surfaces and poses of a scene file.
#pragma once
#include <functional>

#include <tetwarp/scene.hpp>

#include "io/scene/scene_files.hpp"
#include "io/scene/scene_json.hpp"

namespace tetwarp {

/// Reads shape, volume, mesh or sheet, of which at most one may be there.
void read_geometry(SceneObject& object, SceneFiles& files, Body& into);
void read_lattice(SceneObject& object, Body& into);
void read_surface_choice(SceneObject& object, SceneFiles& files, Body& into);
void read_pose(SceneObject& object, Pose& into);

/// Has a surface read from the file that `value` names. @param store  takes the surface
void read_surface_file(const SceneValue& value,
                       SceneFiles& files,
                       std::function<void(Surface)> store);

}  // namespace tetwarp
