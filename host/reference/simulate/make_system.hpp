/// @file make_system.hpp
/// The System of a scene and its state at the start.
#pragma once
#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {

System make_system(const Scene& scene, const SceneGeometry& geometry);
State start_of(const System& system);

}  // namespace tetwarp::reference
