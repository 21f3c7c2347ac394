/// @file resident_two_level.hpp
/// ResidentTwoLevel: solves contacts of deformable and coupled bodies in memory of the device that
/// steps them.
#pragma once
#include <tetwarp/contact.hpp>

#include "host/simulate/solve/two_level/two_level_start.hpp"
#include "host/simulate/step/resident_contacts.hpp"
#include "host/simulate/step/resident_surfaces.hpp"
#include "kernels/contact/coupled_control.hpp"

namespace tetwarp {

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
  virtual CoupledOutcome solve(const SurfaceBinding& surfaces,
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
