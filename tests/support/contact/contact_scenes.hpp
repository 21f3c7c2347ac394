/// @file contact_scenes.hpp
/// Seeded contact problems for tests, stress and benchmarks. Units: m, kg, s.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp::scenes {

/// Adhesion of all contacts of a scene; stiffness 0: none.
struct Glue {
  double stiffness = 0;  ///< C [N/m^3]
  double intensity = 1;  ///< beta
};

/// A number of a sparse matrix.
struct Entry {
  std::int64_t row;
  std::int64_t column;
  double value;
};

/// The matrix of such numbers; repeated ones add up.
SparseMatrix sparse_matrix(std::int64_t rows, std::int64_t columns, std::vector<Entry> entries);

/// Gives every contact an area and adhesion; normal gaps follow the offsets, tangential ones are
/// seeded, within 0.1 mm.
void add_glue(
    ContactProblem& problem, const Glue& glue, double time_step, double area, std::uint32_t seed);

/// A Delassus matrix that belongs to no bodies.
struct RandomLocal {
  std::uint32_t seed = 1;
  std::int64_t contacts = 20;
  std::int64_t neighbors = 4;  ///< couplings per contact, about
  double friction = 0.5;
  double asymmetry = 0;  ///< relative, as recorded files have it
  Glue glue = {};
};
ContactProblem random_local(const RandomLocal& choice);

/// Equal boxes, four contacts between any two and under the lowest, pushed sideways.
struct BoxStack {
  std::int64_t boxes = 10;
  double mass_ratio = 1;  ///< highest box over lowest
  double friction = 0.5;
  double time_step = 0.01;
  Glue glue = {};
};
ContactProblem box_stack(const BoxStack& choice);

/// Spheres on a jittered lattice, as wide as high, pressed down; each in contact with its neighbors
/// and with the floor.
struct SpherePacking {
  std::uint32_t seed = 1;
  std::int64_t edge = 6;  ///< spheres along each edge of the lattice
  double friction = 0.3;
  double kept = 1;  ///< share of the possible contacts
  double gaps = 1;  ///< factor of the gaps between surfaces; 0: all touch
  double time_step = 0.01;
  Glue glue = {};
};
ContactProblem sphere_packing(const SpherePacking& choice);

/// Light and heavy bodies jammed by contacts anywhere between them and the world, many more than
/// degrees of freedom: the impulses are not unique.
struct Jam {
  std::uint32_t seed = 1;
  std::int64_t bodies = 8;
  std::int64_t contacts = 48;
  double mass_ratio = 1e6;  ///< heaviest body over lightest, at most
  double friction = 1;
  Glue glue = {};
};
ContactProblem jam(const Jam& choice);

/// A linear elastic slab of five tetrahedra per cube, lifted at one end from the plane it sticks
/// to.
struct ElasticSlab {
  std::uint32_t seed = 1;
  std::int64_t cubes[3] = {25, 20, 4};  ///< 10,000 tetrahedra
  std::int64_t contacts = 151;          ///< of the nodes of the lower face
  double edge = 0.01;
  double young = 1e5;  ///< Pa
  double poisson = 0.4;
  double density = 1000;
  double friction = 0.3;
  double time_step = 0.008;
  Glue glue = {4e7, 1};
};
ContactProblem elastic_slab(const ElasticSlab& choice);

/// A square layer of touching spheres on a tray, which rests on the floor at its corners: one body
/// in contact with all spheres.
struct Tray {
  std::int64_t edge = 16;  ///< spheres along each edge of the layer
  double friction = 0.3;
  double time_step = 0.01;
};
ContactProblem tray(const Tray& choice);

/// Touching spheres on a cubic lattice in a box without a lid, as wide as high. Every sphere
/// touches its six neighbors, the floor or the walls, with normals that are turned a little:
/// contacts that hold each other in every direction, whose impulses are not unique.
struct BoxedLattice {
  std::uint32_t seed = 1;
  std::int64_t edge = 8;  ///< spheres along each edge of the lattice
  double friction = 0.3;
  double turn = 0.1;  ///< of the normals, at most [rad]
  double time_step = 0.01;
};
ContactProblem boxed_lattice(const BoxedLattice& choice);

/// Joins bodies 2 k and 2 k + 1 of six dofs each, at a point of either: three bilateral rows.
/// @param joints  number of such pairs
void add_ball_joints(ContactProblem& problem, std::int64_t joints, double arm);

/// Two scenes in one, without contacts between them.
/// @param b  in global form like `a`, without contacts
ContactProblem beside(ContactProblem a, const ContactProblem& b);

/// Two walls that leave a sphere less room than it has: no velocity satisfies both.
ContactProblem squeezed_sphere();

}  // namespace tetwarp::scenes
