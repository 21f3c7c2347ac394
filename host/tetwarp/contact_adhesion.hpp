/// @file contact_adhesion.hpp
/// Options and result of evolve_adhesion(), the change of the adhesion intensity over a step.
#pragma once
#include <cstdint>
#include <vector>

namespace tetwarp {

/// Integration of the adhesion intensity over a step.
enum class AdhesionIntegrator {
  exact,          ///< the piecewise linear law in closed form
  explicit_euler  ///< clamped to [0, 1]; for comparison
};

/// Options of evolve_adhesion(): the integrator, and when a contact with energy W > 0 and viscosity
/// > 0 debonds, which sets its beta to 0.
struct EvolutionOptions {
  AdhesionIntegrator integrator = AdhesionIntegrator::exact;
  double debond_gap_factor = 10;   ///< debonds where the gap exceeds this multiple of sqrt(W / C),
                                   ///< >= 1
  double debond_intensity = 1e-3;  ///< debonds in traction where beta falls below this, >= 0
};

/// Adhesion at the start of the next step.
struct AdhesionStep {
  std::vector<double> intensity;       ///< beta, [contacts]
  std::vector<double> gap;             ///< [contacts][3], m; smaller where beta grew, so that new
                                       ///< bonds form without tension
  std::vector<std::uint8_t> debonded;  ///< 1 where the contact debonded in this step
};

}  // namespace tetwarp
