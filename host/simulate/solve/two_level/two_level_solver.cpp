/// @file two_level_solver.cpp
/// The outer iterations: step, sweeps over contacts, acceleration, and when they end.
#include "host/simulate/solve/two_level/two_level_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/anderson.hpp"

namespace tetwarp {
namespace {

// Multiplications of all sweeps of a solve, after which it ends: about a second.
constexpr std::int64_t most_operations = 1'000'000'000;
// Steps of Newton's method, after which the iteration goes on.
constexpr std::int64_t most_newton = 40;
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
      relaxation_(TwoLevelControl::relaxation(options)),
      factors_(std::move(factors)),
      elastic_(factors_),
      blocks_(threads_),
      step_(model, relaxation_, threads_),
      sweeps_(blocks_, switches_, threads_),
      newton_(blocks_, switches_) {}

/// Sets the contacts in the metric M, and starts from the velocities without contact.
void TwoLevelSolver::prepare(const StepSystem& system,
                             const SoftProblem& problem,
                             const std::vector<Point3>& velocity) {
  const SystemRows& all = system.rows;
  const std::int64_t numbers = 3 * std::int64_t{all.count};
  step_.set(system, islands_, elastic_, weights_);
  for (auto* values : {&x_, &force_}) values->resize(index_of(numbers));
  for (std::int32_t row = 0; row < all.count; ++row) {
    for (std::size_t i = 0; i < 3; ++i) {
      x_[3 * index_of(row) + i] = velocity[index_of(all.block_of[row])][i];
      force_[3 * index_of(row) + i] = system.load[3 * std::int64_t{row} + static_cast<int>(i)];
    }
  }
  blocks_.set(system, islands_, elastic_, problem.rows, problem.contacts, problem.laws,
              step_.inverse(), relaxation_);
  sweeps_.set(elastic_);
  y_.resize(index_of(numbers + elastic_.size()));
  std::copy(x_.begin(), x_.end(), y_.begin());
  impulse_ = problem.laws.impulse_guess;
  for (std::size_t c = 0; c < impulse_.size() / 3; ++c) impulse_[3 * c] += blocks_.preload()[c];
  contact_velocity_.resize(impulse_.size());
  free_.resize(impulse_.size());
  blocks_.velocities_of_rows(x_.data(), free_.data());
  least_error_ = TwoLevelError::least(step_.run(system, x_, force_, y_));
  if (problem.change.size() != velocity.size()) return;
  step_.for_each_row([&](std::int32_t row) {
    const Point3& own = problem.change[index_of(all.block_of[row])];
    for (std::size_t i = 0; i < 3; ++i) x_[3 * index_of(row) + i] += own[i];
  });
}

/// The error of r and v = x.
TwoLevelError TwoLevelSolver::find_error(double defect) {
  blocks_.velocities_of_rows(x_.data(), contact_velocity_.data());
  const TouchingSums sums =
      blocks_.measure(switches_, impulse_.data(), contact_velocity_.data(), free_.data(), working_);
  return TwoLevelError::of(defect, sums.natural, sums.work);
}

void TwoLevelSolver::take_best(TwoLevelOutcome& outcome) {
  outcome.residual = best_.residual;
  x_ = best_.x;
  impulse_ = best_.impulse;
  blocks_.velocities_of_rows(x_.data(), contact_velocity_.data());
}

TwoLevelControl TwoLevelSolver::control(bool ends_early, double tolerance) {
  contact_velocity_.assign(impulse_.size(), 0.0);  // no impulses
  const TouchingSums alone =
      blocks_.measure(switches_, contact_velocity_.data(), free_.data(), free_.data(), working_);
  best_.residual = std::numeric_limits<double>::infinity();
  return TwoLevelControl({.has_elastic = !elastic_.bodies().empty(),
                          .ends_early = ends_early,
                          .tolerance = tolerance,
                          .natural_alone = alone.natural,
                          .least_error = least_error_});
}

/// Finds the error of the present iterate, and keeps the best one.
TwoLevelControl::Next TwoLevelSolver::measure(const StepSystem& system,
                                              TwoLevelControl& control,
                                              TwoLevelOutcome& outcome) {
  blocks_.add_impulses(system.load, impulse_.data(), force_.data());
  error_ = find_error(step_.run(system, x_, force_, y_));
  const TwoLevelControl::Next next = control.next(error_, outcome.sweeps);
  outcome.residual = control.residual();
  if (control.is_best()) {
    best_.residual = control.residual();
    best_.x = x_;
    best_.impulse = impulse_;
  }
  return next;
}

/// Newton's method from what prepare() has set.
TwoLevelSolver::End TwoLevelSolver::find_by_newton(const StepSystem& system,
                                                   TwoLevelOutcome& outcome) {
  TwoLevelControl control = this->control(false, newton_share * options_.tolerance);
  for (std::int64_t steps = 0; steps <= most_newton; ++steps, ++outcome.outer_iterations) {
    const TwoLevelControl::Next next = measure(system, control, outcome);
    if (next == TwoLevelControl::Next::converges) return End::converges;
    if (next == TwoLevelControl::Next::fails) break;
    if (options_.progress && !options_.progress({clock_.seconds(), outcome.sweeps, 0})) {
      return End::is_stopped;
    }
    if (!newton_.step(system, step_.defect(), error_, x_, impulse_, contact_velocity_)) break;
  }
  if (std::isfinite(best_.residual)) {
    x_ = best_.x;
    impulse_ = best_.impulse;
  }
  return End::fails;
}

/// Iterates from what prepare() has set.
/// @param ends_early  where it diverges
TwoLevelSolver::End TwoLevelSolver::iterate(const StepSystem& system,
                                            bool ends_early,
                                            TwoLevelOutcome& outcome) {
  const std::int64_t begin = step_.begin(), size = step_.end() - begin;
  CpuExec exec(threads_, StageClocks::off);
  using Mixer = AndersonMixer<CpuExec, double>;
  mixed_.resize(index_of(Mixer::columns * size));
  Mixer mixer(exec, {weights_.data() + begin, size}, {mixed_.data(), Mixer::columns * size});
  TwoLevelControl control = this->control(ends_early, options_.tolerance);
  while (outcome.outer_iterations < TwoLevelControl::most_iterations) {
    const TwoLevelControl::Next next = measure(system, control, outcome);
    if (next == TwoLevelControl::Next::fails) return End::fails;
    if (next == TwoLevelControl::Next::converges) return End::converges;
    if (next == TwoLevelControl::Next::diverges) return End::diverges;
    if (sweeps_.operations() > most_operations) return End::fails;
    stepped_ = impulse_;
    const auto goes_on = [&](std::int64_t sweeps) {
      return !options_.progress ||
             options_.progress({clock_.seconds(), outcome.sweeps + sweeps, 0});
    };
    outcome.sweeps += sweeps_.run(working_, control.enough(), y_, impulse_, goes_on);
    ++outcome.outer_iterations;
    step_.add_elastic(blocks_, stepped_.data(), impulse_.data(), y_);
    const View<const double> before{x_.data() + begin, size};
    const View<double> image{y_.data() + begin, size};
    if (control.mixes()) {
      mixer.observe(before, image);
      mixer.advance(before, image);
    }
    std::copy_n(y_.data() + begin, size, x_.data() + begin);
    if (!goes_on(0)) return End::is_stopped;
  }
  return End::fails;
}

/// Whether the contact solver would be quick.
bool TwoLevelSolver::is_small() const {
  return blocks_.count() <= small_contacts && step_.end() - step_.begin() <= 3 * small_rows;
}

TwoLevelOutcome TwoLevelSolver::solve(const StepSystem& system,
                                      const SoftProblem& problem,
                                      std::vector<Point3>& velocity) {
  clock_ = {};
  elastic_.choose(system.rows, problem.islands, problem.takes, problem.rows, problem.contacts);
  islands_.set(system.rows, problem.islands, problem.takes, elastic_);
  TwoLevelOutcome outcome;
  End end = End::converges;
  for (double damping = 1; damping >= TwoLevelControl::least_damping; damping /= 2) {
    elastic_.set(problem.state, problem.laws.adhesion.time_step,
                 3 * std::int64_t{system.rows.count}, damping, threads_);
    prepare(system, problem, velocity);
    const bool can_be_damped =
        !elastic_.bodies().empty() && damping > TwoLevelControl::least_damping;
    if (step_.is_empty()) break;
    if (elastic_.bodies().empty() && newton_.set(system, islands_)) {
      end = find_by_newton(system, outcome);
      if (end != End::fails) break;
    }
    end = iterate(system, can_be_damped, outcome);
    if (end != End::diverges) break;
  }
  if (step_.is_empty()) {
    outcome.converged = outcome.is_result = true;
    return outcome;
  }
  outcome.is_stopped = end == End::is_stopped;
  outcome.converged = end == End::converges;
  outcome.is_result =
      outcome.converged || ((outcome.is_stopped || !is_small()) && std::isfinite(best_.residual));
  if (!outcome.is_result) return outcome;
  if (!outcome.converged) take_best(outcome);
  step_.for_each_row([&](std::int32_t row) {
    Point3& own = velocity[index_of(system.rows.block_of[row])];
    for (std::size_t i = 0; i < 3; ++i) own[i] = x_[3 * index_of(row) + i];
  });
  for (std::size_t c = 0; c < impulse_.size() / 3; ++c) impulse_[3 * c] -= blocks_.preload()[c];
  return outcome;
}

}  // namespace tetwarp
