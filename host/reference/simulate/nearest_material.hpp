/// @file nearest_material.hpp
/// The material point nearest to a place, in the reference.
#pragma once
#include <string>

#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {

/// The index of a frame that stands for an obstacle; made where there is none yet.
int obstacle_frame(System& system, int obstacle);

/// The point of body or obstacle `name` nearest to x at the start, and its distance.
struct NearestMaterial {
  MaterialPoint point;
  double distance = 0;
};
NearestMaterial nearest_material(const std::string& name,
                                 const Vector3d& x,
                                 const State& start,
                                 const System& system);

/// The same, but of a rigid body always the point of its frame that is at x.
MaterialPoint tied_point(const std::string& name,
                         const Vector3d& x,
                         const State& start,
                         const System& system);

}  // namespace tetwarp::reference
