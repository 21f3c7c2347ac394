/// @file two_level_solver.cpp
/// The outer iterations: step, sweeps over contacts, acceleration, and when they end.
#include "host/simulate/solve/two_level/two_level_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"

namespace tetwarp {
namespace {

// Multiplications of all sweeps of a solve, after which it ends: about a second.
constexpr std::int64_t most_operations = 1'000'000'000;
// Steps of Newton's method, after which the iteration goes on.
constexpr std::int64_t most_newton = 40;
// Multiplications of a factorization for Newton's method: where it comes first, about a
// millisecond, and where it follows once the iteration has had as many.
constexpr std::int64_t most_at_first = 4'000'000, most_later = 400'000'000;
constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
// Of the tolerance, at which they end: on stiff cloth the blocks D^-1, in which laws are measured,
// are far below A^-1. A step or two more take little.
constexpr double newton_share = 0.01;
// Up to these sizes the contact solver is quick where the iteration fails.
constexpr std::int64_t small_contacts = 256, small_rows = 128;

}  // namespace

TwoLevelSolver::TwoLevelSolver(const Model& model,
                               const ContactOptions& options,
                               std::shared_ptr<RestFactors> factors)
    : options_(options),
      switches_{options.law == FrictionLaw::pyramid, options.rule == AdhesionRule::restrictive},
      threads_(thread_count(options.threads)),
      exec_(threads_, StageClocks::off),
      factors_(std::move(factors)),
      maker_(factors_->bodies_of_blocks(), CoupledControl::omega(options.expert.relaxation)),
      bare_(model.body_island.size(), 0),
      elastic_(factors_),
      blocks_(threads_),
      step_(model, threads_),
      sweeps_(blocks_, switches_, threads_),
      newton_(blocks_, switches_),
      check_(blocks_, step_, switches_) {}

/// Sets bodies and contacts in the metric M, and starts from the velocities without contact.
void TwoLevelSolver::prepare(double damping) {
  elastic_.set(given_, damping, threads_);
  step_.set(*system_, lists(), elastic_, weights_);
  x_.clear();
  force_.clear();
  for (std::size_t row = 0; row < lists().model_block.size(); ++row) {
    const Point3& own = (*start_)[index_of(lists().model_block[row])];
    const double* const load = system_->load.data + 3 * std::int64_t{lists().system_row[row]};
    x_.insert(x_.end(), own.begin(), own.end());
    force_.insert(force_.end(), load, load + 3);
  }
  blocks_.set(lists(), elastic_, problem_->rows, problem_->contacts, given_, step_.inverse());
  sweeps_.set(elastic_);
  y_.resize(x_.size() + index_of(elastic_.size()));
  impulse_ = given_.impulse;
  contact_velocity_.resize(impulse_.size());
  free_.resize(impulse_.size());
  blocks_.velocities_of_rows(x_, free_);
  check_.set(lists(), free_);
  product_operations_ = 0;
  for (const std::int32_t row : lists().system_row) {
    product_operations_ += 9 * (system_->rows.free_end[row] - system_->rows.start[row]);
  }
  least_error_ = CoupledError::least(step_.run(x_, force_, y_));
  for (std::size_t i = 0; i < given_.change.size(); ++i) x_[i] += given_.change[i];
}

TwoLevelSolver::Next TwoLevelSolver::start(double damping, CoupledOutcome& outcome) {
  prepare(damping);
  checked_ = 0;
  has_newton_ = false;
  newton_at_ = has_elastic() ? never : most_at_first;
  if (has_elastic() || !newton_.set(*system_, lists(), most_at_first)) return Next::proceeds;
  newton_at_ = never;
  const Next end = find_by_newton(outcome);
  return end == Next::fails ? Next::proceeds : end;
}

View<double> TwoLevelSolver::mixed() {
  const std::int64_t size = Mixer::columns * 3 * lists().row_count();
  mixed_.resize(index_of(size));
  return {mixed_.data(), size};
}

CoupledControl TwoLevelSolver::control(bool ends_early) {
  return control(ends_early,
                 (check_.is_needed() ? CoupledControl::check_share : 1) * options_.tolerance);
}

CoupledControl TwoLevelSolver::control(bool ends_early, double tolerance) {
  contact_velocity_.assign(impulse_.size(), 0.0);  // no impulses
  const TouchingSums alone =
      blocks_.measure(switches_, contact_velocity_.data(), free_.data(), free_.data(), working_);
  best_.residual = std::numeric_limits<double>::infinity();
  return CoupledControl({.has_elastic = has_elastic(),
                         .ends_early = ends_early,
                         .tolerance = tolerance,
                         .natural_alone = alone.natural,
                         .least_error = least_error_});
}

std::optional<CoupledError> TwoLevelSolver::find_error(const CoupledOutcome&) {
  blocks_.add_impulses(system_->load, impulse_.data(), force_.data());
  const double defect = step_.run(x_, force_, y_);
  blocks_.velocities_of_rows(x_, contact_velocity_);
  const TouchingSums sums =
      blocks_.measure(switches_, impulse_.data(), contact_velocity_.data(), free_.data(), working_);
  work_ = sums.work;
  return CoupledError::of(defect, sums.natural, sums.work);
}

double TwoLevelSolver::excess(const CoupledOutcome& outcome) {
  if (!check_.is_needed()) return 0;
  checked_ = check_.run(x_, impulse_, contact_velocity_, work_,
                        {options_.tolerance, least_error_ / options_.tolerance},
                        [&] { return !(is_ended_ = !goes_on(outcome.sweeps)); });
  return checked_ / options_.tolerance;
}

void TwoLevelSolver::keep(double residual) {
  best_.residual = residual;
  best_.x = x_;
  best_.impulse = impulse_;
}

void TwoLevelSolver::take_best() {
  if (!std::isfinite(best_.residual)) return;
  x_ = best_.x;
  impulse_ = best_.impulse;
}

/// @param sweeps  so far
bool TwoLevelSolver::goes_on(std::int64_t sweeps) const {
  return !options_.progress || options_.progress({clock_.seconds(), sweeps, 0});
}

/// Whether Newton's method follows the iteration now.
bool TwoLevelSolver::is_newton_due(const CoupledOutcome& outcome) {
  const auto is_over = [&] {
    return sweeps_.operations() + outcome.outer_iterations * product_operations_ >= newton_at_;
  };
  if (!has_newton_ && is_over()) {
    has_newton_ = newton_.set(*system_, lists(), most_later);
    newton_at_ = has_newton_ ? newton_.operations() : never;
  }
  return has_newton_ && is_over();
}

TwoLevelSolver::Next TwoLevelSolver::limit(const CoupledOutcome& outcome) {
  if (is_ended_) return Next::is_stopped;
  if (sweeps_.operations() > most_operations || is_newton_due(outcome)) return Next::fails;
  return goes_on(outcome.sweeps) ? Next::proceeds : Next::is_stopped;
}

void TwoLevelSolver::solve_contacts(double enough, CoupledOutcome& outcome) {
  stepped_ = impulse_;
  outcome.sweeps += sweeps_.run(working_, enough, y_, impulse_, [&](std::int64_t sweeps) {
    return goes_on(outcome.sweeps + sweeps);
  });
  step_.add_elastic(blocks_, stepped_.data(), impulse_.data(), y_);
}

void TwoLevelSolver::take_image() {
  std::copy_n(y_.begin(), x_.size(), x_.begin());
}

/// Newton's method from what prepare() has set.
CoupledControl::Next TwoLevelSolver::find_by_newton(CoupledOutcome& outcome) {
  CoupledControl control = this->control(false, newton_share * options_.tolerance);
  for (std::int64_t steps = 0; steps <= most_newton; ++steps, ++outcome.outer_iterations) {
    const CoupledError error = *find_error(outcome);
    const std::vector<double> defect = step_.defect();
    const Next next = control.next(error, outcome.sweeps, [&] { return excess(outcome); });
    outcome.residual = control.residual();
    if (control.is_best()) keep(control.residual());
    if (next == Next::converges) return next;
    if (is_ended_ || !goes_on(outcome.sweeps)) return Next::is_stopped;
    if (next == Next::fails) break;
    if (!newton_.step(*system_, defect, error, x_, impulse_, contact_velocity_)) break;
  }
  take_best();
  return Next::fails;
}

/// Newton's method from the best iterate; where it fails, the iteration from the better one of
/// both.
void TwoLevelSolver::go_on_by_newton(CoupledOutcome& outcome) {
  take_best();
  Best before = best_;
  checked_ = 0;
  Next end = find_by_newton(outcome);
  newton_at_ = never;
  has_newton_ = false;
  if (end == Next::fails) {
    if (!(best_.residual < before.residual)) best_ = std::move(before);
    take_best();
    before = best_;
    end = iterate_coupled<Mixer>(*this, control(false), CoupledControl::most_iterations, outcome);
    if (end == Next::fails && before.residual < best_.residual) best_ = std::move(before);
  }
  outcome.converged = end == Next::converges;
  outcome.is_stopped = end == Next::is_stopped;
}

/// Whether the contact solver would be quick.
bool TwoLevelSolver::is_small() const {
  return blocks_.count() <= small_contacts && lists().row_count() <= small_rows;
}

CoupledOutcome TwoLevelSolver::solve(const StepSystem& system,
                                     const SoftProblem& problem,
                                     std::vector<Point3>& velocity) {
  clock_ = {};
  is_ended_ = false;
  system_ = &system;
  problem_ = &problem;
  start_ = &velocity;
  ElasticSpace::find_bare(problem, maker_.body_of(), bare_);
  maker_.make(system.rows, problem.islands, problem.takes, bare_);
  if (lists().row_count() == 0) {
    impulse_ = problem.laws.impulse_guess;
    contact_velocity_ = problem.laws.velocity_offset;
    return {.converged = true, .is_result = true};
  }
  given_.set(problem, lists(), *factors_);
  elastic_.set_bodies(lists(), problem.rows, problem.contacts);
  CoupledOutcome outcome = solve_coupled<Mixer>(*this);
  const bool has_failed = !outcome.converged && !outcome.is_stopped;
  if (has_failed && newton_at_ != never &&
      (has_newton_ || newton_.set(system, lists(), most_later))) {
    go_on_by_newton(outcome);
  }
  outcome.is_result =
      outcome.converged || ((outcome.is_stopped || !is_small()) && std::isfinite(best_.residual));
  if (!outcome.is_result) return outcome;
  if (!outcome.converged) {
    outcome.residual =
        std::isfinite(checked_) ? std::max(best_.residual, checked_) : best_.residual;
    take_best();
    blocks_.velocities_of_rows(x_, contact_velocity_);
  } else if (checked_ > 0) {
    outcome.residual = checked_;
  }
  given_.finish(lists(), x_, impulse_, velocity);
  return outcome;
}

}  // namespace tetwarp
