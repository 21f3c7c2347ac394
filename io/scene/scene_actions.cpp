/// @file scene_actions.cpp
/// Obstacles, couplings, handles and loads of scene files.
#include "io/scene/scene_actions.hpp"

#include <algorithm>
#include <array>

#include "io/scene/scene_contact.hpp"
#include "io/scene/scene_files.hpp"
#include "io/scene/scene_geometry.hpp"
#include "io/scene/scene_motion.hpp"

namespace tetwarp {
namespace {
constexpr std::array<const char*, 4> obstacle_types{"plane", "sphere", "capsule", "mesh"};

void read_obstacle_shape(const std::string& type,
                         SceneObject& object,
                         SceneFiles& files,
                         Obstacle& into) {
  if (type == "plane") {
    PlaneObstacle plane;
    plane.normal = object.get("normal", "the direction [x, y, z] of free space").point();
    object.read("point", plane.point);
    into.geometry = plane;
  } else if (type == "sphere") {
    SphereObstacle sphere;
    sphere.center = object.get("centre", "a point [x, y, z]").point();
    sphere.radius = object.get("radius", "a number above 0 (m)").number();
    into.geometry = sphere;
  } else if (type == "capsule") {
    CapsuleObstacle capsule;
    capsule.from = object.get("from", "the point [x, y, z] where its axis starts").point();
    capsule.to = object.get("to", "the point [x, y, z] where its axis ends").point();
    capsule.radius = object.get("radius", "a number above 0 (m)").number();
    into.geometry = capsule;
  } else {
    read_surface_file(object.get("file", "the name of a file of triangles"), files,
                      [&into](Surface surface) { into.geometry = std::move(surface); });
  }
}
}  // namespace

void read_obstacle(const SceneValue& value,
                   const SurfaceContact& contact,
                   SceneFiles& files,
                   Obstacle& into) {
  SceneObject object(value);
  if (const auto name = object.find("name")) into.name = name->text();
  read_contact(object, contact, into.contact);
  if (const auto path = object.find("path")) into.path = read_path(*path);
  int count = 0;
  for (const char* const type : obstacle_types) {
    if (const auto shape = object.find(type)) {
      SceneObject shape_object(*shape);
      read_obstacle_shape(type, shape_object, files, into);
      shape_object.finish();
      ++count;
    }
  }
  if (const auto type = object.find("type")) {  // the keys of the shape beside the name
    const std::string word = type->text();
    if (std::find(obstacle_types.begin(), obstacle_types.end(), word) == obstacle_types.end()) {
      type->fail("is no type of obstacle, expected plane, sphere, capsule or mesh");
    }
    read_obstacle_shape(word, object, files, into);
    ++count;
  }
  object.finish();
  if (count != 1) value.fail("expected exactly one of plane, sphere, capsule and mesh");
}

Coupling read_coupling(const SceneValue& value) {
  SceneObject object(value);
  Coupling coupling;
  if (const auto name = object.find("name")) coupling.name = name->text();
  coupling.a = object.get("a", "the name of a body").text();
  coupling.b = object.get("b", "the name of a body or obstacle, or \"world\"").text();
  const auto select = object.find("select_a");
  const auto points = object.find("points");
  if (select.has_value() == points.has_value()) {
    value.fail("expected either select_a or points");
  }
  if (select) coupling.select_a = read_selection(*select);
  if (points) {
    for (const SceneValue& point : points->items()) coupling.points.push_back(point.point());
    if (coupling.points.empty()) points->fail("is empty, expected [[x, y, z], ...]");
  }
  object.read("within", coupling.within);
  coupling.stiffness = object.get("stiffness", "a number above 0 (N/m in total)").number();
  object.read("damping", coupling.damping);
  object.read("collide", coupling.collide);
  object.finish();
  return coupling;
}

Handle read_handle(const SceneValue& value) {
  SceneObject object(value);
  Handle handle;
  if (const auto name = object.find("name")) handle.name = name->text();
  handle.body = object.get("handle", "the name of a body").text();
  handle.select = read_selection(object.get("select", "a selection, e.g. \"all\""));
  handle.stiffness = object.get("stiffness", "a number above 0 (N/m in total)").number();
  object.read("damping", handle.damping);
  if (const auto path = object.find("path")) handle.path = read_path(*path);
  object.finish();
  return handle;
}

Load read_load(const SceneValue& value) {
  SceneObject object(value);
  Load load;
  load.body = object.get("load", "the name of a body").text();
  load.select = read_selection(object.get("select", "a selection, e.g. \"all\""));
  if (const auto force = object.find("force")) load.force = force->point();
  object.read("pressure", load.pressure);
  object.read("from", load.from);
  object.read("to", load.to);
  object.finish();
  return load;
}

}  // namespace tetwarp
