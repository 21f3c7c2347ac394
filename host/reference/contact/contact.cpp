/// @file contact.cpp
/// Solves by enumeration or by Gauss-Seidel, and fills the report.
#include "host/reference/contact/contact.hpp"

#include <chrono>
#include <string>
#include <tetwarp/version.hpp>
#include <utility>
#include <vector>

#include "host/reference/contact/dense.hpp"
#include "host/reference/contact/enumerate.hpp"
#include "host/reference/contact/feasible.hpp"
#include "host/reference/contact/gauss_seidel.hpp"

namespace tetwarp {
namespace {
using Eigen::Index;
using Eigen::VectorXd;
using namespace reference;

constexpr Index max_enumerated_contacts = 8;
constexpr double max_enumerated_states = 60000;

std::vector<double> copied(const VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

/// Throws for rule restrictive where both friction coefficients of a sticky contact differ.
void check_rules(const ContactProblem& problem, const ContactOptions& options) {
  if (options.rule != AdhesionRule::restrictive || problem.adhesion.empty()) return;
  for (std::size_t c = 0; c < problem.second_friction.size(); ++c) {
    if (problem.second_friction[c] == problem.friction[c] || problem.adhesion.intensity[c] == 0) {
      continue;
    }
    throw ContactProblemError("second_friction",
                              "[" + std::to_string(c) +
                                  "]: differs from friction at a contact with adhesion, which rule "
                                  "restrictive does not define; choose rule parallel");
  }
}

VectorXd solve(const DenseContacts& contacts,
               const ContactProblem& problem,
               const ContactOptions& options,
               ContactReport& report) {
  if (contacts.contact_count() == 0) return VectorXd(0);
  if (contacts.contact_count() <= max_enumerated_contacts &&
      mode_count(contacts, options) <= max_enumerated_states) {
    report.method += report.method.empty() ? "enumeration" : ", enumeration";
    const std::vector<VectorXd> solutions = enumerate_impulses(contacts, options);
    if (!solutions.empty()) {
      report.residual_history.push_back(eta_of(contacts, solutions.front(), options));
      return solutions.front();
    }
  }
  report.method += report.method.empty() ? "gauss-seidel" : ", gauss-seidel";
  VectorXd start = VectorXd::Zero(contacts.free_velocity.size());
  if (!problem.impulse_guess.empty()) {
    start.head(3 * contacts.contact_count()) =
        VectorXd::Map(problem.impulse_guess.data(), 3 * contacts.contact_count());
  }
  SweptImpulses swept = gauss_seidel(contacts, options, std::move(start));
  report.sweeps = swept.sweeps;
  report.contact_updates = swept.sweeps * contacts.contact_count();
  report.residual_history = std::move(swept.residual_history);
  return std::move(swept.impulse);
}
}  // namespace

ContactSolution solve_contacts_reference(const ContactProblem& problem,
                                         const ContactOptions& options) {
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  const Clock::time_point start = Clock::now();
  check_problem(problem);
  check_rules(problem, options);
  ContactSolution solution;
  ContactReport& report = solution.report;
  report.version = TETWARP_VERSION;
  report.backend = Backend::reference;
  report.contacts = problem.contact_count();
  report.bilateral_rows = problem.bilateral.row_count();
  report.rolling_contacts = problem.rolling.count();
  DenseContacts contacts = make_dense(problem, options.recovery_speed);
  const Clock::time_point ready = Clock::now();

  VectorXd impulse = solve(contacts, problem, options, report);
  if (!(eta_of(contacts, impulse, options) <= options.tolerance) && !is_feasible(contacts)) {
    report.status = ContactStatus::infeasible;
    report.status_reason = "no velocity keeps all contacts apart";
    if (!problem.is_local()) {
      // With a recovery speed of 0, zero velocity satisfies all contacts.
      report.status_reason += "; penetration is left as it is, at a recovery speed of 0";
      contacts = make_dense(problem, 0);
      impulse = solve(contacts, problem, options, report);
    }
  }
  const Index contact_rows = 3 * contacts.contact_count();
  solution.impulse = copied(impulse.head(contact_rows));
  solution.rolling_impulse = copied(impulse.tail(impulse.size() - contact_rows));
  solution.velocity = copied(contacts.velocity(impulse).head(contact_rows));
  if (!problem.bilateral.empty()) {
    solution.bilateral_impulse =
        copied(contacts.free_bilateral + contacts.bilateral_change * impulse);
  }
  if (!problem.is_local()) {
    solution.body_velocity = copied(contacts.free_body_velocity + contacts.body_change * impulse);
  }
  const Clock::time_point solved = Clock::now();

  report.residual = residual_of(problem, solution, options);
  const double measured =
      options.measure == ContactMeasure::eta ? report.residual.eta : report.residual.fclib;
  if (measured <= options.tolerance) {
    report.status = ContactStatus::converged;
  } else if (report.status != ContactStatus::infeasible) {
    report.status_reason = "the residual did not fall to the tolerance within " +
                           std::to_string(report.sweeps) + " sweeps";
  }
  report.setup_seconds = Seconds(ready - start).count();
  report.solve_seconds = Seconds(solved - ready).count();
  report.total_seconds = Seconds(Clock::now() - start).count();
  return solution;
}

}  // namespace tetwarp
