/// @file scene_files.hpp
/// The files that a scene names.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/scene.hpp>

#include "io/scene/scene_json.hpp"

namespace tetwarp {

/// The volumes and meshes that a scene names. They are read after all of the text, so that a slip
/// of the pen is reported without waiting for them.
class SceneFiles {
 public:
  explicit SceneFiles(std::string folder) : folder_(std::move(folder)) {}

  /// The file that a value names, relative to the folder of the scene.
  std::string path_of(const SceneValue& value);

  /// All results of path_of().
  const std::vector<std::string>& names() const { return names_; }

  /// Has `read` called by read_all(), with its IoErrors and invalid arguments put down to
  /// `value`.
  void add(const SceneValue& value, std::function<void()> read);

  /// The same for the volume of an image. Volumes with equal `content` are made once and copied.
  /// @param into  kept by the caller until read_all()
  void add_volume(const SceneValue& value,
                  const std::string& content,
                  Body& into,
                  std::function<Volume()> make);

  void read_all();

  /// Meshes and triangles; what was merged in them is noted.
  Mesh read_mesh(const std::string& path);
  Surface read_triangles(const std::string& path);
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void note(const std::string& path, const std::string& merged);

  std::string folder_;
  std::vector<std::string> names_;
  std::vector<std::function<void()>> reads_;
  std::map<std::string, const Volume*> volumes_;  // by content
  std::vector<std::string> notes_;                // a line for each file
};

}  // namespace tetwarp
