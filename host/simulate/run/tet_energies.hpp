/// @file tet_energies.hpp
/// Energies of the tetrahedra of a state.
#pragma once
#include "host/simulate/model/model.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {

/// @returns the elastic energy [J] of all tetrahedra, and how many have a negative volume
/// @param threads  any number: same bits
TetSums tet_energies(const Model& model, const ModelState& state, int threads);

}  // namespace tetwarp
