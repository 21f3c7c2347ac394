/// @file scene_files.cpp
/// Reads the files that a scene names, equal volumes once.
#include "io/scene/scene_files.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <tetwarp/io.hpp>
#include <tetwarp/scene_io.hpp>
#include <utility>

namespace tetwarp {

std::string SceneFiles::path_of(const SceneValue& value) {
  const std::string name = value.text();
  if (name.empty()) value.fail("is empty, expected the name of a file");
  names_.push_back((std::filesystem::path(folder_) / name).string());
  return names_.back();
}

void SceneFiles::add(const SceneValue& value, std::function<void()> read) {
  reads_.push_back([value, read = std::move(read)] {
    try {
      read();
    } catch (const IoError& error) {
      value.fail(error.what());
    } catch (const std::invalid_argument& error) {
      value.fail(error.what());
    }
  });
}

void SceneFiles::add_volume(const SceneValue& value,
                            const std::string& content,
                            Body& into,
                            std::function<Volume()> make) {
  add(value, [this, content, &into, make = std::move(make)] {
    Volume& volume = std::get<ImageGeometry>(into.geometry).volume;
    const auto [found, is_new] = volumes_.emplace(content, &volume);
    volume = is_new ? make() : *found->second;
  });
}

void SceneFiles::read_all() {
  for (const std::function<void()>& read : reads_) read();
}

Mesh SceneFiles::read_mesh(const std::string& path) {
  const MeshReader reader(path);
  note(path, reader.header().merged);
  return reader.mesh();
}

Surface SceneFiles::read_triangles(const std::string& path) {
  std::string merged;
  Surface surface = read_surface(path, nullptr, &merged);
  note(path, merged);
  return surface;
}

void SceneFiles::note(const std::string& path, const std::string& merged) {
  const std::string line = path + ": " + merged;
  if (!merged.empty() && std::ranges::count(notes_, line) == 0) notes_.push_back(line);
}

}  // namespace tetwarp
