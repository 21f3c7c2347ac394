/// @file contact_solver.cpp
/// The public calls of the contact solver: checks of the options, choice of the back end, report.
#include <tetwarp/contact.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <tetwarp/version.hpp>

#include "host/base/parallel.hpp"
#include "host/base/warp_backend.hpp"
#include "host/contact/fill_report.hpp"
#include "host/contact/problem/imbalance.hpp"
#include "host/contact/problem/pressed_adhesion.hpp"
#include "host/contact/problem/row_blocks.hpp"
#include "host/contact/problem/spring_offset.hpp"
#include "host/contact/solve/status.hpp"
#include "host/contact/solver_state.hpp"
#include "host/reference/contact/contact.hpp"

namespace tetwarp {
namespace {
using Clock = std::chrono::steady_clock;

void check_options(const ContactOptions& options) {
  const auto fail = [](const std::string& what) { throw std::invalid_argument(what); };
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
    fail("tolerance: expected a finite number above 0");
  }
  if (options.max_sweeps < 1) fail("max_sweeps: expected 1 or more");
  if (!(options.expert.relaxation > 0 && options.expert.relaxation < 2)) {
    fail("relaxation: expected a number above 0 and below 2");
  }
  if (options.expert.inner_sweeps < 1) fail("inner_sweeps: expected 1 or more");
  if (!(options.recovery_speed >= 0)) fail("recovery_speed: expected 0 or more");
  if (!(options.max_seconds > 0)) fail("max_seconds: expected a number above 0");
  if (options.max_newton < 0) fail("max_newton: expected 0 or more");
  if (options.max_memory < 0) fail("max_memory: expected 0 (20 times the problem) or more");
  thread_count(options.threads);
}

/// u = W r + q, or u = J v + w.
std::vector<double> contact_velocity(const ContactProblem& problem,
                                     const ContactSolution& solution) {
  std::vector<double> u = problem.is_local() ? problem.free_velocity : problem.velocity_offset;
  if (problem.is_local()) {
    add_product(problem.delassus, solution.impulse, u);
  } else {
    add_product(problem.jacobian, solution.body_velocity, u);
  }
  return u;
}

/// Solves a problem that may have other rows than those of contacts; moves impulses, velocities and
/// balance to the solution.
EngineResult solve_with_rows(ContactEngine& engine,
                             const ContactProblem& problem,
                             const ContactOptions& options,
                             SolveBudget& budget,
                             DeviceRun* found,
                             ContactSolution& solution) {
  if (!needs_blocks(problem)) {
    EngineResult result = engine.solve(problem, budget, found);
    solution.impulse = std::move(result.impulse);
    solution.body_velocity = std::move(result.body_velocity);
    return result;
  }
  const BlockProblem blocks(problem, options);
  EngineResult result = engine.solve(blocks.problem(), budget);
  blocks.set_solution(result.impulse, result.body_velocity, solution);
  solution.report.residual.balance =
      imbalance(blocks.problem(), result.impulse, result.body_velocity);
  return result;
}

/// Solves a problem whose normal springs may have another gap than dt w_n.
EngineResult solve_with_springs(ContactEngine& engine,
                                const ContactProblem& problem,
                                const ContactOptions& options,
                                SolveBudget& budget,
                                DeviceRun* found,
                                ContactSolution& solution) {
  if (problem.contact_count() == 0 && problem.dof_count() == 0) return {};
  const std::vector<double> preloads = spring_preloads(problem);
  if (preloads.empty()) return solve_with_rows(engine, problem, options, budget, found, solution);
  EngineResult result =
      solve_with_rows(engine, with_preloads(problem, preloads), options, budget, nullptr, solution);
  add_preloads(preloads, -1, solution.impulse);
  return result;
}

}  // namespace

std::pair<Backend, std::string> choose_contact_backend(Backend requested, int device) {
  if (requested == Backend::automatic) {
    return {Backend::cpu, "the default of contact; cuda runs only if requested"};
  }
  return choose_backend(requested, device);
}

void ContactSolver::State::describe(const ContactProblem& problem, ContactReport& report) const {
  report.version = TETWARP_VERSION;
  report.backend = backend;
  report.device = device != nullptr ? device->name() : processor_name();
  report.threads = threads;
  report.contacts = problem.contact_count();
  report.bilateral_rows = problem.bilateral.row_count();
  report.rolling_contacts = problem.rolling.count();
}

ContactSolver::ContactSolver(const ContactOptions& options) {
  check_options(options);
  const int threads = thread_count(options.threads);
  const Backend backend = choose_contact_backend(options.backend, options.device).first;
  std::unique_ptr<ContactDevice> device;
  if (backend == Backend::cuda) device = make_contact_device(options.device);
  ContactEngine engine(options, threads, device.get());
  state_ = std::make_unique<State>(
      State{options, backend, threads, std::move(device), std::move(engine)});
}

ContactSolver::ContactSolver(ContactSolver&&) noexcept = default;
ContactSolver& ContactSolver::operator=(ContactSolver&&) noexcept = default;
ContactSolver::~ContactSolver() = default;

ContactSolution ContactSolver::solve(const ContactProblem& problem) {
  State& s = *state_;
  if (s.backend == Backend::reference) return solve_contacts_reference(problem, s.options);
  SolveBudget budget(s.options, problem);
  return s.solve(problem, budget, nullptr);
}

ContactSolution ContactSolver::State::solve(const ContactProblem& problem,
                                            SolveBudget& budget,
                                            DeviceRun* found) {
  const auto start = Clock::now();
  check_problem(problem);
  ContactSolution solution;
  EngineResult result = solve_with_springs(engine, problem, options, budget, found, solution);
  budget.rethrow();
  ContactReport& report = solution.report;
  describe(problem, report);
  const WholeResidual whole = whole_residual(result.outcomes);
  fill_report(result, whole, options.measure, report);
  solution.velocity = contact_velocity(problem, solution);
  if (!needs_blocks(problem)) {
    report.residual.balance = imbalance(problem, solution.impulse, solution.body_velocity);
  }
  set_status(result, whole, options, budget, solution);
  report.setup_seconds = result.setup_seconds;
  report.total_seconds = seconds_since(start);
  report.solve_seconds = report.total_seconds - report.setup_seconds;
  return solution;
}

AdhesionStep ContactSolver::evolve(const ContactProblem& problem,
                                   const ContactSolution& solution,
                                   const EvolutionOptions& options) {
  return evolve_adhesion(problem, solution, options, state_->device.get());
}

ContactSolution solve_contacts(const ContactProblem& problem, const ContactOptions& options) {
  return ContactSolver(options).solve(problem);
}

}  // namespace tetwarp
