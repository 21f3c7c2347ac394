/// @file test_scene_bonds.cpp
/// What the bonds of the scene `mouth` take from the lips that they hold together: a whole run.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tetwarp/simulate.hpp>
#include <utility>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "tests/scene/scene_texts.hpp"

namespace tetwarp::test {
namespace {

/// Displacement of a place on a surface.
Point3 way_of(const ContactPlace& place,
              const std::vector<Point3>& before,
              const std::vector<Point3>& now) {
  Point3 way{0, 0, 0};
  for (std::size_t k = 0; k < 3 && place.point[k] >= 0; ++k) {
    const std::size_t p = index_of(place.point[k]);
    way = plus(way, times(place.weight[k], minus(now[p], before[p])));
  }
  return way;
}

using Vertex = std::pair<std::size_t, std::int32_t>;  ///< body and point of its surface

/// @returns point -1: the place is no vertex
Vertex vertex_of(std::size_t body, const ContactPlace& place) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (place.weight[k] == 1) return {body, place.point[k]};
  }
  return {body, -1};
}

/// The contacts with areas by their vertex. Where two vertices meet, both may have a contact.
std::map<Vertex, ContactPoint> by_vertex(const std::vector<ContactPoint>& contacts) {
  std::map<Vertex, ContactPoint> found;
  for (const bool of_two : {false, true}) {
    for (const ContactPoint& contact : contacts) {
      const Vertex a = vertex_of(contact.body_a, contact.place_a);
      const Vertex b = vertex_of(contact.body_b, contact.place_b);
      if (contact.area == 0 || of_two != (a.second >= 0 && b.second >= 0)) continue;
      found[a.second >= 0 && !found.contains(a) ? a : b] = contact;
    }
  }
  return found;
}

/// Sums while the jaw opens.
struct Parting {
  double taken = 0;    ///< energy that contacts take from the lips [J]
  double viscous = 0;  ///< of it by the viscosity of bonds [J]
  double stored = 0;   ///< of it in bonds that hold on at the end [J]
  double area = 0;     ///< that loses its bond [m^2]
};

Parting part(const Scene& scene) {
  const AdhesionMaterial adhesion = *scene.contact.material.adhesion;
  Simulator simulator(scene);
  Parting parting;
  std::map<Vertex, ContactPoint> before;
  double start = 0;
  while (simulator.step_index() < scene.step_count()) {
    const std::vector<std::vector<Point3>> from{simulator.surface_positions(0),
                                                simulator.surface_positions(1)};
    simulator.step();
    const std::vector<std::vector<Point3>> to{simulator.surface_positions(0),
                                              simulator.surface_positions(1)};
    const StepRecord& record = simulator.record();
    EXPECT_EQ(record.substeps, 1) << record.time;  // else impulses are those of a part
    const std::vector<ContactPoint> contacts = simulator.contacts();
    const std::map<Vertex, ContactPoint> now = by_vertex(contacts);
    const double springs = record.energy.adhesion + adhesion.energy * record.adhered_area;
    if (record.time < 0.5 + scene.time_step / 2) {
      start = springs;
      before = now;
      continue;
    }
    parting.stored = springs - start;
    for (const ContactPoint& contact : contacts) {
      const Point3 way = minus(way_of(contact.place_a, from[contact.body_a], to[contact.body_a]),
                               way_of(contact.place_b, from[contact.body_b], to[contact.body_b]));
      parting.taken -= dot(contact.impulse, way) / scene.time_step;
    }
    for (const auto& [vertex, old] : before) {
      const auto found = now.find(vertex);
      const double loss = old.intensity - (found == now.end() ? 0 : found->second.intensity);
      if (loss <= 0) continue;
      parting.area += loss * old.area;
      parting.viscous += adhesion.viscosity * loss * loss * old.area / scene.time_step;
    }
    before = now;
  }
  return parting;
}

/// Without friction, whose work would be among that of contacts, and with bonds and steps that lose
/// little by their viscosity and by what backward Euler takes from a spring that lengthens.
TEST(SceneBonds, MouthLosesTheirEnergyTimesTheAreaAsItOpens) {
  Scene scene = shipped("mouth");
  scene.time_step /= 2;
  scene.contact.material.friction = 0;
  scene.contact.material.adhesion->viscosity /= 10;
  const Parting parting = part(scene);
  const double energy = scene.contact.material.adhesion->energy * parting.area;
  EXPECT_GT(parting.area, 5e-5);
  EXPECT_LT(parting.viscous, 0.05 * energy);
  EXPECT_LT(parting.stored, 0.1 * energy);
  EXPECT_NEAR((parting.taken - parting.viscous - parting.stored) / energy, 1, 0.05);
}

}  // namespace
}  // namespace tetwarp::test
