/// @file scene_loft.cpp
/// Lofts become surfaces of rigid and scripted bodies, tetrahedra and surfaces of elastic ones.
#include "io/scene/scene_loft.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <tetwarp/loft.hpp>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
LoftTube read_tube(SceneObject& object) {
  LoftTube tube;
  for (const SceneValue& item : object.get("stations", "a list of cross-sections").items()) {
    SceneObject keys(item);
    LoftStation station;
    station.center = keys.get("center", "[x, y, z] in m").point();
    station.radii = keys.get("radii", "two lengths [a, b] in m").array<2>();
    keys.read("direction", station.direction);
    keys.finish();
    tube.stations.push_back(station);
  }
  if (const auto ends = object.find("ends")) {
    tube.ends = ends->array<2>();
  } else if (!tube.stations.empty()) {
    const auto smaller = [](const LoftStation& of) { return std::min(of.radii[0], of.radii[1]); };
    tube.ends = {smaller(tube.stations.front()), smaller(tube.stations.back())};
  }
  try {
    static_cast<void>(loft_volume(tube));
  } catch (const std::invalid_argument& error) {
    object.fail(error.what());
  }
  return tube;
}

double volume_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    const std::vector<Point3>& x = mesh.rest_positions;
    sum += tet_volume(at(x, a), at(x, b), at(x, c), at(x, d));
  }
  return sum;
}

/// Tetrahedra around the one tube, of less density and stiffness as they have more volume.
void make_elastic(const std::vector<LoftTube>& tubes, Body& into) {
  if (tubes.size() > 1) {
    throw std::invalid_argument(
        "has several tubes, but a lattice follows one; couple bodies of a tube each");
  }
  Mesh mesh = make_loft_mesh(tubes[0], *into.lattice);
  const double share = loft_volume(tubes[0]) / volume_of(mesh);
  into.material.density *= share;
  into.material.youngs_modulus *= share;
  into.geometry = std::move(mesh);
  into.lattice.reset();
  if (const auto* count = std::get_if<std::int64_t>(&into.surface)) {
    into.surface = make_loft_surface(tubes, *count);
  }
}

void make_body(const std::vector<LoftTube>& tubes, Body& into) {
  if (into.lattice) {
    make_elastic(tubes, into);
  } else if (into.kind == BodyKind::fem) {
    throw std::invalid_argument("needs a lattice beside it, e.g. {\"cells\": [8, 2, 2]}");
  } else if (const auto* count = std::get_if<std::int64_t>(&into.surface)) {
    into.geometry = make_loft_surface(tubes, *count);
    into.surface = std::monostate{};
  } else {
    into.geometry = make_loft_surface(tubes);
  }
}
}  // namespace

void read_loft(const SceneValue& shape, SceneObject& object, SceneFiles& files, Body& into) {
  std::vector<LoftTube> tubes;
  if (const auto list = object.find("tubes")) {
    for (const SceneValue& item : list->items()) {
      SceneObject keys(item);
      tubes.push_back(read_tube(keys));
      keys.finish();
    }
    if (tubes.empty()) list->fail("is empty, expected a tube or more");
  } else {
    tubes.push_back(read_tube(object));
  }
  if (into.kind == BodyKind::cloth) shape.fail("is no cloth; expected a sheet or a mesh");
  files.add(shape, [tubes = std::move(tubes), &into] { make_body(tubes, into); });
}

}  // namespace tetwarp
