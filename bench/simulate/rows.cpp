#include "bench/simulate/rows.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/row.hpp"
#include "host/base/parallel.hpp"
#include "host/exec/huge_pages.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"
#include "host/simulate/step/system_pattern.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::bench {
namespace {
constexpr double time_step = 8e-3;

/// A cube of 1 m with E = 1e4 Pa and random velocities. Rows of one size follow each other, so only
/// the last model is kept.
const Model& block_of(int cells) {
  static int known = 0;
  static Model model;
  if (known == cells) return model;
  model = test::empty_model();
  test::add_block(
      model, {.cells = {cells, cells, cells}, .edge = 1.0 / cells, .youngs = 1e4, .gamma = 2e-3});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> speed(0, 0.1);
  for (Point3& v : model.start.velocity) v = {speed(random), speed(random), speed(random)};
  known = cells;
  return model;
}

Protocol protocol_for(double first_seconds) {
  const int repetitions = std::clamp(static_cast<int>(1 / std::max(first_seconds, 1e-9)), 3, 41);
  return {.repetitions = repetitions, .attempts = 2 * repetitions, .seconds = 5};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Largest difference of velocities after a step of two steppers over the largest velocity.
double difference_of(BodyStepper& a, BodyStepper& b, const StepInput& input) {
  a.step(input);
  b.step(input);
  const ModelState one = test::state_of(a), other = test::state_of(b);
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < one.velocity.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d) {
      difference = std::max(difference, std::abs(one.velocity[i][d] - other.velocity[i][d]));
      largest = std::max(largest, std::abs(one.velocity[i][d]));
    }
  }
  return difference / largest;
}

/// @param threads  of back end cpu; 0: back end cuda
void run_step(benchmark::State& state, int cells, int threads) {
  const Model& model = block_of(cells);
  StepperOptions options;
  options.threads = std::max(threads, 1);
  const StepInput input = test::input_for(model, time_step, {0, 0, -9.81});
  const auto stepper =
      threads > 0 ? make_cpu_stepper(model, options) : make_cuda_stepper(model, options);
  if (threads == 0) {
    StepperOptions exact = options;
    exact.linear_tolerance = 1e-10;
    const auto cuda = make_cuda_stepper(model, exact), cpu = make_cpu_stepper(model, exact);
    if (!(difference_of(*cuda, *cpu, input) < 1e-6)) {
      return refuse(state, "velocities on the device differ from those on the cpu");
    }
  }
  std::vector<StepOutcome> outcomes;
  const std::function<void()> job = [&] { outcomes.push_back(stepper->step(input)); };
  const double first_seconds = seconds_of(job);
  if (!outcomes.front().converged) return refuse(state, "conjugate gradients did not converge");
  outcomes.clear();
  count_timing(state, time_in_turn(std::span(&job, 1), protocol_for(first_seconds)).front());
  const std::pair<const char*, double StepSeconds::*> stages[] = {
      {"forces", &StepSeconds::forces},
      {"assembly", &StepSeconds::assembly},
      {"linear", &StepSeconds::linear},
      {"update", &StepSeconds::update}};
  for (const auto& [name, seconds] : stages) {
    std::vector<double> all;
    all.reserve(outcomes.size());
    for (const StepOutcome& outcome : outcomes) all.push_back(1e3 * (outcome.seconds.*seconds));
    state.counters[name] = median(all);
  }
  state.counters["iterations"] = static_cast<double>(outcomes.back().linear_iterations);
}

void run_product(benchmark::State& state, int cells, int threads) {
  const SystemPattern pattern = make_system_pattern(block_of(cells));
  const std::size_t blocks = pattern.column.size();
  const auto numbers = 3 * static_cast<std::size_t>(pattern.row_count);
  std::vector<double, HugePageAllocator<double>> values(9 * blocks + 1, 0.5);
  std::vector<double> p(numbers, 0.25), q(numbers);
  GradientArrays<double> a;
  a.rows.start = {pattern.start.data(), pattern.row_count + 1};
  a.rows.free_end = {pattern.free_end.data(), pattern.row_count};
  a.rows.column = {pattern.column.data(), static_cast<std::int64_t>(blocks)};
  a.copy = {values.data(), static_cast<std::int64_t>(values.size())};
  a.p = {p.data(), static_cast<std::int64_t>(numbers)};
  a.q = {q.data(), static_cast<std::int64_t>(numbers)};
  const std::int64_t parts = threads == 1 ? 1 : 4 * threads;
  const std::function<void()> job = [&] {
    parallel_tasks(threads, parts, [&](std::int64_t part) {
      vector_stages().product(a, pattern.row_count * part / parts,
                              pattern.row_count * (part + 1) / parts);
    });
  };
  const double first_seconds = seconds_of(job);
  for (std::size_t row = 0; row < static_cast<std::size_t>(pattern.row_count); ++row) {
    if (q[3 * row] != 0.375 * (pattern.start[row + 1] - pattern.start[row])) {
      return refuse(state, "a product differs from the sum of its blocks");
    }
  }
  const double bytes = static_cast<double>(blocks) * (9 * 8 + 4) +
                       static_cast<double>(pattern.row_count) * (2 * 3 * 8 + 2 * 4);
  const auto half = static_cast<std::int64_t>(bytes / 2);
  std::vector<char> from(static_cast<std::size_t>(half), 1), to(from.size());
  const std::function<void()> copy = [&] {
    parallel_tasks(threads, parts, [&](std::int64_t part) {
      const std::int64_t begin = half * part / parts, end = half * (part + 1) / parts;
      std::copy(from.data() + begin, from.data() + end, to.data() + begin);
    });
  };
  const std::function<void()> jobs[] = {job, copy};
  const std::vector<Timing> timings = time_in_turn(jobs, protocol_for(first_seconds));
  count_timing(state, timings[0]);
  state.counters["bytes"] = bytes;
  state.counters["rate"] = bytes / timings[0].min;
  state.counters["copy_share"] = timings[1].min / timings[0].min;
}
}  // namespace

void add_simulate_rows(Extent extent, bool with_cuda) {
  std::vector<int> sizes = {6, 13, 27};  // cells along an edge: 1080, 10985, 98415 tetrahedra
  if (extent == Extent::full) sizes.push_back(58);  // 975560
  std::vector<int> counts = {1};
  if (processor_threads() > 1) counts.push_back(2);
  for (const int cells : sizes) {
    for (const int threads : counts) {
      const std::string axes = "/tets:" + std::to_string(5 * cells * cells * cells) +
                               "/threads:" + std::to_string(threads);
      add_row("step" + axes, [=](benchmark::State& state) { run_step(state, cells, threads); });
      add_row("product" + axes,
              [=](benchmark::State& state) { run_product(state, cells, threads); });
    }
    if (!with_cuda) continue;
    add_row("step/tets:" + std::to_string(5 * cells * cells * cells) + "/cuda",
            [=](benchmark::State& state) { run_step(state, cells, 0); });
  }
}

}  // namespace tetwarp::bench
