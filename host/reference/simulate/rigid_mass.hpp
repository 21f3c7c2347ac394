/// @file rigid_mass.hpp
/// Mass, center and inertia of a rigid body from its closed surface.
#pragma once
#include "host/reference/simulate/vectors.hpp"

namespace tetwarp::reference {

struct RigidBody {
  int body = -1;                        ///< index in Scene::bodies
  double mass = 0;                      ///< [kg]; scripted: 0
  Vector3d center = Vector3d::Zero();   ///< of mass, in the frame of the geometry
  Matrix3d inertia = Matrix3d::Zero();  ///< about the center, axes of the geometry [kg m^2]
  double alpha = 0;                     ///< damping [1/s]
};

RigidBody rigid_of(const Body& body, const Surface& surface);

}  // namespace tetwarp::reference
