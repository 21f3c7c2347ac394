/// @file resident_two_level.hpp
/// ResidentTwoLevel: solves contacts of deformable and coupled bodies in memory of the device that
/// steps them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/simulate/solve/problem/contact_constants.hpp"
#include "host/simulate/solve/two_level/compliant_lists.hpp"
#include "host/simulate/solve/two_level/two_level_control.hpp"
#include "host/simulate/step/cpu/rest_factors.hpp"
#include "host/simulate/step/resident_contacts.hpp"
#include "host/simulate/step/resident_surfaces.hpp"
#include "kernels/body/contact_arms.hpp"

namespace tetwarp {

/// What a solve starts from.
struct TwoLevelStart {
  double time_step = 0;                ///< [s]
  std::vector<double> rotation;        ///< R of the elastic bodies, [frames][9], rows first
  std::vector<ContactSides> contacts;  ///< that are solved
  ContactConstantsList laws;           ///< of the contacts
  std::vector<double> offset;          ///< w, [3 contacts]
  std::vector<double> impulse;         ///< guess of r, preload included, [3 contacts]
  std::vector<double> change;  ///< added to the velocities without contact, [rows][3]; or empty
};

class ResidentTwoLevel {
 public:
  virtual ~ResidentTwoLevel() = default;
  /// Rows of the system, in memory of the host.
  virtual SystemRows rows() = 0;
  /// The two-level iteration of TwoLevelSolver, from the system that BodyStepper::solve() has made.
  /// @param surfaces  what contacts are on; the same in all calls
  /// @param lists     kept until it returns
  /// @param factors   of the elastic bodies, set to the length of the step; the inverse of each is
  ///                 copied to the device once per length
  /// @throws CudaError  a call of the device fails, as without memory for the inverses
  virtual TwoLevelOutcome solve(const SurfaceBinding& surfaces,
                                const CompliantLists& lists,
                                const TwoLevelStart& start,
                                RestFactors& factors,
                                const ContactOptions& options) = 0;
  /// Copies the results to the host, valid until the next call: impulses, preload included;
  /// body_velocity is [rows][3].
  virtual ResidentResults results() = 0;
  /// As BodyStepper::set_velocities(), with those of the results for the rows of the lists; the
  /// others keep theirs.
  virtual void set_velocities() = 0;
};

}  // namespace tetwarp
