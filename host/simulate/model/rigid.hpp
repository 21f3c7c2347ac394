/// @file rigid.hpp
/// Adds rigid bodies and prescribed frames to a model.
#pragma once
#include <array>
#include <cstdint>

#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Mass, center and inertia about it, in the frame of the geometry.
struct RigidProperties {
  double mass = 0;                  ///< [kg]
  Point3 center{0, 0, 0};           ///< [m]
  std::array<double, 9> inertia{};  ///< row major [kg m^2]
};

/// Of a closed surface filled with a density.
RigidProperties properties_of(const Surface& surface, double density);

/// A rigid body, with its state at the start.
/// @throws std::invalid_argument  naming the body: no volume, inertia not positive
void add_rigid(const BodyPart& part, Model& model);

/// A prescribed frame at `pose`. @returns its number among the rigid bodies
std::int32_t add_frame(std::int32_t body, const Pose& pose, Model& model);

}  // namespace tetwarp
