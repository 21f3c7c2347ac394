/// @file shipped_scenes.hpp
/// The scenes that ship, with other texts in them.
#pragma once
#include <algorithm>
#include <stdexcept>
#include <string>
#include <tetwarp/simulate.hpp>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/scene/scene_texts.hpp"

namespace tetwarp::test {

/// @param changes  texts before and after, all of which are there
inline Scene changed(const std::string& name,
                     const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = scene_text(name);
  for (const auto& [before, after] : changes) {
    std::size_t at = text.find(before);
    if (at == std::string::npos) throw std::runtime_error(name + " has no " + before);
    for (; at != std::string::npos; at = text.find(before, at + after.size())) {
      text.replace(at, before.size(), after);
    }
  }
  return parse_scene(text, name);
}

/// The jello and all sweets on meshes of a sixth of the triangles.
inline Scene coarse_candy() {
  return changed("candy", {{"\"triangles\": 5000", "\"triangles\": 800"},
                           {"\"triangles\": 1280", "\"triangles\": 200"},
                           {"\"triangles\": 320", "\"triangles\": 80"},
                           {"\"cells\": [12, 12, 4]", "\"cells\": [6, 6, 2]"},
                           {"\"tets\": 475", "\"tets\": 90"}});
}

/// Of the scene and its bodies.
inline void remove_adhesion(Scene& scene) {
  scene.contact.material.adhesion.reset();
  for (Body& body : scene.bodies) {
    if (body.contact) body.contact->adhesion.reset();
  }
}

/// Contacts that carry an impulse.
inline std::int64_t pushing_count(const Simulator& simulator) {
  const std::vector<ContactPoint> contacts = simulator.contacts();
  return std::count_if(contacts.begin(), contacts.end(),
                       [](const ContactPoint& c) { return norm(c.impulse) > 0; });
}

}  // namespace tetwarp::test
