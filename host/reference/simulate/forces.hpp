/// @file forces.hpp
/// Forces of elements, cloth and loads of the reference.
#pragma once
#include <cstddef>

#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {

/// Force of a load by block at the positions of `state`; zero outside its times.
VectorXd load_force(const System& system, const State& state, std::size_t load, double end_time);

/// Force of elements, edges and bending on the nodes.
VectorXd elastic_force(const System& system, const State& state);
Matrix34 positions_of(const Element& element, const State& state);

}  // namespace tetwarp::reference
