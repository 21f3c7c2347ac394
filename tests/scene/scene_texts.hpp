/// @file scene_texts.hpp
/// Scene files as texts, for the tests of their reader.
#pragma once
#include <string>

#include <tetwarp/scene_io.hpp>

#include "tests/support/message_of.hpp"

namespace tetwarp::test {

/// A scene that ships with the command.
inline Scene shipped(const std::string& name) {
  return parse_scene(scene_text(name), name);
}

/// A scene with every kind of body, obstacle and action and nearly every key, none by default.
inline const char* const full_scene = R"({
  "tetwarp_scene": 1, "time_step": 0.01, "duration": 0.5, "gravity": [1, 2, 3], "thickness": 1e-3,
  "contact": {"friction": 0.25,
    "adhesion": {"stiffness": 4e7, "tangential_stiffness": 3e7, "energy": 2, "viscosity": 0.05,
      "bonding_rate": 0.01, "saturation_pressure": 500, "initial_intensity": 0.5},
    "pairs": [{"a": "soft", "b": "floor", "friction": 0.75, "adhesion": null, "collide": false}]},
  "bodies": [
    {"name": "soft", "kind": "fem", "shape": {"type": "box", "half": [1, 2, 3]},
      "lattice": {"cells": [2, 4, 6]}, "surface": {"triangles": 500},
      "material": {"E": 1e5, "nu": 0.4, "density": 950}, "damping": {"alpha": 0.5, "gamma": 1e-3},
      "mass": "lumped", "cage_start": true, "collide": false, "self": true,
      "pose": {"position": [4, 5, 6], "axis_angle": [0, 0, 3.141592653589793]},
      "velocity": [7, 8, 9], "angular_velocity": [0.1, 0.2, 0.3], "contact": {"friction": 0.5},
      "fixed": {"box": [[-9, -9, -9], [9, 9, 3.5]]},
      "driven": [{"select": {"half_space": [0, 0, 1, 8.5]}, "path": [[0, 0, 0, 0], [1, 0, 0, 2]]}]},
    {"name": "stone", "kind": "rigid", "shape": {"type": "sphere", "radius": 0.5}, "mass": 3,
      "inertia": [1, 1.5, 2, 0.1, 0.2, 0.3], "contact": {"adhesion": null},
      "pose": {"quaternion": [0, 0, 2, 0]}},
    {"name": "ball", "kind": "rigid", "shape": {"type": "ellipsoid", "radii": [1, 2, 3]},
      "density": 1300},
    {"name": "flag", "kind": "cloth", "sheet": {"size": [1, 2], "cells": [3, 4],
        "origin": [5, 6, 7], "axes": [[0, 2, 0], [0, 0, 3]]},
      "areal_density": 0.3, "stretch": 400, "shear": 80, "bend": 2e-4,
      "fixed": [{"sphere": [5, 6, 7, 0.5]}, {"nodes": [0, 3]}, "all"]},
    {"name": "jaw", "kind": "scripted",
      "hinge": {"point": [0, 0, 1], "axis": [1, 0, 0], "angle": [[0, 0], [1, 0.5]]}},
    {"name": "fish", "kind": "scripted", "lattice": {"edge": 0.5},
      "shape": {"type": "capsule", "radius": 0.25, "length": 2},
      "wave": {"axis": 2, "lateral": 1, "frequency": 2, "wavelength": 0.5, "phase": 0.125,
        "envelope": [0.02, -0.08, 0.16]}},
    {"name": "tool", "kind": "scripted", "shape": {"type": "torus", "radius": 1, "tube": 0.25},
      "path": [[0, 1, 2, 3, 0.1, 0.2, 0.3]]},
    {"name": "arc", "kind": "fem", "lattice": {"tets": 90},
      "shape": {"type": "arc", "radius": 0.06, "tube": 0.014, "angles": [0.2, 2.2]},
      "material": {"E": 1e5, "nu": 0.4, "density": 1000}},
    {"name": "lip", "kind": "fem", "lattice": {"cells": [12, 3, 3]},
      "shape": {"type": "bent_strip", "width": 0.06, "height": 0.012, "depth": 0.014,
        "sag": -0.008}, "material": {"E": 3e4, "nu": 0.4, "density": 1050}},
    {"name": "plate", "kind": "rigid", "shape": {"type": "plate", "size": [0.1, 0.12, 0.012]},
      "density": 1000},
    {"name": "rod", "kind": "rigid", "shape": {"type": "cylinder", "radius": 0.1, "length": 2},
      "density": 1000},
    {"name": "fruit", "kind": "fem", "lattice": {"cells": [2, 2, 2]}, "lookup": "label",
      "mean": "harmonic", "volume": {"phantom": "orange", "dims": [8, 9, 10],
        "spacing": [0.01, 0.02, 0.03], "origin": [1, 2, 3], "threshold": 0.25},
      "transfer": [{"value": 0, "E": 0, "nu": 0.4, "density": 0},
        {"value": 1, "E": 4e5, "nu": 0.3, "density": 1100}],
      "fixed": {"label": 1}},
    {"name": "bone", "kind": "rigid", "density": 2000, "surface": {"triangles": 400},
      "shape": {"type": "loft", "tubes": [
        {"stations": [{"center": [0, 0, 0], "radii": [0.1, 0.2], "direction": [0, 1, 0]},
          {"center": [1, 0, 0], "radii": [0.1, 0.2]}], "ends": [0.3, 0.4]},
        {"stations": [{"center": [0, 0, 5], "radii": [0.1, 0.2]},
          {"center": [1, 0, 5], "radii": [0.1, 0.1]}]}]}},
    {"name": "muscle", "kind": "fem", "lattice": {"cells": [6, 2, 2]},
      "material": {"E": 2e5, "nu": 0.4, "density": 500}, "surface": {"triangles": 400},
      "shape": {"type": "loft", "stations": [{"center": [0, 0, 0], "radii": [0.1, 0.2]},
        {"center": [1, 0, 0], "radii": [0.1, 0.2]}]}}
  ],
  "obstacles": [
    {"name": "floor", "plane": {"normal": [0, 0, 2], "point": [0, 0, -9]},
      "path": [[0, 0, 0, 0], [1, 0, 0, 1]], "contact": {"friction": 1}},
    {"type": "sphere", "centre": [1, 2, 3], "radius": 4},
    {"name": "bar", "capsule": {"from": [1, 2, 3], "to": [4, 5, 6], "radius": 0.5}}
  ],
  "couplings": [
    {"name": "tie", "a": "soft", "b": "jaw", "select_a": "all", "within": 0.5, "stiffness": 1e4,
      "damping": 3, "collide": true},
    {"a": "stone", "b": "world", "points": [[0, 0, 0], [1, 0, 0]], "stiffness": 5},
    {"a": "stone", "b": "world", "points": [[2, 0, 0]], "stiffness": 6}
  ],
  "handles": [
    {"handle": "soft", "select": "all", "stiffness": 500, "damping": 2,
      "path": [[0, 0, 0, 0], [0.5, 0.03, 0, 0], [1, null, null, null]]},
    {"name": "grip", "handle": "soft", "select": {"nodes": [1]}, "stiffness": 5,
      "path": [[0, 0, 0, 0], [1, null]]}
  ],
  "loads": [
    {"load": "soft", "select": "all", "force": [1, 2, 3], "from": 0.1, "to": 0.2},
    {"load": "stone", "select": "all", "pressure": 100}
  ],
  "solver": {"contact_tolerance": 1e-5, "linear_tolerance": 1e-8, "max_passes": 3,
    "max_substeps": 4, "law": "pyramid", "rule": "restrictive", "sleeping": true},
  "output": {"every": 5, "fields": ["velocity", "stress"]},
  "camera": {"eye": [1, 2, 3], "target": [4, 5, 6], "up": [0, 1, 0], "angle": 0.75},
  "cameras": [{"name": "inside", "eye": [7, 8, 9], "target": [1, 1, 1], "angle": 1.25},
    {"name": "above", "eye": [0, 0, 9], "target": [0, 0, 0], "up": [1, 0, 0]}]
})";

/// The least that a scene can be.
inline const char* const small_scene = R"({"tetwarp_scene": 1, "time_step": 0.01, "duration": 1,
  "bodies": [{"name": "ball", "kind": "rigid", "shape": {"type": "sphere", "radius": 0.1},
    "density": 1000}]})";

inline Scene scene_of(const std::string& text) {
  return parse_scene(text, "s.json");
}

/// The message of the IoError about a text, without the name of the file.
inline std::string problem_of(const std::string& text) {
  const std::string message = message_of<IoError>([&] { scene_of(text); });
  return message.starts_with("s.json: ") ? message.substr(8) : message;
}

/// `text` with one part replaced.
inline std::string with(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) throw std::invalid_argument("no '" + part + "' in the text");
  return text.replace(at, part.size(), by);
}

}  // namespace tetwarp::test
