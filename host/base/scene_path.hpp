/// @file scene_path.hpp
/// Places in a scene as scene files spell them: "bodies[2].lattice.cells".
#pragma once
#include <cstddef>
#include <string>

namespace tetwarp {

/// Path of a key in a scene file, as in `bodies[2].lattice`.
/// @param place  path of the object that holds the key; empty: the scene itself
inline std::string key_of(const std::string& place, const std::string& key) {
  return place.empty() ? key : place + "." + key;
}

/// The place of an item of a list.
inline std::string item_of(const std::string& place, std::size_t index) {
  return place + "[" + std::to_string(index) + "]";
}

}  // namespace tetwarp
