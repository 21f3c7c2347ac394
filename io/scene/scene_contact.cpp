/// @file scene_contact.cpp
/// Friction and adhesion in scene files.

#include "io/scene/scene_contact.hpp"

namespace tetwarp {
namespace {
AdhesionMaterial read_adhesion(const SceneValue& value) {
  SceneObject object(value, "an object {...}, or null for none");
  AdhesionMaterial adhesion;
  adhesion.stiffness = object.get("stiffness", "a number above 0 (N/m^3)").number();
  adhesion.energy = object.get("energy", "a number from 0 (J/m^2)").number();
  object.read("tangential_stiffness", adhesion.tangential_stiffness);
  object.read("viscosity", adhesion.viscosity);
  object.read("bonding_rate", adhesion.bonding_rate);
  object.read("saturation_pressure", adhesion.saturation_pressure);
  object.read("initial_intensity", adhesion.initial_intensity);
  object.finish();
  return adhesion;
}

void read_adhesion_key(const SceneValue& value, std::optional<AdhesionMaterial>& into) {
  into.reset();
  if (!value.is_null()) into = read_adhesion(value);
}

ContactPairMaterial read_pair(const SceneValue& value) {
  SceneObject object(value);
  ContactPairMaterial pair;
  pair.a = object.get("a", "the name of a body or obstacle").text();
  pair.b = object.get("b", "the name of a body or obstacle").text();
  object.read("friction", pair.friction);
  object.read("collide", pair.collide);
  if (const auto adhesion = object.find("adhesion")) {
    pair.has_adhesion = true;
    read_adhesion_key(*adhesion, pair.adhesion);
  }
  object.finish();
  return pair;
}
}  // namespace

void read_contact_keys(SceneObject& object, SurfaceContact& into) {
  object.read("friction", into.friction);
  if (const auto adhesion = object.find("adhesion")) read_adhesion_key(*adhesion, into.adhesion);
}

void read_contact(SceneObject& object,
                  const SurfaceContact& scene,
                  std::optional<SurfaceContact>& into) {
  const auto value = object.find("contact");
  if (!value) return;
  SceneObject contact(*value);
  into = scene;
  read_contact_keys(contact, *into);
  contact.finish();
}

SceneContact read_scene_contact(const SceneValue& value) {
  SceneObject object(value);
  SceneContact contact;
  read_contact_keys(object, contact.material);
  if (const auto pairs = object.find("pairs")) {
    for (const SceneValue& pair : pairs->items()) contact.pairs.push_back(read_pair(pair));
  }
  object.finish();
  return contact;
}

}  // namespace tetwarp
