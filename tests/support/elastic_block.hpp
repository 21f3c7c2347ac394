/// @file elastic_block.hpp
/// A block of linear elastic tetrahedra glued to the floor, as one implicit step.
#pragma once
#include <tetwarp/contact_problem.hpp>

namespace tetwarp::test {

struct ElasticBlock {
  int cells = 3;          ///< cubes along each edge, five tetrahedra each
  double edge = 0.1;      ///< of the whole block [m]
  double density = 1000;  ///< [kg/m^3]
  double young = 1e5;     ///< [Pa]
  double poisson = 0.4;
  double time_step = 5e-3;  ///< [s]
  double friction = 0.5;
  double stiffness = 1e6;  ///< of the bonds, beta = 1 [N/m^3]
  double lift = 20;        ///< pulls one half of the top up, presses the other half down [N each]
};

/// A = M + dt^2 K with lumped masses, b = dt F from rest, one contact per node of the lower face.
/// Blocks are nodes of 3.
ContactProblem make_elastic_problem(const ElasticBlock& block);

}  // namespace tetwarp::test
