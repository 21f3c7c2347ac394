/// @file springs.hpp
/// Adds the springs of couplings and handles to a model.
#pragma once
#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Springs of couplings and handles.
/// @throws std::invalid_argument  naming the coupling: nothing within its distance
void add_springs(const Scene& scene, const SceneGeometry& geometry, Model& model);

}  // namespace tetwarp
