/// @file check_body.cpp
/// Checks of a body: what its kind may have, its material, motion and selections.
#include "host/scene/checks/check_body.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <tetwarp/names.hpp>
#include <variant>

#include "host/scene/checks/check_geometry.hpp"
#include "host/scene/checks/check_motion.hpp"
#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
template <class One>
bool is(const Body& body) {
  return std::holds_alternative<One>(body.geometry);
}

/// Kinds of bodies have some kinds of geometry each.
void check_geometry_kind(const std::string& place, const Body& body) {
  const bool is_solid = is<Shape>(body) || is<ImageGeometry>(body);
  switch (body.kind) {
    case BodyKind::fem:
      if (is_solid || is<Mesh>(body) || is<Surface>(body)) return;
      fail_at(place, "a fem body needs a shape, a volume or a mesh");
    case BodyKind::rigid:
      if (is_solid || is<Surface>(body)) return;
      fail_at(place, "a rigid body needs a shape, a volume or a mesh of triangles");
    case BodyKind::cloth:
      if (is<Sheet>(body) || is<Surface>(body)) return;
      fail_at(place, "a cloth body needs a sheet or a mesh of triangles");
    case BodyKind::scripted:
      return;
  }
}

/// Members that only some kinds have.
void check_members(const std::string& place, const Body& body) {
  const bool is_scripted = body.kind == BodyKind::scripted;
  const bool has_nodes = body.kind == BodyKind::fem || body.kind == BodyKind::cloth;
  const auto refuse = [&](bool is_there, const char* key) {
    if (!is_there) return;
    fail_at(key_of(place, key), std::string("is not for ") + name_of(body.kind) +
                                    " bodies, remove it or change the kind");
  };
  refuse(body.lattice && !is_scripted && body.kind != BodyKind::fem, "lattice");
  refuse(!body.transfer.empty() && body.kind != BodyKind::fem, "transfer");
  refuse(!body.fixed.empty() && !has_nodes, "fixed");
  refuse(!body.driven.empty() && !has_nodes, "driven");
  refuse(body.cage_start && body.kind != BodyKind::fem, "cage_start");
  refuse(body.self.value_or(false) && !has_nodes, "self");
  refuse(!std::holds_alternative<std::monostate>(body.surface) && body.kind == BodyKind::cloth,
         "surface");
  if (!is_scripted) {
    const char* const names[] = {"", "path", "hinge", "wave"};
    refuse(body.motion.index() != 0, names[body.motion.index()]);
  } else {
    refuse(body.velocity != Point3{0, 0, 0}, "velocity");
    refuse(body.angular_velocity != Point3{0, 0, 0}, "angular_velocity");
  }
}

void check_material(const std::string& place, const Material& material, bool may_be_void) {
  const auto check = may_be_void ? check_not_negative : check_positive;
  check(key_of(place, "E"), material.youngs_modulus, "Pa");
  check(key_of(place, "density"), material.density, "kg/m^3");
  if (!(material.poissons_ratio > -1 && material.poissons_ratio < 0.5)) {
    fail_at(key_of(place, "nu"), "is " + number_text(material.poissons_ratio) +
                                     ", expected more than -1 and less than 0.5, e.g. 0.4");
  }
}

void check_transfer(const std::string& place, const Body& body) {
  if (!is<ImageGeometry>(body)) fail_at(place, "needs a volume; give a material instead");
  bool has_matter = false;
  for (std::size_t n = 0; n < body.transfer.size(); ++n) {
    const TransferPoint& point = body.transfer[n];
    const std::string item = item_of(place, n);
    check_finite(key_of(item, "value"), point.value);
    check_material(item, point.material, true);
    if (n > 0 && !(point.value > body.transfer[n - 1].value)) {
      fail_at(key_of(item, "value"), "is not above the one before, sort the table by value");
    }
    has_matter = has_matter || (point.material.youngs_modulus > 0 && point.material.density > 0);
  }
  if (!has_matter) fail_at(place, "no entry has E and density above 0; give one");
}

/// Principal moments of a body of positive mass are positive, none above the sum of the others.
void check_inertia(const std::string& place, const std::array<double, 6>& i) {
  for (const double component : i) check_finite(place, component);
  Eigen::Matrix3d inertia;
  inertia << i[0], i[3], i[5], i[3], i[1], i[4], i[5], i[4], i[2];
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(moments[0] > 0) || !std::isfinite(moments[2])) {
    fail_at(place, "is not positive definite, expected [xx, yy, zz, xy, yz, xz]");
  }
  if (moments[2] > (moments[0] + moments[1]) * (1 + 1e-9)) {
    fail_at(place,
            "its largest principal moment exceeds the sum of the other two, which no body "
            "has; expected [xx, yy, zz, xy, yz, xz]");
  }
}

void check_rigid(const std::string& place, const RigidMass& rigid) {
  if (!rigid.mass && !rigid.inertia) {
    check_positive(key_of(place, "density"), rigid.density, "kg/m^3");
    return;
  }
  if (!rigid.inertia) fail_at(key_of(place, "inertia"), "is missing beside mass; give both");
  if (!rigid.mass) fail_at(key_of(place, "mass"), "is missing beside inertia; give both");
  check_positive(key_of(place, "mass"), *rigid.mass, "kg");
  check_inertia(key_of(place, "inertia"), *rigid.inertia);
}

void check_cloth(const std::string& place, const Cloth& cloth) {
  check_positive(key_of(place, "areal_density"), cloth.areal_density, "kg/m^2");
  check_not_negative(key_of(place, "stretch"), cloth.stretch, "N/m");
  check_not_negative(key_of(place, "shear"), cloth.shear, "N/m");
  check_not_negative(key_of(place, "bend"), cloth.bend, "N m");
}

void check_matter(const std::string& place, const Body& body) {
  if (body.kind == BodyKind::rigid) check_rigid(place, body.rigid);
  if (body.kind == BodyKind::cloth) check_cloth(place, body.cloth);
  if (body.kind == BodyKind::fem) {
    if (!body.transfer.empty()) {
      check_transfer(key_of(place, "transfer"), body);
    } else {
      check_material(key_of(place, "material"), body.material, false);
    }
    if (!is<Mesh>(body) && !body.lattice) {
      fail_at(key_of(place, "lattice"),
              "is missing; give {\"cells\": [i, j, k]}, {\"edge\": m} or {\"tets\": about}");
    }
  }
  check_not_negative(key_of(place, "damping.alpha"), body.damping.alpha, "1/s");
  check_not_negative(key_of(place, "damping.gamma"), body.damping.gamma, "s");
}
}  // namespace

void check_adhesion(const std::string& place, const AdhesionMaterial& adhesion) {
  check_positive(key_of(place, "stiffness"), adhesion.stiffness, "N/m^3");
  if (adhesion.tangential_stiffness) {
    check_not_negative(key_of(place, "tangential_stiffness"), *adhesion.tangential_stiffness,
                       "N/m^3");
  }
  check_not_negative(key_of(place, "energy"), adhesion.energy, "J/m^2");
  check_not_negative(key_of(place, "viscosity"), adhesion.viscosity, "J s/m^2");
  check_not_negative(key_of(place, "bonding_rate"), adhesion.bonding_rate, "1/(Pa s)");
  check_not_negative(key_of(place, "saturation_pressure"), adhesion.saturation_pressure, "Pa");
  check_range(key_of(place, "initial_intensity"), adhesion.initial_intensity, 0, 1);
}

void check_contact(const std::string& place, const SurfaceContact& contact) {
  check_not_negative(key_of(place, "friction"), contact.friction, "");
  if (contact.adhesion) check_adhesion(key_of(place, "adhesion"), *contact.adhesion);
}

void check_body(const std::string& place, const Body& body) {
  check_name(key_of(place, "name"), body.name);
  check_geometry_kind(place, body);
  check_members(place, body);
  check_geometry(place, body);
  check_finite(key_of(place, "pose.position"), body.pose.position);
  check_unit_quaternion(key_of(place, "pose.quaternion"), body.pose.rotation);
  check_finite(key_of(place, "velocity"), body.velocity);
  check_finite(key_of(place, "angular_velocity"), body.angular_velocity);
  check_matter(place, body);
  if (body.contact) check_contact(key_of(place, "contact"), *body.contact);
  check_motion(place, body.motion);
  if (std::holds_alternative<Wave>(body.motion) && is<std::monostate>(body)) {
    fail_at(key_of(place, "wave"), "needs a geometry to bend; give one or a path");
  }
  if (!body.fixed.empty()) check_selection(key_of(place, "fixed"), body.fixed, body);
  for (std::size_t n = 0; n < body.driven.size(); ++n) {
    const std::string item = item_of(key_of(place, "driven"), n);
    check_selection(key_of(item, "select"), body.driven[n].select, body);
    if (body.driven[n].path.empty()) {
      fail_at(key_of(item, "path"), "is missing or empty, expected [[t, x, y, z], ...]");
    }
    check_path(key_of(item, "path"), body.driven[n].path, false);
  }
}

}  // namespace tetwarp
