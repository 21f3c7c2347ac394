/// @file simulate_scene.hpp
/// A small scene for the tests of `tetwarp simulate`.
#pragma once
#include <string>
#include <vector>

#include "tests/support/running_scene.hpp"

namespace tetwarp::test {

/// A soft beam that is held at one end, a ball on a spring, an image that falls; 12 steps.
inline constexpr const char* small_scene = R"({
  "tetwarp_scene": 1, "time_step": 0.01, "duration": 0.12,
  "bodies": [
    {"name": "beam", "kind": "fem", "shape": {"type": "box", "half": [0.2, 0.05, 0.05]},
     "lattice": {"cells": [4, 1, 1]}, "material": {"E": 1e5, "nu": 0.3, "density": 1000},
     "fixed": {"half_space": [-1, 0, 0, 0.19]}},
    {"name": "ball", "kind": "rigid", "shape": {"type": "sphere", "radius": 0.1}, "density": 500,
     "pose": {"position": [0, 0, 1]}, "angular_velocity": [1, 2, 3]},
    {"name": "fruit", "kind": "fem",
     "volume": {"phantom": "orange", "dims": [16, 16, 12], "spacing": [0.01, 0.01, 0.01]},
     "lattice": {"cells": [2, 2, 2]}, "material": {"E": 1e4, "nu": 0.3, "density": 900},
     "pose": {"position": [1, 0, 0]}, "velocity": [0, 1, 0]}],
  "couplings": [{"a": "ball", "b": "world", "points": [[0, 0, 1.1]], "stiffness": 500}],
  "output": {"every": 5}})";

/// A folder with the scene above as scene.json.
class SimulateScene : public TemporaryFolder {
 public:
  SimulateScene() { write_text(*this / "scene.json", small_scene); }

  CommandResult simulate(std::vector<std::string> words) const {
    words.insert(words.begin(), {"simulate", "scene.json", "--quiet"});
    return run_command(*this, words);
  }
  std::string in(const std::string& folder, const std::string& name) const {
    return (path() / folder / name).string();
  }
};

}  // namespace tetwarp::test
