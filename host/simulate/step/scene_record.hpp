/// @file scene_record.hpp
/// Energies, momenta and the places of bodies in a state.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Whether no number is infinite or undefined.
bool is_finite_state(const ModelState& state);

/// Tetrahedra of negative volume.
std::int64_t inverted_count(const Model& model, const ModelState& state);

/// omega = R I^-1 R^T L of a rigid body; of a prescribed frame 0.
Point3 angular_velocity_of(const Model& model, const ModelState& state, std::int32_t rigid);

/// Fills energies without work, momenta, and of each body center, velocity, angular momentum,
/// rotation and angular velocity. Sums are in index order.
/// @param handles  displacements of the anchors of each handle; nothing: let go
/// @param record   `bodies` has one entry per body of the scene; `energy.elastic` is that of the
///                 tetrahedra, those of springs and bending are added
void record_state(const Model& model,
                  const ModelState& state,
                  const Point3& gravity,
                  const std::vector<std::optional<Point3>>& handles,
                  StepRecord& record);

}  // namespace tetwarp
