/// @file test_coupled_iteration.cpp
/// The loop of the iteration over bodies and contacts: when it ends, its damping and its limits, on
/// one equation a v = b without contacts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/contact_accelerators.hpp"
#include "kernels/contact/coupled_iteration.hpp"

namespace tetwarp::test {
namespace {

/// Steps v' = v + m (b - a v), whose error is that of the equation.
class OneEquation {
 public:
  using Next = CoupledControl::Next;
  static constexpr double b = 3;

  explicit OneEquation(double inverse) : inverse_(inverse) {}

  CpuExec& exec() { return exec_; }
  View<double> now() { return view(v_); }
  View<double> image() { return view(image_); }
  View<const double> weights() { return {weights_.data(), 1}; }
  View<double> mixed() { return {}; }
  bool has_elastic() const { return is_damped; }
  Next start(double damping, CoupledOutcome&) {
    dampings.push_back(damping);
    damping_ = damping;
    v_ = {0};
    return Next::proceeds;
  }
  CoupledControl control(bool ends_early) const {
    return CoupledControl({.has_elastic = is_damped,
                           .ends_early = ends_early,
                           .tolerance = 1e-6,
                           .natural_alone = 1,
                           .least_error = least_error});
  }
  std::optional<CoupledError> find_error(const CoupledOutcome&) {
    const double left = b - a * v_[0];
    image_ = {v_[0] + damping_ * inverse_ * left};
    CoupledError error;
    error.total = error.equations = std::abs(left);
    return error;
  }
  void keep(double residual) { best = residual; }
  double excess(const CoupledOutcome&) {
    ++asked;
    return asked == 1 ? first_excess : later_excess;
  }
  Next limit(const CoupledOutcome& outcome) const {
    const bool is_ended = ends_measure && asked > 0;
    return is_ended || outcome.outer_iterations == most ? Next::is_stopped : Next::proceeds;
  }
  static void solve_contacts(double, CoupledOutcome& outcome) { ++outcome.sweeps; }
  void take_image() { v_ = image_; }

  double velocity() const { return v_[0]; }

  static constexpr double a = 2;
  bool is_damped = false, ends_measure = false;
  double least_error = 0, first_excess = 0, later_excess = 0,
         best = std::numeric_limits<double>::infinity();
  std::int64_t most = -1, asked = 0;
  std::vector<double> dampings;

 private:
  static View<double> view(std::vector<double>& values) { return {values.data(), 1}; }

  CpuExec exec_{1, StageClocks::off};
  double inverse_, damping_ = 1;
  std::vector<double> v_{0}, image_{0}, weights_{1};
};

using UnacceleratedSteps = PlainSteps<CpuExec, double>;

/// The error shrinks by 1 - a m = 1/2 in each iteration, from 3 to 1e-6: 22 times.
TEST(CoupledIteration, EndsWhereTheErrorIsWithinTheTolerance) {
  OneEquation problem(0.25);
  const CoupledOutcome outcome = solve_coupled<UnacceleratedSteps>(problem);

  EXPECT_TRUE(outcome.converged);
  EXPECT_EQ(outcome.outer_iterations, 22);
  EXPECT_EQ(outcome.sweeps, 22);
  EXPECT_LE(outcome.residual, 1e-6);
  EXPECT_NEAR(problem.velocity(), 1.5, 1e-6);
  EXPECT_EQ(problem.dampings, std::vector<double>{1});
}

/// Eight times too far off: three more halves and the margin of a tenth.
TEST(CoupledIteration, GoesOnWhereACloserMeasureIsBeyondTheTolerance) {
  OneEquation problem(0.25);
  problem.first_excess = 8;
  const CoupledOutcome outcome = solve_coupled<UnacceleratedSteps>(problem);

  EXPECT_TRUE(outcome.converged);
  EXPECT_EQ(problem.asked, 2);
  EXPECT_EQ(outcome.outer_iterations, 26);
}

/// The iteration fails where a closer measure has no answer, and where it is beyond the tolerance
/// even when rounding has made the error zero.
TEST(CoupledIteration, FailsWhereACloserMeasureHasNoAnswerOrIsNeverMet) {
  OneEquation lost(0.25);
  lost.first_excess = std::numeric_limits<double>::infinity();
  const CoupledOutcome without = solve_coupled<UnacceleratedSteps>(lost);
  EXPECT_FALSE(without.converged || without.is_stopped);
  EXPECT_EQ(lost.asked, 1);
  EXPECT_GT(without.residual, 0);

  for (const double least_error : {0.0, 1e-3}) {
    OneEquation never(0.25);
    never.first_excess = never.later_excess = 3;
    never.least_error = least_error;
    const CoupledOutcome outcome = solve_coupled<UnacceleratedSteps>(never);
    EXPECT_FALSE(outcome.converged);
    EXPECT_LT(never.asked, 60);
  }
}

/// Where the caller cancels the closer measure, the solve is stopped.
TEST(CoupledIteration, IsStoppedWhereTheCallerEndsACloserMeasure) {
  OneEquation problem(0.25);
  problem.first_excess = std::numeric_limits<double>::infinity();
  problem.ends_measure = true;
  const CoupledOutcome outcome = solve_coupled<UnacceleratedSteps>(problem);

  EXPECT_TRUE(outcome.is_stopped);
  EXPECT_FALSE(outcome.converged);
}

/// With m = 3 damping, |1 - a m| is 5, 2 and 1/2.
TEST(CoupledIteration, HalvesAnInverseThatIsTooLarge) {
  OneEquation problem(3);
  problem.is_damped = true;
  const CoupledOutcome outcome = solve_coupled<UnacceleratedSteps>(problem);

  EXPECT_TRUE(outcome.converged);
  EXPECT_EQ(problem.dampings, (std::vector<double>{1, 0.5, 0.25}));
  EXPECT_NEAR(problem.velocity(), 1.5, 1e-6);
}

TEST(CoupledIteration, FailsWhereTheErrorDoesNotShrink) {
  OneEquation problem(1);  // 1 - a m = -1
  const CoupledOutcome outcome = solve_coupled<UnacceleratedSteps>(problem);

  EXPECT_FALSE(outcome.converged);
  EXPECT_FALSE(outcome.is_stopped);
  EXPECT_LT(outcome.outer_iterations, CoupledControl::most_iterations);
  EXPECT_EQ(problem.best, 3);
}

/// Writes down what it is asked for: o for observe(), f for forget().
class NotingSteps : public UnacceleratedSteps {
 public:
  using UnacceleratedSteps::UnacceleratedSteps;
  void observe(View<const double> x, View<const double> image) {
    notes += 'o';
    UnacceleratedSteps::observe(x, image);
  }
  static void forget() { notes += 'f'; }
  static std::string notes;
};
std::string NotingSteps::notes;

/// Errors that shrink, that grow to 2.5 times in each iteration, and an iteration without mixing.
TEST(CoupledIteration, ForgetsWhatLedToAnErrorTwiceTheLeast) {
  for (const auto& [inverse, is_damped, notes] :
       {std::tuple{0.25, false, "ooo"}, {1.75, false, "ofofof"}, {0.25, true, "foo"}}) {
    OneEquation problem(inverse);
    problem.is_damped = is_damped;
    problem.most = 3;
    NotingSteps::notes.clear();
    solve_coupled<NotingSteps>(problem);
    EXPECT_EQ(NotingSteps::notes, notes);
  }
}

TEST(CoupledIteration, EndsAtALimitWithTheBestSoFar) {
  OneEquation problem(0.25);
  problem.most = 4;
  const CoupledOutcome outcome = solve_coupled<UnacceleratedSteps>(problem);

  EXPECT_TRUE(outcome.is_stopped);
  EXPECT_FALSE(outcome.converged);
  EXPECT_EQ(outcome.outer_iterations, 4);
  EXPECT_EQ(problem.best, 3.0 / 16);
}

}  // namespace
}  // namespace tetwarp::test
