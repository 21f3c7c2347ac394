/// @file view_options.hpp
/// Options of the program tetwarp-view, which the command starts.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace tetwarp::view {

/// Choices of a window. Numbers have been checked by the command.
struct ViewOptions {
  std::string scene_file;
  std::string scene_name;  ///< of a scene that ships with the command, instead of a file
  std::string backend = "auto";
  std::int64_t device = 0, threads = 0;
  double max_step_seconds = std::numeric_limits<double>::infinity();
  bool untangle = false;
  bool paused = false;
  bool fast = false;                            ///< no waiting for the time of the scene
  std::optional<std::int64_t> steps;            ///< then the window closes
  std::int64_t width = 960, height = 640;       ///< [pixel]
  std::optional<std::array<double, 6>> camera;  ///< eye, target
  std::string camera_name;                      ///< of one of the scene, instead
  std::string preset = "ct";                    ///< colors of volumes: ct or mr
  std::string colors = "none";                  ///< of surfaces: stress, gap, adhesion
  std::int64_t voxels = 2'000'000;              ///< at most, of all warped volumes
  std::optional<double> grab_radius;            ///< [m]
  std::optional<double> grab_stiffness;         ///< [N/m]
  std::optional<std::array<double, 4>> ball;    ///< center and radius of a ball to push with
  /// Centers of the outer and the inner finger, and their radius.
  std::optional<std::array<double, 7>> fingers;
  double skin_stiffness = 500;                                        ///< between the fingers [N/m]
  std::string screenshot, film, record, replay, checkpoint, restart;  ///< files; empty: none
  std::string screens;            ///< room file or name of one that ships; empty: none
  std::string address;            ///< that a master listens at, in place of the room's
  std::string key;                ///< file of keys; empty: none
  std::string join, screen;       ///< address of the master to follow, name of the screen to show
  bool ends_with_master = false;  ///< of a screen that the master started
  bool timing = false;            ///< says at the end what took how long
  /// Sends poses of the head instead of showing a screen: "-" those of the standard input, else
  /// those of a tracker, see open_tracked_device(). Empty: it shows a screen.
  std::string tracker;
  std::string devices;    ///< names between commas, see open_devices()
  std::string make_keys;  ///< name of key files to write, instead of all else

  bool operator==(const ViewOptions&) const = default;

  /// The scene, for messages.
  const std::string& scene() const { return scene_file.empty() ? scene_name : scene_file; }
  /// The files that it writes, but for the keys.
  std::vector<std::string> outputs() const;
  /// The scene with what options add to it, as a record of input names it.
  std::string scene_words() const;
};

/// One word per member that is not its default: name=value.
std::vector<std::string> words_of(const ViewOptions& options);

/// @throws std::invalid_argument  naming a word that words_of() does not write
ViewOptions options_of(const std::vector<std::string>& words);

}  // namespace tetwarp::view
