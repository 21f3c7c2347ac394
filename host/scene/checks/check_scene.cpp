/// @file check_scene.cpp
/// Checks of a scene as a whole: times, names, and what refers to bodies.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <variant>

#include "host/base/point3.hpp"
#include "host/scene/checks/check_body.hpp"
#include "host/scene/checks/check_geometry.hpp"
#include "host/scene/checks/check_motion.hpp"
#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
constexpr double most_steps = 1e9;

/// "a, b, c", at most six of them.
std::string listed(const SceneNames& names) {
  std::string text;
  std::size_t count = 0;
  for (const auto& [name, body] : names) {
    if (count++ == 6) return text + " ...";
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

/// @returns the body of a name; nullptr for an obstacle
const Body* find(const std::string& place, const std::string& name, const SceneNames& names) {
  const auto found = names.find(name);
  if (found != names.end()) return found->second;
  fail_at(place, "there is no body or obstacle '" + name.substr(0, 100) + "', expected one of " +
                     listed(names));
}

/// A body with a state that forces change.
const Body& find_movable(const std::string& place,
                         const std::string& name,
                         const SceneNames& names) {
  const Body* const body = find(place, name, names);
  if (body == nullptr) fail_at(place, "'" + name + "' is an obstacle, expected a body");
  if (body->kind == BodyKind::scripted) {
    fail_at(place, "'" + name + "' is scripted: forces do not move it, expected another body");
  }
  return *body;
}

void check_obstacle(const std::string& place, const Obstacle& obstacle) {
  check_name(key_of(place, "name"), obstacle.name);
  const char* const names[] = {"plane", "sphere", "capsule", "mesh"};
  const std::string shape = key_of(place, names[obstacle.geometry.index()]);
  if (const auto* plane = std::get_if<PlaneObstacle>(&obstacle.geometry)) {
    check_direction(key_of(shape, "normal"), plane->normal);
    check_finite(key_of(shape, "point"), plane->point);
  } else if (const auto* sphere = std::get_if<SphereObstacle>(&obstacle.geometry)) {
    check_finite(key_of(shape, "centre"), sphere->center);
    check_positive(key_of(shape, "radius"), sphere->radius, "m");
  } else if (const auto* capsule = std::get_if<CapsuleObstacle>(&obstacle.geometry)) {
    check_finite(key_of(shape, "from"), capsule->from);
    check_finite(key_of(shape, "to"), capsule->to);
    check_positive(key_of(shape, "radius"), capsule->radius, "m");
  } else {
    check_surface(shape, std::get<Surface>(obstacle.geometry));
  }
  if (obstacle.contact) check_contact(key_of(place, "contact"), *obstacle.contact);
  check_path(key_of(place, "path"), obstacle.path, false);
}

SceneNames check_bodies(const Scene& scene) {
  SceneNames names;
  const auto add = [&](const std::string& place, const std::string& name, const Body* body) {
    if (names.emplace(name, body).second) return;
    fail_at(key_of(place, "name"), "'" + name + "' is already a body or obstacle; rename one");
  };
  if (scene.bodies.empty()) fail_at("bodies", "is empty, expected a body or more");
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    check_body(item_of("bodies", b), scene.bodies[b]);
    add(item_of("bodies", b), scene.bodies[b].name, &scene.bodies[b]);
  }
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    check_obstacle(item_of("obstacles", o), scene.obstacles[o]);
    add(item_of("obstacles", o), scene.obstacles[o].name, nullptr);
  }
  return names;
}

void check_coupling(const std::string& place, const Coupling& coupling, const SceneNames& names) {
  const Body* const a = find(key_of(place, "a"), coupling.a, names);
  const bool is_world = coupling.b == "world";
  const Body* const b = is_world ? nullptr : find(key_of(place, "b"), coupling.b, names);
  if (a == nullptr) fail_at(key_of(place, "a"), "is an obstacle, expected a body; swap a and b");
  if (coupling.a == coupling.b) fail_at(key_of(place, "b"), "equals a, expected another body");
  const bool is_moved =
      a->kind != BodyKind::scripted || (b != nullptr && b->kind != BodyKind::scripted);
  if (!is_moved) fail_at(place, "forces move neither a nor b; couple a body that is not scripted");
  if (coupling.points.empty()) {
    check_selection(key_of(place, "select_a"), coupling.select_a, *a);
  } else if (!coupling.select_a.empty()) {
    fail_at(place, "has select_a and points, expected one of them");
  }
  for (std::size_t p = 0; p < coupling.points.size(); ++p) {
    check_finite(item_of(key_of(place, "points"), p), coupling.points[p]);
  }
  if (coupling.within) check_not_negative(key_of(place, "within"), *coupling.within, "m");
  check_positive(key_of(place, "stiffness"), coupling.stiffness, "N/m in total");
  check_not_negative(key_of(place, "damping"), coupling.damping, "N s/m in total");
}

void check_handle(const std::string& place, const Handle& handle, const SceneNames& names) {
  const Body& body = find_movable(key_of(place, "handle"), handle.body, names);
  check_selection(key_of(place, "select"), handle.select, body);
  check_positive(key_of(place, "stiffness"), handle.stiffness, "N/m in total");
  check_not_negative(key_of(place, "damping"), handle.damping, "N s/m in total");
  check_path(key_of(place, "path"), handle.path, true);
  for (const PathPoint& point : handle.path) {
    if (point.axis_angle == Point3{0, 0, 0}) continue;
    fail_at(key_of(place, "path"), "turns, but anchors of handles only move; leave out the turns");
  }
}

void check_load(const std::string& place, const Load& load, const SceneNames& names) {
  const Body& body = find_movable(key_of(place, "load"), load.body, names);
  check_selection(key_of(place, "select"), load.select, body);
  if (load.force.has_value() == load.pressure.has_value()) {
    fail_at(place, "expected either force or pressure");
  }
  if (load.force) check_finite(key_of(place, "force"), *load.force);
  if (load.pressure) check_finite(key_of(place, "pressure"), *load.pressure);
  check_finite(key_of(place, "from"), load.from);
  if (!(load.to > load.from)) {
    fail_at(key_of(place, "to"), "is not after from (" + number_text(load.from) + " s)");
  }
}

/// Names of couplings, handles or cameras, where they are given, differ.
template <class Item>
void check_names(const std::string& list, const std::vector<Item>& items) {
  std::set<std::string> names;
  for (std::size_t n = 0; n < items.size(); ++n) {
    if (items[n].name.empty()) continue;
    const std::string place = key_of(item_of(list, n), "name");
    check_name(place, items[n].name);
    if (!names.insert(items[n].name).second) {
      fail_at(place, "'" + items[n].name + "' names two of the " + list + "; rename one");
    }
  }
}

void check_pairs(const SceneContact& contact, const SceneNames& names) {
  std::set<std::pair<std::string, std::string>> seen;
  for (std::size_t n = 0; n < contact.pairs.size(); ++n) {
    const ContactPairMaterial& pair = contact.pairs[n];
    const std::string place = item_of("contact.pairs", n);
    find(key_of(place, "a"), pair.a, names);
    find(key_of(place, "b"), pair.b, names);
    if (!seen.insert(std::minmax(pair.a, pair.b)).second) {
      fail_at(place, "'" + pair.a + "' and '" + pair.b + "' are a pair twice; keep one");
    }
    if (pair.friction) check_not_negative(key_of(place, "friction"), *pair.friction, "");
    if (pair.adhesion) check_adhesion(key_of(place, "adhesion"), *pair.adhesion);
  }
}

void check_solver(const SceneSolver& solver) {
  for (const auto& [key, tolerance] : {std::pair{"contact_tolerance", solver.contact_tolerance},
                                       std::pair{"linear_tolerance", solver.linear_tolerance}}) {
    if (!(tolerance > 0 && tolerance < 1)) {
      fail_at(key_of("solver", key),
              "is " + number_text(tolerance) + ", expected more than 0 and less than 1");
    }
  }
  check_range("solver.max_passes", solver.max_passes, 1, 1000);
  check_range("solver.max_substeps", solver.max_substeps, 1, 1024);
}

void check_output(const SceneOutput& output) {
  if (output.every && *output.every < 1) fail_at("output.every", "expected a number from 1");
  if (!output.every) check_positive("output.rate", output.rate, "frames per second");
  std::set<std::string> seen;
  for (std::size_t n = 0; n < output.fields.size(); ++n) {
    const std::string place = item_of("output.fields", n);
    const std::string& field = output.fields[n];
    if (field != "velocity" && field != "stress" && field != "jacobian" && field != "contact") {
      fail_at(place, "is no field, expected velocity, stress, jacobian or contact");
    }
    if (!seen.insert(field).second) fail_at(place, "is listed twice, remove one");
  }
}

void check_camera(const std::string& place, const Camera& camera) {
  check_finite(key_of(place, "eye"), camera.eye);
  check_finite(key_of(place, "target"), camera.target);
  check_finite(key_of(place, "up"), camera.up);
  const Point3 line = minus(camera.target, camera.eye);
  if (!(norm(line) > 0)) fail_at(key_of(place, "target"), "is the place of the eye");
  if (!(norm(cross(line, camera.up)) > 1e-9 * norm(line) * norm(camera.up))) {
    fail_at(key_of(place, "up"), "is along the line of sight, which leaves open what is upwards");
  }
  if (!(camera.angle > 0 && camera.angle < std::numbers::pi)) {
    fail_at(key_of(place, "angle"), "expected an angle of view above 0 and below pi");
  }
}

void check_cameras(const Scene& scene) {
  if (scene.camera) check_camera("camera", *scene.camera);
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    const std::string place = item_of("cameras", c);
    check_name(key_of(place, "name"), scene.cameras[c].name);
    check_camera(place, scene.cameras[c].camera);
  }
  check_names("cameras", scene.cameras);
}
}  // namespace

std::int64_t Scene::step_count() const {
  return std::llround(duration / time_step);
}

void check_scene(const Scene& scene) {
  check_positive("time_step", scene.time_step, "s");
  check_not_negative("duration", scene.duration, "s");
  if (!(scene.duration / scene.time_step <= most_steps)) {
    fail_at("duration", "is more than 1e9 steps; shorten it or raise time_step");
  }
  check_finite("gravity", scene.gravity);
  if (scene.thickness) check_positive("thickness", *scene.thickness, "m");
  check_contact("contact", scene.contact.material);
  const SceneNames names = check_bodies(scene);
  for (std::size_t c = 0; c < scene.couplings.size(); ++c) {
    check_coupling(item_of("couplings", c), scene.couplings[c], names);
  }
  check_names("couplings", scene.couplings);
  for (std::size_t h = 0; h < scene.handles.size(); ++h) {
    check_handle(item_of("handles", h), scene.handles[h], names);
  }
  check_names("handles", scene.handles);
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
    check_load(item_of("loads", l), scene.loads[l], names);
  }
  check_pairs(scene.contact, names);
  check_solver(scene.solver);
  check_output(scene.output);
  check_cameras(scene);
}

}  // namespace tetwarp
