/// @file scene_body.cpp
/// Bodies of scene files: common keys, then those of the kind.
#include "io/scene/scene_body.hpp"

#include <array>

#include "io/scene/scene_contact.hpp"
#include "io/scene/scene_files.hpp"
#include "io/scene/scene_geometry.hpp"
#include "io/scene/scene_motion.hpp"

namespace tetwarp {
namespace {
/// Keys that only some kinds of bodies have.
constexpr std::array kind_keys{"lattice", "material", "transfer",      "lookup",  "mean",
                               "damping", "mass",     "surface",       "density", "inertia",
                               "stretch", "shear",    "areal_density", "bend",    "path",
                               "hinge",   "wave",     "fixed",         "driven",  "cage_start"};

Material read_material(SceneObject& object) {
  Material material;
  material.youngs_modulus = object.get("E", "Young's modulus in Pa").number();
  material.poissons_ratio = object.get("nu", "Poisson's ratio below 0.5, e.g. 0.4").number();
  material.density = object.get("density", "a number in kg/m^3").number();
  return material;
}

void read_damping(SceneObject& object, Damping& into) {
  const auto value = object.find("damping");
  if (!value) return;
  SceneObject keys(*value);
  keys.read("alpha", into.alpha);
  keys.read("gamma", into.gamma);
  keys.finish();
}

void read_elastic(SceneObject& object, Body& into) {
  const auto material = object.find("material");
  const auto transfer = object.find("transfer");
  if (material.has_value() == transfer.has_value()) {
    object.fail(
        "expected either material {\"E\", \"nu\", \"density\"} or, with a volume, transfer");
  }
  const auto lookup = object.find("lookup");
  const auto mean = object.find("mean");
  if (material) {
    SceneObject keys(*material);
    into.material = read_material(keys);
    keys.finish();
    if (lookup) lookup->fail("is only for a transfer table, remove it");
    if (mean) mean->fail("is only for a transfer table, remove it");
    return;
  }
  for (const SceneValue& entry : transfer->items()) {
    SceneObject keys(entry);
    const double value = keys.get("value", "a value of the volume").number();
    into.transfer.push_back({value, read_material(keys)});
    keys.finish();
  }
  if (into.transfer.empty()) transfer->fail("is empty, expected an entry or more");
  if (lookup) into.lookup = lookup->word<TransferLookup>();
  if (mean) into.mean = mean->word<MaterialMean>();
}

void read_held_nodes(SceneObject& object, Body& into) {
  if (const auto fixed = object.find("fixed")) into.fixed = read_selection(*fixed);
  if (const auto driven = object.find("driven")) {
    for (const SceneValue& item : driven->items()) {
      SceneObject keys(item);
      const SceneValue select = keys.get("select", "a selection, e.g. \"all\"");
      const SceneValue path = keys.get("path", "[[t, x, y, z], ...]");
      into.driven.push_back({read_selection(select), read_path(path)});
      keys.finish();
    }
  }
}

void read_fem(SceneObject& object, SceneFiles& files, Body& into) {
  read_lattice(object, into);
  read_surface_choice(object, files, into);
  read_elastic(object, into);
  read_damping(object, into.damping);
  object.read("mass", into.mass);
  object.read("cage_start", into.cage_start);
  read_held_nodes(object, into);
}

void read_rigid(SceneObject& object, SceneFiles& files, Body& into) {
  read_surface_choice(object, files, into);
  read_damping(object, into.damping);
  const auto density = object.find("density");
  const auto inertia = object.find("inertia");
  object.read("mass", into.rigid.mass);
  if (inertia) into.rigid.inertia = inertia->array<6>();
  if (density) into.rigid.density = density->number();
  if (density.has_value() == (into.rigid.mass || into.rigid.inertia)) {
    object.fail("expected either density, or mass and inertia");
  }
}

void read_cloth(SceneObject& object, Body& into) {
  Cloth& cloth = into.cloth;
  cloth.areal_density = object.get("areal_density", "a number above 0 (kg/m^2)").number();
  cloth.stretch = object.get("stretch", "a number from 0 (N/m)").number();
  cloth.shear = cloth.bend = 0;
  object.read("shear", cloth.shear);
  object.read("bend", cloth.bend);
  read_damping(object, into.damping);
  read_held_nodes(object, into);
}
}  // namespace

void read_body(const SceneValue& value,
               const SurfaceContact& contact,
               SceneFiles& files,
               Body& into) {
  SceneObject object(value);
  into.name = object.get("name", "a name of letters, digits, '_' and '-'").text();
  into.kind = object.get("kind", "fem, rigid, cloth or scripted").word<BodyKind>();
  read_geometry(object, files, into);
  read_pose(object, into.pose);
  object.read("velocity", into.velocity);
  object.read("angular_velocity", into.angular_velocity);
  object.read("collide", into.collide);
  if (const auto self = object.find("self")) into.self = self->boolean();
  read_contact(object, contact, into.contact);
  switch (into.kind) {
    case BodyKind::fem:
      read_fem(object, files, into);
      break;
    case BodyKind::rigid:
      read_rigid(object, files, into);
      break;
    case BodyKind::cloth:
      read_cloth(object, into);
      break;
    case BodyKind::scripted:
      read_lattice(object, into);
      read_surface_choice(object, files, into);
      read_motion(object, into.motion);
  }
  for (const char* const key : kind_keys) {
    if (const auto unread = object.unread(key)) {
      unread->fail(std::string("is not for ") + name_of(into.kind) +
                   " bodies, remove it or change the kind");
    }
  }
  object.finish();
}

}  // namespace tetwarp
