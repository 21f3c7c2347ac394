/// @file pair_materials.cpp
/// Joins the materials of both sides, and numbers different ones.
#include "host/simulate/surfaces/pair_materials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

/// Adhesion as numbers, the energy first: of two sides the smaller array is the one with the lower
/// energy, in either order of the sides.
using AdhesionNumbers = std::array<double, 7>;
using Adhesion = std::optional<AdhesionNumbers>;
struct Side {
  double friction = 0;
  Adhesion adhesion = {};
  auto operator<=>(const Side&) const = default;
};

Adhesion numbers_of(const std::optional<AdhesionMaterial>& material) {
  if (!material) return std::nullopt;
  return AdhesionNumbers{material->energy,
                         material->stiffness,
                         material->tangential_stiffness.value_or(material->stiffness),
                         material->viscosity,
                         material->bonding_rate,
                         material->saturation_pressure,
                         material->initial_intensity};
}

Side side_of(const SurfaceContact& contact) {
  return {contact.friction, numbers_of(contact.adhesion)};
}

/// Friction and adhesion of a pair of two sides.
Side joined(const Side& a, const Side& b) {
  Side pair{std::sqrt(a.friction) * std::sqrt(b.friction), std::nullopt};
  if (a.friction == b.friction) pair.friction = a.friction;
  if (a.adhesion && b.adhesion) pair.adhesion = std::min(*a.adhesion, *b.adhesion);
  return pair;
}

ContactMaterial material_from(const Side& pair) {
  ContactMaterial material;
  material.friction = pair.friction;
  if (!pair.adhesion) return material;
  const auto [energy, stiffness, tangential, viscosity, rate, pressure, intensity] = *pair.adhesion;
  material.energy = energy;
  material.stiffness = stiffness;
  material.tangential_stiffness = tangential;
  material.viscosity = viscosity;
  material.bonding_rate = rate;
  material.saturation_pressure = pressure;
  material.initial_intensity = intensity;
  return material;
}

/// Numbers equal items in the order of their first appearance.
class Numbers {
 public:
  std::int32_t of(const Side& side) {
    const auto [entry, is_new] = numbers_.emplace(side, static_cast<std::int32_t>(numbers_.size()));
    if (is_new) items_.push_back(side);
    return entry->second;
  }
  const std::vector<Side>& items() const { return items_; }

 private:
  std::map<Side, std::int32_t> numbers_;
  std::vector<Side> items_;
};

}  // namespace

void add_pair_materials(const Scene& scene, SceneSurfaces& surfaces) {
  Numbers classes, materials;
  std::map<std::string, std::int32_t> index;
  const auto add_body = [&](const std::string& name, const std::optional<SurfaceContact>& contact) {
    index.emplace(name, static_cast<std::int32_t>(index.size()));
    surfaces.contact_class.push_back(classes.of(side_of(contact.value_or(scene.contact.material))));
  };
  for (const Body& body : scene.bodies) add_body(body.name, body.contact);
  for (const Obstacle& obstacle : scene.obstacles) add_body(obstacle.name, obstacle.contact);

  surfaces.class_count = static_cast<std::int32_t>(classes.items().size());
  for (const Side& a : classes.items()) {
    for (const Side& b : classes.items()) {
      surfaces.class_material.push_back(materials.of(joined(a, b)));
    }
  }
  for (const ContactPairMaterial& entry : scene.contact.pairs) {
    if (!entry.friction && !entry.has_adhesion) continue;
    const auto [a, b] = std::minmax(index.at(entry.a), index.at(entry.b));
    const auto class_of = [&](std::int32_t body) {
      return at(classes.items(), at(surfaces.contact_class, body));
    };
    Side pair = joined(class_of(a), class_of(b));
    if (entry.friction) pair.friction = *entry.friction;
    if (entry.has_adhesion) pair.adhesion = numbers_of(entry.adhesion);
    surfaces.pair_materials.push_back({{a, b}, materials.of(pair)});
  }
  std::sort(surfaces.pair_materials.begin(), surfaces.pair_materials.end(),
            [](const PairMaterial& a, const PairMaterial& b) { return a.bodies < b.bodies; });
  for (const Side& pair : materials.items()) surfaces.materials.push_back(material_from(pair));
}

bool adheres(const ContactMaterial& material) {
  return material.stiffness > 0 || material.tangential_stiffness.value_or(0) > 0;
}

std::int32_t SceneSurfaces::material_of(std::int32_t a, std::int32_t b) const {
  const std::array<std::int32_t, 2> bodies{std::min(a, b), std::max(a, b)};
  const auto found = std::lower_bound(
      pair_materials.begin(), pair_materials.end(), bodies,
      [](const PairMaterial& entry, const auto& wanted) { return entry.bodies < wanted; });
  if (found != pair_materials.end() && found->bodies == bodies) return found->material;
  return class_material[static_cast<std::size_t>(at(contact_class, a)) *
                            static_cast<std::size_t>(class_count) +
                        static_cast<std::size_t>(at(contact_class, b))];
}

}  // namespace tetwarp
