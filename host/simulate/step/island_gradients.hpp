/// @file island_gradients.hpp
/// IslandGradients: solves the coupling islands of a step by conjugate gradients on an executor.
#pragma once

namespace tetwarp {

/// Defined for each executor; see host/simulate/step/cpu/island_gradients_cpu.hpp for its
/// functions.
template <class Exec>
class IslandGradients;

}  // namespace tetwarp
