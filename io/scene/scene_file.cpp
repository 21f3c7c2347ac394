/// @file scene_file.cpp
/// Scene files: the keys of the scene itself, the files that it names, and the checks.
#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <stdexcept>
#include <tetwarp/contact.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/scene_io.hpp>

#include "io/files/text_file.hpp"
#include "io/scene/scene_actions.hpp"
#include "io/scene/scene_body.hpp"
#include "io/scene/scene_contact.hpp"
#include "io/scene/scene_files.hpp"

namespace tetwarp {
namespace {
namespace fs = std::filesystem;

SceneSolver read_solver(const SceneValue& value) {
  SceneObject object(value);
  SceneSolver solver;
  object.read("contact_tolerance", solver.contact_tolerance);
  object.read("linear_tolerance", solver.linear_tolerance);
  const auto read_count = [&](const char* key, int& into) {
    constexpr std::int64_t largest = std::numeric_limits<int>::max();  // check_scene() has less
    if (const auto count = object.find(key))
      into = static_cast<int>(std::min(count->whole(1), largest));
  };
  read_count("max_passes", solver.max_passes);
  read_count("max_substeps", solver.max_substeps);
  if (const auto law = object.find("law")) {
    solver.pyramid = law->word<FrictionLaw>() == FrictionLaw::pyramid;
  }
  if (const auto rule = object.find("rule")) {
    solver.restrictive = rule->word<AdhesionRule>() == AdhesionRule::restrictive;
  }
  object.read("sleeping", solver.sleeping);
  object.finish();
  return solver;
}

SceneOutput read_output(const SceneValue& value) {
  SceneObject object(value);
  SceneOutput output;
  const auto every = object.find("every");
  const auto rate = object.find("rate");
  if (every && rate) value.fail("expected either every or rate");
  if (every) output.every = every->whole(1);
  if (rate) output.rate = rate->number();
  if (const auto fields = object.find("fields")) {
    for (const SceneValue& field : fields->items()) output.fields.push_back(field.text());
  }
  object.finish();
  return output;
}

void read_camera(SceneObject& object, Camera& camera) {
  camera.eye = object.get("eye", "the place of the camera [x, y, z]").point();
  camera.target = object.get("target", "the place in the middle of the picture").point();
  object.read("up", camera.up);
  object.read("angle", camera.angle);
  object.finish();
}

SceneCamera read_scene_camera(const SceneValue& value) {
  SceneObject object(value);
  SceneCamera own;
  own.name = object.get("name", "the name by which options choose it").text();
  read_camera(object, own.camera);
  return own;
}

void read_bodies(SceneObject& object, SceneFiles& files, Scene& scene) {
  const SurfaceContact& contact = scene.contact.material;
  const std::vector<SceneValue> bodies = object.get("bodies", "a list of bodies").items();
  scene.bodies.resize(bodies.size());  // first: the files to read refer to them
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    read_body(bodies[b], contact, files, scene.bodies[b]);
  }
  const auto found = object.find("obstacles");
  if (!found) return;
  const std::vector<SceneValue> obstacles = found->items();
  scene.obstacles.resize(obstacles.size());
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    scene.obstacles[o].name = "obstacle" + std::to_string(o);
    read_obstacle(obstacles[o], contact, files, scene.obstacles[o]);
  }
}

/// Gives couplings and handles without a name one that no other has.
template <class Item, class Base>
void name_items(std::vector<Item>& items, Base base_of) {
  std::set<std::string> names;
  for (const Item& item : items) names.insert(item.name);
  for (Item& item : items) {
    if (!item.name.empty()) continue;
    const std::string base = base_of(item);
    item.name = base;
    for (int n = 2; !names.insert(item.name).second; ++n)
      item.name = base + "-" + std::to_string(n);
  }
}

template <class Item>
void read_list(SceneObject& object,
               const char* key,
               Item (*read)(const SceneValue&),
               std::vector<Item>& into) {
  const auto list = object.find(key);
  if (!list) return;
  for (const SceneValue& item : list->items()) into.push_back(read(item));
}

Scene read_keys(const SceneValue& value, SceneFiles& files) {
  SceneObject object(value, "a scene {\"tetwarp_scene\": 1, ...}");
  const SceneValue version = object.get("tetwarp_scene", "1, the version of scene files");
  if (version.number() != 1) version.fail("is no version that this program reads, expected 1");
  Scene scene;
  scene.time_step = object.get("time_step", "the length of a step in s").number();
  scene.duration = object.get("duration", "the time to simulate in s").number();
  object.read("gravity", scene.gravity);
  object.read("thickness", scene.thickness);
  if (const auto contact = object.find("contact")) scene.contact = read_scene_contact(*contact);
  read_bodies(object, files, scene);
  read_list(object, "couplings", read_coupling, scene.couplings);
  name_items(scene.couplings, [](const Coupling& c) { return c.a + "-" + c.b; });
  read_list(object, "handles", read_handle, scene.handles);
  name_items(scene.handles, [](const Handle& h) { return h.body; });
  read_list(object, "loads", read_load, scene.loads);
  if (const auto solver = object.find("solver")) scene.solver = read_solver(*solver);
  if (const auto output = object.find("output")) scene.output = read_output(*output);
  if (const auto camera = object.find("camera")) {
    SceneObject own(*camera);
    read_camera(own, scene.camera.emplace());
  }
  read_list(object, "cameras", read_scene_camera, scene.cameras);
  object.finish();
  return scene;
}
}  // namespace

Scene parse_scene(const std::string& text,
                  const std::string& name,
                  const std::string& folder,
                  std::vector<std::string>* names) {
  const SceneJson json = parse_json(text, name);
  SceneFiles files(folder);
  Scene scene = read_keys(SceneValue(json, name, ""), files);
  files.read_all();
  scene.notes = files.notes();
  if (names != nullptr) *names = files.names();
  try {
    check_scene(scene);
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    const std::size_t end = message.find(": ");
    throw IoError(name, message.substr(0, end), message.substr(end + 2));
  }
  return scene;
}

Scene read_scene(const std::string& file, std::vector<std::string>* files) {
  return parse_scene(read_text(file), file, fs::path(file).parent_path().string(), files);
}

}  // namespace tetwarp
