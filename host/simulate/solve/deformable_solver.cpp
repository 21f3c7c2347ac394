/// @file deformable_solver.cpp
/// Solves on the device where bodies are stepped there, else on the host.
#include "host/simulate/solve/deformable_solver.hpp"

#include <utility>

#include "host/simulate/solve/problem/contact_laws.hpp"
#include "host/simulate/step/device_stepper.hpp"

namespace tetwarp {
namespace {

std::shared_ptr<RestFactors> given_or_own(std::shared_ptr<RestFactors> factors,
                                          const Model& model) {
  return factors ? std::move(factors) : std::make_shared<RestFactors>(model);
}

}  // namespace

DeformableSolver::DeformableSolver(const SceneSurfaces& scene,
                                   const Model& model,
                                   const ContactOptions& options,
                                   std::shared_ptr<RestFactors> factors)
    : on_host_(model, options, given_or_own(std::move(factors), model)),
      on_device_(scene, model, options, on_host_.factors()),
      uses_device_(options.backend == Backend::cuda) {}

bool DeformableSolver::begin(BodyStepper& stepper, const ContactShare& share) {
  DeviceStepper* const device = uses_device_ && !share.is_empty() ? stepper.on_device() : nullptr;
  const bool can_try = device != nullptr && on_device_.can_take(share.islands);
  resident_ = can_try ? &device->resident_two_level() : nullptr;
  return can_try;
}

CoupledOutcome DeformableSolver::solve(BodyStepper& stepper,
                                       const SoftProblem& all,
                                       StepRows& rows,
                                       std::vector<Point3>& velocity) {
  gather_laws(all.contacts, all.laws, laws_);
  const SoftProblem problem = {all.state, all.islands,  all.sides, all.rows,
                               all.takes, all.contacts, laws_,     all.change};
  CoupledOutcome on_device;
  if (resident_ != nullptr) {
    on_device = on_device_.solve(*resident_, problem, velocity);
    impulse_ = on_device_.impulse();
    contact_velocity_ = on_device_.contact_velocity();
    if (!on_device.is_result) resident_ = nullptr;
    if (on_device.is_result || on_device.is_stopped) return on_device;
  }
  rows.set_all();
  CoupledOutcome on_host = on_host_.solve(stepper.system(), problem, velocity);
  impulse_ = on_host_.impulse();
  contact_velocity_ = on_host_.contact_velocity();
  on_host.outer_iterations += on_device.outer_iterations;
  on_host.sweeps += on_device.sweeps;
  return on_host;
}

}  // namespace tetwarp
