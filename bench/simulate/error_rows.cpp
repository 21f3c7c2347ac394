#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "bench/measure/row.hpp"
#include "bench/simulate/rows.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/support/cantilever.hpp"

namespace tetwarp::bench {
namespace {
using test::Cantilever;

/// A beam that gravity bends by 1.5 % of its length.
Simulator beam(std::int64_t across, double time_step, double alpha, int threads) {
  const Cantilever cantilever{.across = across, .gravity = 0.0981, .time_step = time_step};
  Scene scene = cantilever.scene();
  scene.bodies[0].damping = {.alpha = alpha, .gamma = 0};
  return Simulator(std::move(scene), {.threads = threads});
}

/// Deflection of the tip after `duration` [s] and the mean time of a step.
struct Bend {
  double tip = 0;
  double milliseconds = 0;
  double iterations = 0;
};
Bend bend(std::int64_t across, double time_step, double alpha, double duration) {
  Simulator simulator = beam(across, time_step, alpha, processor_threads());
  const std::vector<Point3> rest = simulator.node_positions(0);
  const auto steps = static_cast<int>(std::lround(duration / time_step));
  Bend result;
  result.milliseconds = 1e3 / steps * seconds_of([&] {
                          for (int n = 0; n < steps; ++n) simulator.step();
                        });
  result.tip = Cantilever::tip_height(rest, rest) -
               Cantilever::tip_height(rest, simulator.node_positions(0));
  result.iterations = static_cast<double>(simulator.record().linear_iterations);
  return result;
}

void set_time(benchmark::State& state, double milliseconds) {
  Timing timing;
  timing.median = timing.low = timing.high = timing.min = 1e-3 * milliseconds;
  timing.kept = 1;
  count_timing(state, timing);
}

/// At rest, after 5 s of nearly critical damping.
void run_bend(benchmark::State& state, std::int64_t across) {
  const Cantilever exact{.across = across, .gravity = 0.0981};
  const Bend result = bend(across, 5e-3, 6, 5);
  set_time(state, result.milliseconds);
  state.counters["tets"] = static_cast<double>(50 * across * across * across);
  state.counters["tip"] = result.tip / exact.beam_tip();
  state.counters["error"] = std::abs(1 - result.tip / exact.beam_tip());
  state.counters["iterations"] = result.iterations;
}

/// Released without damping: the tip after about half a period, against that of short steps.
void run_swing(benchmark::State& state, double time_step) {
  constexpr double duration = 1, shortest = 2.5e-4;
  constexpr std::int64_t across = 2;
  static const double exact = [&] {
    const double fine = bend(across, shortest, 0, duration).tip;
    return 2 * fine - bend(across, 2 * shortest, 0, duration).tip;  // of first order in the step
  }();
  const Bend result = bend(across, time_step, 0, duration);
  set_time(state, result.milliseconds);
  state.counters["error"] = std::abs(1 - result.tip / exact);
  state.counters["ms_per_second"] = result.milliseconds / time_step;
}

/// A free block of 1e7 Pa with random velocities: what the solver's residual does to the momentum.
void run_momentum(benchmark::State& state, double tolerance) {
  Model model = test::empty_model();
  test::add_block(model, {.cells = {13, 13, 13}, .edge = 1.0 / 13, .youngs = 1e7, .gamma = 2e-3});
  std::mt19937 random(1);
  std::normal_distribution<double> speed(0, 0.1);
  for (Point3& v : model.start.velocity) v = {speed(random), speed(random), speed(random)};
  StepperOptions options;
  options.threads = processor_threads();
  options.linear_tolerance = tolerance;
  const auto stepper = make_cpu_stepper(model, options);
  const StepInput input = test::input_for(model, 8e-3);
  const Point3 before = test::momentum(model, model.start);
  StepOutcome outcome = stepper->step(input);
  const ModelState after = test::state_of(*stepper);
  const double defect = test::distance(test::momentum(model, after), before);
  double total = 0;
  for (std::size_t n = 0; n < model.node_mass.size(); ++n) {
    total += model.node_mass[n] * test::distance(model.start.velocity[n], {0, 0, 0});
  }
  const auto iterations = static_cast<double>(outcome.linear_iterations);
  const std::function<void()> job = [&] {
    stepper->set_state(model.start);
    outcome = stepper->step(input);
  };
  count_timing(state, time_in_turn(std::span(&job, 1), {.repetitions = 5, .attempts = 9}).front());
  state.counters["error"] = defect / total;
  state.counters["iterations"] = iterations;
}
}  // namespace

void add_error_rows(Extent extent) {
  std::vector<std::int64_t> sizes = {1, 2, 4};
  if (extent == Extent::full) sizes.push_back(8);
  for (const std::int64_t across : sizes) {
    add_row("bend/cells:" + std::to_string(across),
            [=](benchmark::State& state) { run_bend(state, across); });
  }
  for (const int tenths : {5, 10, 20, 50, 100, 200}) {
    char name[32];
    std::snprintf(name, sizeof name, "swing/step:%.1fms", 0.1 * tenths);
    add_row(name, [=](benchmark::State& state) { run_swing(state, 1e-4 * tenths); });
  }
  for (const int digits : {2, 3, 4, 5, 6, 8, 10}) {
    add_row("momentum/tolerance:1e-" + std::to_string(digits),
            [=](benchmark::State& state) { run_momentum(state, std::pow(10, -digits)); });
  }
}

}  // namespace tetwarp::bench
