/// @file general_solver.cpp
/// Chooses the solver for few or for many contacts, and solves on the host or on the device.
#include "host/simulate/solve/general_solver.hpp"

#include <algorithm>
#include <vector>

#include "host/simulate/solve/problem/contact_laws.hpp"
#include "host/simulate/step/device_stepper.hpp"

namespace tetwarp {

GeneralSolver::GeneralSolver(const ContactOptions& options) : options_(options), of_few_(options) {}

/// Newton's method follows where sweeps have not converged. One factorization for many contacts
/// takes as long as hundreds of sweeps, for few contacts as long as about ten: squeezed bodies with
/// fewer than 200 contacts, which Newton's method solves, keep the lower limit of sweeps.
ContactSolver& GeneralSolver::solver_for(std::size_t contact_count) {
  constexpr std::size_t many_contacts = 200;
  if (contact_count < many_contacts || options_.max_sweeps >= many_sweeps) return of_few_;
  if (of_many_ == nullptr) {
    ContactOptions options = options_;
    options.max_sweeps = many_sweeps;
    of_many_ = std::make_unique<ContactSolver>(options);
  }
  return *of_many_;
}

bool GeneralSolver::can_be_resident(const ContactIslands& islands,
                                    const std::vector<std::uint8_t>& takes,
                                    std::size_t contact_count) const {
  if (options_.backend != Backend::cuda || contact_count == 0) return false;
  for (std::int32_t i = 0; i < islands.count(); ++i) {
    if (takes[static_cast<std::size_t>(i)] != 0 && islands.is_coupled(i)) return false;
  }
  return true;
}

ContactReport GeneralSolver::solve(BodyStepper& stepper,
                                   const ContactIslands& islands,
                                   const ContactRows& rows,
                                   const std::vector<std::uint8_t>& takes,
                                   const std::vector<std::int32_t>& contacts,
                                   const ContactProblem& laws,
                                   std::vector<Point3>& velocity) {
  DeviceStepper* const device =
      can_be_resident(islands, takes, contacts.size()) ? stepper.on_device() : nullptr;
  resident_ = device != nullptr ? &device->resident_contacts() : nullptr;
  const SystemRows system_rows = resident_ != nullptr ? resident_->rows() : stepper.system().rows;
  solver_ = &solver_for(contacts.size());  // changes only with the pattern
  const bool is_other = part_.set_pattern(system_rows, islands, rows, takes, contacts);
  gather_laws(contacts, laws, part_.problem());
  return resident_ != nullptr ? solve_on_device(is_other, velocity)
                              : solve_on_host(stepper, velocity);
}

ContactReport GeneralSolver::solve_on_host(BodyStepper& stepper, std::vector<Point3>& velocity) {
  with_pattern_ = nullptr;
  part_.set_numbers(stepper.system());
  solution_ = solver_->solve(part_.problem());
  part_.scatter(solution_.body_velocity, velocity);
  impulse_ = solution_.impulse;
  contact_velocity_ = solution_.velocity;
  return solution_.report;
}

ContactReport GeneralSolver::solve_on_device(bool is_other_pattern, std::vector<Point3>& velocity) {
  AdhesionState& adhesion = part_.problem().adhesion;
  const bool adheres = std::any_of(adhesion.intensity.begin(), adhesion.intensity.end(),
                                   [](double intensity) { return intensity > 0; });
  if (!adheres) {
    for (std::vector<double>* const array :
         {&adhesion.area, &adhesion.stiffness, &adhesion.tangential_stiffness, &adhesion.intensity,
          &adhesion.gap}) {
      array->clear();
    }
  }
  if (is_other_pattern || with_pattern_ != resident_) {
    with_pattern_ = nullptr;
    part_.set_sample();
    solver_->set_structure(part_.problem());
    resident_->set_places(part_.places());
    with_pattern_ = resident_;
  }
  const ResidentStepProblem problem = resident_->set_contacts(part_.arms(), part_.problem());
  const ContactReport report = solver_->solve(problem.arrays, problem.target);
  const ResidentResults results = resident_->results();
  part_.scatter(results.body_velocity, velocity);
  impulse_ = results.impulse;
  contact_velocity_ = results.velocity;
  return report;
}

}  // namespace tetwarp
