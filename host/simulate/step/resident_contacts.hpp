/// @file resident_contacts.hpp
/// ResidentContacts: the contact problem of a step in memory of the device that steps the bodies.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_arrays.hpp>
#include <tetwarp/contact_problem.hpp>

#include "kernels/body/problem_rows.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

/// Where the numbers of a contact problem come from and where they go.
struct ProblemPlaces {
  std::vector<SystemBlockPlace> blocks;   ///< of A
  std::vector<std::int32_t> rows;         ///< [dofs / 3] of the system
  std::vector<std::int32_t> model_block;  ///< [dofs / 3]
  std::vector<ArmPlace> arms;             ///< in J
  std::int64_t system_size = 0;           ///< stored numbers of A
  std::int64_t jacobian_size = 0;         ///< stored numbers of J
};

/// How contacts act on the blocks of a problem.
struct ProblemArms {
  std::vector<double> axes;      ///< [contacts][9] normal, tangent 1, tangent 2
  std::vector<ContactArm> arms;  ///< [arms of the places]
};

/// A problem and room for its results, in memory of the device.
struct ResidentStepProblem {
  ContactArrays arrays;
  ContactTarget target;
};

/// Results in memory of the host.
struct ResidentResults {
  std::span<const double> impulse, velocity;  ///< [3 contacts]
  std::span<const double> body_velocity;      ///< [dofs]
};

class ResidentContacts {
 public:
  virtual ~ResidentContacts() = default;
  /// Rows of the system, in memory of the host.
  virtual SystemRows rows() = 0;
  /// Copies lists of places to the device.
  virtual void set_places(const ProblemPlaces& places) = 0;
  /// Copies contacts to the device and computes A, J and b there, from the system that
  /// BodyStepper::solve() has made.
  /// @param laws  friction, offsets, adhesion and guess of the contacts
  /// @returns  views that are valid until the next call
  virtual ResidentStepProblem set_contacts(const ProblemArms& contacts,
                                           const ContactProblem& laws) = 0;
  /// Copies the results of a solve of this problem to the host, valid until the next call.
  virtual ResidentResults results() = 0;
  /// As BodyStepper::set_velocities(), with those of the results for the blocks of the problem; the
  /// others keep theirs.
  virtual void set_velocities() = 0;
};

}  // namespace tetwarp
