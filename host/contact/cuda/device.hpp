/// @file device.hpp
/// What the contact solver asks of a device: islands, from the numbers of a problem to impulses.
/// What is left to Newton's method stays with the host.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"
#include "kernels/contact/contact_adhesion.hpp"

namespace tetwarp {

struct IslandOutcome;

/// Islands on a device. Every executor runs the same methods; see
/// kernels/contact/contact_methods.hpp.
class ContactDevice : public StructureStages {
 public:
  /// The numbers of a problem, for the calls that follow.
  /// @param structure  kept by the caller until the next set_problem()
  /// @return what was left out
  /// @throws CudaError
  virtual ContactSavings set_problem(const ContactOptions& options,
                                     const ContactStructure& structure,
                                     const ContactInput& input) = 0;

  /// Solves all islands whose blocks A does not couple, in the precision of the options, and judges
  /// them in float64.
  /// @param impulse        [3 slots]; in: to start from; out: the best seen
  /// @param body_velocity  out: what they cause, [dofs], without contacts the free motion; not set
  ///                       in coupled islands
  /// @param outcomes       what it took; the reason says `converged` where nothing is left to do
  /// @return visits of contacts left out
  virtual std::int64_t solve_uncoupled(const ContactOptions& options,
                                       std::vector<double>& impulse,
                                       std::vector<double>& body_velocity,
                                       std::vector<IslandOutcome>& outcomes) = 0;

  /// Iterates one island whose blocks A couples.
  /// @param guess          [3 slots], or empty: none
  /// @param most           outer iterations
  /// @param impulse        out: the best, [3 slots], set in the island
  /// @param body_velocity  out: what it causes, [dofs], set in the island
  virtual void solve_coupled(const ContactOptions& options,
                             const ContactIsland& island,
                             const std::vector<double>& guess,
                             std::int64_t most,
                             std::vector<double>& impulse,
                             std::vector<double>& body_velocity,
                             IslandOutcome& outcome) = 0;

  /// The stage "adhesion".
  /// @param body  views of the host: what it reads, and [contacts] that it writes
  virtual void evolve(const ContactAdhesionBody& body) = 0;

  /// The device's name.
  virtual std::string name() const = 0;
};

/// As the public call.
/// @param device  runs the stage; null: the host does
AdhesionStep evolve_adhesion(const ContactProblem& problem,
                             const ContactSolution& solution,
                             const EvolutionOptions& options,
                             ContactDevice* device);

/// @throws CudaError  no such device answers; the text is the runtime's reason
std::unique_ptr<ContactDevice> make_contact_device(int device);

}  // namespace tetwarp
