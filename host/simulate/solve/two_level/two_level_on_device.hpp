/// @file two_level_on_device.hpp
/// TwoLevelOnDevice: contacts of deformable and coupled bodies, solved where they are stepped.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/simulate/solve/problem/soft_problem.hpp"
#include "host/simulate/solve/two_level/compliant_list_maker.hpp"
#include "host/simulate/solve/two_level/resident_two_level.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// As TwoLevelSolver. Contacts and their laws go to the device, which makes their rows and lists;
/// impulses and velocities come back. The system of the step stays there.
class TwoLevelOnDevice {
 public:
  /// @param scene  kept by the caller
  TwoLevelOnDevice(const SceneSurfaces& scene,
                   const Model& model,
                   const ContactOptions& options,
                   std::shared_ptr<RestFactors> factors);

  /// Whether all elastic bodies among islands that have factors on the host have inverses here.
  bool can_take(const std::vector<std::uint8_t>& takes) const;

  /// @param resident  of the stepper, after its solve()
  /// @param velocity  out, if there is a result: with contact in the islands, [block_count]
  CoupledOutcome solve(ResidentTwoLevel& resident,
                       const SoftProblem& problem,
                       std::vector<Point3>& velocity);

  /// r and u of the contacts of the last solve(), [3 contacts].
  const std::vector<double>& impulse() const { return impulse_; }
  const std::vector<double>& contact_velocity() const { return contact_velocity_; }

 private:
  void take_results(const ResidentResults& results, std::vector<Point3>& velocity);

  const SceneSurfaces& scene_;
  ContactOptions options_;
  std::shared_ptr<RestFactors> factors_;
  CompliantListMaker maker_;
  TwoLevelStart start_;
  std::vector<double> impulse_, contact_velocity_;
};

}  // namespace tetwarp
