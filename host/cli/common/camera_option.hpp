/// @file camera_option.hpp
/// The option --camera: six numbers, or the name of a camera of the scene.
#pragma once
#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>

namespace tetwarp::cli {

/// Its words; at most one of the members is given.
struct CameraOption {
  std::optional<std::array<double, 6>> numbers;  ///< eye, target
  std::string name;                              ///< of a camera of the scene

  bool is_given() const { return numbers.has_value() || !name.empty(); }
};

/// Declares --camera. Words that are neither six numbers nor a name, and an eye that is where it
/// looks, are a CLI::ValidationError.
/// @param usual  what is shown without it
CLI::Option* add_camera(CLI::App& app, CameraOption& camera, const std::string& usual);

}  // namespace tetwarp::cli
