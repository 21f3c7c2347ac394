/// @file pressed_adhesion.hpp
/// The evolution of adhesion, with a choice of where it runs and of what presses.
#pragma once
#include <span>

#include <tetwarp/contact.hpp>

namespace tetwarp {

class ContactDevice;

/// The public evolve_adhesion() with a choice of where it runs.
/// @param device    runs the stage; null: the host
/// @param pressing  normal impulse on the area of each contact, [contact_count] [N s]; empty: that
///                  of the solution; read on the host
AdhesionStep evolve_adhesion(const ContactProblem& problem,
                             const ContactSolution& solution,
                             const EvolutionOptions& options,
                             ContactDevice* device,
                             std::span<const double> pressing = {});

}  // namespace tetwarp
