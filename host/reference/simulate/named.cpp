/// @file named.cpp
/// Searches lists of a scene for a name.
#include "host/reference/simulate/named.hpp"

#include <stdexcept>

#include "host/reference/simulate/make_system.hpp"

namespace tetwarp::reference {

int body_named(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].name == name) return static_cast<int>(b);
  }
  throw std::invalid_argument("no body is named " + name);
}

std::size_t handle_named(const Scene& scene, const std::string& name) {
  for (std::size_t h = 0; h < scene.handles.size(); ++h) {
    const Handle& handle = scene.handles[h];
    if ((handle.name.empty() ? handle.body : handle.name) == name) return h;
  }
  throw std::invalid_argument("no handle is named " + name);
}

std::size_t script_named(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].name == name && scene.bodies[b].kind == BodyKind::scripted) return b;
  }
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    if (scene.obstacles[o].name == name) return scene.bodies.size() + o;
  }
  throw std::invalid_argument("no scripted body or obstacle is named " + name);
}

}  // namespace tetwarp::reference
