/// @file general_solver.hpp
/// GeneralSolver: coupling islands of a step that the contact solver takes, with their contacts.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/simulate/solve/problem/contact_islands.hpp"
#include "host/simulate/solve/problem/contact_rows.hpp"
#include "host/simulate/solve/problem/step_problem.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// Where a device steps the bodies and A couples no two of them, the problem is built there and its
/// velocities stay there; the host sends contacts and their laws and reads impulses and velocities.
/// Everywhere else the problem is built on the host.
class GeneralSolver {
 public:
  /// Before Newton's method follows, of many contacts: enough for 200 balls that fall into a box,
  /// whose steps take a tenth of the time that they take with 300 sweeps.
  static constexpr std::int64_t many_sweeps = 5000;

  explicit GeneralSolver(const ContactOptions& options);

  /// @param stepper   after its solve()
  /// @param takes     [coupling islands] which are taken
  /// @param contacts  on them, ascending
  /// @param laws      of all contacts
  /// @param velocity  in: without contact; out: with contact in the islands, [block_count]
  ContactReport solve(BodyStepper& stepper,
                      const ContactIslands& islands,
                      const ContactRows& rows,
                      const std::vector<std::uint8_t>& takes,
                      const std::vector<std::int32_t>& contacts,
                      const ContactProblem& laws,
                      std::vector<Point3>& velocity);

  /// r and u of the contacts of the last solve(), [3 contacts].
  std::span<const double> impulse() const { return impulse_; }
  std::span<const double> contact_velocity() const { return contact_velocity_; }
  /// Where the problem of the last solve() is, if that is memory of a device; else null.
  ResidentContacts* resident() const { return resident_; }

 private:
  bool can_be_resident(const ContactIslands& islands,
                       const std::vector<std::uint8_t>& takes,
                       std::size_t contact_count) const;
  ContactSolver& solver_for(std::size_t contact_count);
  ContactReport solve_on_host(BodyStepper& stepper, std::vector<Point3>& velocity);
  ContactReport solve_on_device(bool is_other_pattern, std::vector<Point3>& velocity);

  ContactOptions options_;
  StepProblem part_;
  ContactSolver of_few_;                    ///< contacts
  std::unique_ptr<ContactSolver> of_many_;  ///< made when first needed
  ContactSolver* solver_ = &of_few_;        ///< of the present problem
  ContactSolution solution_;                ///< of a problem built on the host
  std::span<const double> impulse_, contact_velocity_;
  ResidentContacts* resident_ = nullptr;
  ResidentContacts* with_pattern_ = nullptr;  ///< that has the places of the problem, or null
};

}  // namespace tetwarp
