/// @file tet_energies.hpp
/// Energies of the tetrahedra of a state.
#pragma once
#include "host/simulate/cpu/vector_stages.hpp"
#include "host/simulate/model.hpp"

namespace tetwarp {

/// @param threads  any number: same bits
TetSums tet_energies(const Model& model, const ModelState& state, int threads);

}  // namespace tetwarp
