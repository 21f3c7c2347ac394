/// @file scene_parts.hpp
/// Parts of a scene for simulations: poses, geometry, materials, motions, selections, contact.
/// Plain data in SI units; angles in radians, world axes. See scene.hpp.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Where a body stands: x_world = position + R x, R of a unit quaternion.
struct Pose {
  Point3 position{0, 0, 0};
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< quaternion w, x, y, z
};

/// A triangle mesh.
struct Surface {
  std::vector<Point3> points = {};
  std::vector<std::array<std::int32_t, 3>> triangles = {};  ///< counter-clockwise from outside
};

// ---- geometry -----------------------------------------------------------------
// Shapes are centered on the body's origin.
struct BoxShape {
  Point3 half{1, 1, 1};  ///< half edges [m]
};
struct EllipsoidShape {
  Point3 radii{1, 1, 1};  ///< all equal: a sphere [m]
};
struct CapsuleShape {
  double radius = 1;
  double length = 1;  ///< of the straight part, along z [m]
};
struct CylinderShape {
  double radius = 1;
  double length = 1;  ///< along z [m]
};
struct TorusShape {
  double radius = 1;  ///< of the center line, around z [m]
  double tube = 0.1;  ///< radius of the tube [m]
};
/// A part of a torus with hemispheres at its ends.
struct ArcShape {
  double radius = 1;
  double tube = 0.1;
  std::array<double, 2> angles{0, 1};  ///< first < second [rad], from x towards y
};
/// A box of width (x), depth (y) and height (z) whose points are raised by sag (1 - (2x/width)^2).
struct BentStripShape {
  double width = 1, height = 0.1, depth = 0.1, sag = 0.1;
};
struct PlateShape {
  Point3 size{1, 1, 0.1};  ///< edges [m]
};
using Shape = std::variant<BoxShape,
                           EllipsoidShape,
                           CapsuleShape,
                           CylinderShape,
                           TorusShape,
                           ArcShape,
                           BentStripShape,
                           PlateShape>;

/// An image of the body: samples >= threshold are foreground.
struct ImageGeometry {
  Volume volume = {};
  double threshold = 0;
};
/// A rectangular cloth of cells[0] x cells[1] squares; its points are origin + u axes[0] + v
/// axes[1], 0 <= u <= size[0], 0 <= v <= size[1].
struct Sheet {
  std::array<double, 2> size{1, 1};           ///< [m]
  std::array<std::int64_t, 2> cells{10, 10};  ///< >= 1
  Point3 origin{0, 0, 0};
  std::array<Point3, 2> axes{{{1, 0, 0}, {0, 1, 0}}};  ///< unit vectors at right angles
};
/// monostate: none, which only scripted bodies may have. Mesh: tetrahedra.
using Geometry = std::variant<std::monostate, Shape, ImageGeometry, Mesh, Surface, Sheet>;

/// The lattice of tetrahedra, five per cell, of a body made of a shape or an image. Exactly one of
/// the members is given.
struct Lattice {
  std::optional<std::array<std::int64_t, 3>> cells =
      {};                                 ///< boxes along x, y, z (an image's i, j, k)
  std::optional<double> edge = {};        ///< length of cubes [m]
  std::optional<std::int64_t> tets = {};  ///< number of tetrahedra kept, about

  bool operator==(const Lattice&) const = default;
};
/// The triangles of a body: monostate is the boundary of the tetrahedra for shapes and meshes, an
/// isosurface at the threshold for images; a number is about how many triangles.
using SurfaceChoice = std::variant<std::monostate, std::int64_t, Surface>;

// ---- materials ----------------------------------------------------------------
struct Material {
  double youngs_modulus = 1e5;  ///< E [Pa], > 0
  double poissons_ratio = 0.3;  ///< nu, in (-1, 0.5)
  double density = 1000;        ///< [kg/m^3], > 0

  bool operator==(const Material&) const = default;
};
/// One entry of a transfer table: the material of an image's value.
struct TransferPoint {
  double value = 0;
  Material material = {};  ///< E and density may be 0: void

  bool operator==(const TransferPoint&) const = default;
};
enum class TransferLookup {
  linear,  ///< piecewise linear between the entries, constant beyond them
  label    ///< exact matches only; other values are void
};
enum class MaterialMean { arithmetic, harmonic };
enum class MassKind { consistent, lumped };

/// Rayleigh damping alpha M + gamma K.
struct Damping {
  double alpha = 0;     ///< [1/s], damps rigid motion as well
  double gamma = 2e-3;  ///< [s]
};
struct Cloth {
  double areal_density = 0.3;  ///< [kg/m^2], > 0
  double stretch = 400;        ///< E h [N/m], >= 0
  double shear = 80;           ///< [N/m], >= 0
  double bend = 2e-4;          ///< B [N m], >= 0
};
/// Of a rigid body. Without `mass` the density fills the closed surface.
struct RigidMass {
  double density = 1000;                              ///< [kg/m^3], > 0
  std::optional<double> mass = {};                    ///< [kg], > 0; needs `inertia`
  std::optional<std::array<double, 6>> inertia = {};  ///< xx yy zz xy yz xz about the center of
                                                      ///< mass, body axes [kg m^2]
};

// ---- motion -------------------------------------------------------------------
struct PathPoint {
  double time = 0;                          ///< [s], ascending
  std::optional<Point3> displacement = {};  ///< [m]; nothing: the spring of a handle lets go
  Point3 axis_angle{0, 0, 0};               ///< turn about the body's origin [rad]
};
using Path = std::vector<PathPoint>;  ///< linear between the points, held before and after
struct Hinge {
  Point3 point{0, 0, 0};
  Point3 axis{0, 0, 1};
  std::vector<std::array<double, 2>> angle = {};  ///< time [s], angle [rad]
};
/// Lateral displacement L (a0 + a1 s + a2 s^2) sin 2 pi (s / wavelength - frac(frequency t) +
/// phase) where L is the extent along `axis` and s, from 0 to 1, the place along it.
struct Wave {
  int axis = 2, lateral = 0;
  double frequency = 1;   ///< [1/s]
  double wavelength = 1;  ///< in L
  double phase = 0;       ///< in turns
  std::array<double, 3> envelope{0, 0, 0};
};
using Motion = std::variant<std::monostate, Path, Hinge, Wave>;

// ---- selections: material points by where they are at the start [world] ----------
struct BoxSelection {
  Point3 low{}, high{};
};
struct SphereSelection {
  Point3 center{};
  double radius = 0;
};
struct HalfSpaceSelection {
  Point3 normal{};
  double offset = 0;  ///< selects n . x >= offset
};
struct LabelSelection {
  double value = 0;  ///< nodes of tetrahedra that own voxels of this value
};
struct NodeSelection {
  std::vector<std::int64_t> nodes = {};
};
struct AllSelection {};
using SelectionPart = std::variant<BoxSelection,
                                   SphereSelection,
                                   HalfSpaceSelection,
                                   LabelSelection,
                                   NodeSelection,
                                   AllSelection>;
using Selection = std::vector<SelectionPart>;  ///< the union; empty selects nothing

struct DrivenNodes {
  Selection select = {};
  Path path = {};
};

// ---- contact ------------------------------------------------------------------
/// Names as in AdhesionState.
struct AdhesionMaterial {
  double stiffness = 0;                             ///< [N/m^3]
  std::optional<double> tangential_stiffness = {};  ///< [N/m^3]; without: `stiffness`
  double energy = 0;                                ///< [J/m^2]
  double viscosity = 0;                             ///< [J s/m^2]
  double bonding_rate = 0;                          ///< [1/(Pa s)]
  double saturation_pressure = 0;                   ///< [Pa]
  double initial_intensity = 0;                     ///< 0 to 1
};
/// Contact material of one surface. The constants of a pair of surfaces follow from both.
struct SurfaceContact {
  double friction = 0;
  std::optional<AdhesionMaterial> adhesion = {};
};
struct ContactPairMaterial {
  std::string a = {}, b = {};
  std::optional<double> friction = {};
  bool has_adhesion = false;  ///< whether the next member replaces that of the bodies
  std::optional<AdhesionMaterial> adhesion = {};
  bool collide = true;
};
struct SceneContact {
  SurfaceContact material = {};  ///< of bodies and obstacles without their own
  std::vector<ContactPairMaterial> pairs = {};
};

}  // namespace tetwarp
