/// @file scene_parts.hpp
/// Readers of the parts of a scene file. Each throws IoError naming file, key and remedy.
#pragma once
#include <functional>
#include <map>
#include <string>
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
  std::string path_of(const SceneValue& value) const;

  /// Has `read` called by read_all(), with its IoErrors put down to `value`.
  void add(const SceneValue& value, std::function<void()> read);

  /// The same for the volume of an image. Volumes with equal `content` are made once and copied.
  /// @param into  kept by the caller until read_all()
  void add_volume(const SceneValue& value,
                  const std::string& content,
                  Body& into,
                  std::function<Volume()> make);

  void read_all();

 private:
  std::string folder_;
  std::vector<std::function<void()>> reads_;
  std::map<std::string, const Volume*> volumes_;  // by content
};

// ---- scene_geometry.cpp ----
/// Reads shape, volume, mesh or sheet, of which at most one may be there.
void read_geometry(SceneObject& object, SceneFiles& files, Body& into);
void read_lattice(SceneObject& object, Body& into);
void read_surface_choice(SceneObject& object, SceneFiles& files, Body& into);
void read_pose(SceneObject& object, Pose& into);
/// Has a surface read from the file that `value` names. @param store  takes the surface
void read_surface_file(const SceneValue& value,
                       SceneFiles& files,
                       std::function<void(Surface)> store);

// ---- scene_motion.cpp ----
Selection read_selection(const SceneValue& value);
Path read_path(const SceneValue& value);
/// Reads path, hinge or wave, of which at most one may be there.
void read_motion(SceneObject& object, Motion& into);

// ---- scene_contact.cpp ----
/// Keys of `into` that are not there keep their values.
void read_contact_keys(SceneObject& object, SurfaceContact& into);
/// The key `contact` of a body or obstacle. @param scene  of bodies without their own
void read_contact(SceneObject& object,
                  const SurfaceContact& scene,
                  std::optional<SurfaceContact>& into);
SceneContact read_scene_contact(const SceneValue& value);

// ---- scene_body.cpp ----
void read_body(const SceneValue& value,
               const SurfaceContact& contact,
               SceneFiles& files,
               Body& into);

// ---- scene_actions.cpp ----
void read_obstacle(const SceneValue& value,
                   const SurfaceContact& contact,
                   SceneFiles& files,
                   Obstacle& into);
Coupling read_coupling(const SceneValue& value);
Handle read_handle(const SceneValue& value);
Load read_load(const SceneValue& value);

}  // namespace tetwarp
