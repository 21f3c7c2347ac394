/// @file named.hpp
/// Bodies, handles and scripts of a scene by name.
#pragma once
#include <cstddef>
#include <string>

#include <tetwarp/scene.hpp>

namespace tetwarp::reference {

/// Indices by name. @throws std::invalid_argument if there is none
int body_named(const Scene& scene, const std::string& name);
std::size_t handle_named(const Scene& scene, const std::string& name);

/// Of Overrides::bodies.
std::size_t script_named(const Scene& scene, const std::string& name);

}  // namespace tetwarp::reference
