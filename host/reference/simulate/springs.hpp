/// @file springs.hpp
/// Springs of couplings and handles, and the places of loads, of the reference.
#pragma once
#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {

/// The springs of couplings and handles and the places of loads: the share of each selected point
/// is that of its lumped volume (elastic bodies) or area (others); of given points it is equal.
void add_springs(const State& start, System& system);
void add_loads(System& system);

}  // namespace tetwarp::reference
