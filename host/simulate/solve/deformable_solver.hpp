/// @file deformable_solver.hpp
/// DeformableSolver: contact islands of bodies that A couples, with their contacts.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/simulate/solve/problem/contact_shares.hpp"
#include "host/simulate/solve/problem/step_rows.hpp"
#include "host/simulate/solve/two_level/compliant_list_maker.hpp"
#include "host/simulate/solve/two_level/resident_two_level.hpp"
#include "host/simulate/solve/two_level/two_level_solver.hpp"

namespace tetwarp {

/// The two-level iteration: with back end cuda on the device that steps the bodies, if one does.
/// Contacts and their laws go there, which makes their rows and lists; impulses and velocities come
/// back. What does not converge there is solved on the host, from the system of the step.
class DeformableSolver {
 public:
  /// @param scene, model  kept by the caller
  /// @param factors       of the elastic bodies, or null: own ones
  DeformableSolver(const SceneSurfaces& scene,
                   const Model& model,
                   const ContactOptions& options,
                   std::shared_ptr<RestFactors> factors);

  /// Begins a solve. @returns whether a device tries first, which needs no rows of contacts
  /// @param stepper  after its solve(), whose velocities are those without contact
  bool begin(BodyStepper& stepper, const ContactShare& share);
  /// @param all       its laws are those of all contacts
  /// @param rows      those of `all`; are set for all contacts where the host solves
  /// @param velocity  in: without contact, [block_count]; out, if there is a result: with contact
  CoupledOutcome solve(BodyStepper& stepper,
                       const SoftProblem& all,
                       StepRows& rows,
                       std::vector<Point3>& velocity);

  /// r and u of the contacts of the last solve(), [3 contacts].
  std::span<const double> impulse() const { return impulse_; }
  std::span<const double> contact_velocity() const { return contact_velocity_; }
  /// The device that solves; after solve() the one whose memory has the velocities. Else null.
  ResidentTwoLevel* resident() const { return resident_; }

 private:
  bool has_inverses(const std::vector<std::uint8_t>& takes) const;
  CoupledOutcome solve_on_device(const SoftProblem& problem, std::vector<Point3>& velocity);

  const SceneSurfaces& scene_;
  ContactOptions options_;
  std::shared_ptr<RestFactors> factors_;
  ContactProblem laws_;                  ///< of the contacts that are taken
  std::vector<std::uint8_t> has_large_;  ///< [coupling islands] a body that has no inverse
  TwoLevelSolver on_host_;
  CompliantListMaker on_device_;  ///< of the bodies as a device takes them
  TwoLevelStart start_;           ///< of a device
  std::vector<double> device_impulse_;
  std::span<const double> impulse_, contact_velocity_;
  ResidentTwoLevel* resident_ = nullptr;
};

}  // namespace tetwarp
