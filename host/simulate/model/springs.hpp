/// @file springs.hpp
/// Adds the springs of couplings and handles to a model.
#pragma once
#include <cstdint>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Springs of a handle between points and anchors, which stand where the points start.
/// @param index   of the handle in Scene::handles
/// @param shares  [points] of its stiffness and damping
void add_handle_springs(const Handle& handle,
                        std::int32_t index,
                        const std::vector<ModelPoint>& points,
                        const std::vector<double>& shares,
                        Model& model);

/// Springs of couplings and handles.
/// @throws std::invalid_argument  naming the coupling: nothing within its distance
void add_springs(const Scene& scene, const SceneGeometry& geometry, Model& model);

}  // namespace tetwarp
