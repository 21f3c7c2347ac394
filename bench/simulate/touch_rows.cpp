#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "bench/measure/row.hpp"
#include "bench/simulate/rows.hpp"

namespace tetwarp::bench {
namespace {
constexpr double pitch = 0.0202;  // between bodies of radius 0.01 [m]

Scene on_floor(std::vector<Body> bodies) {
  Scene scene;
  scene.time_step = 0.004;
  scene.duration = 1;
  scene.bodies = std::move(bodies);
  Obstacle floor;
  floor.name = "floor";
  floor.geometry = PlaneObstacle{{0, 0, 1}, {0, 0, 0}};
  scene.obstacles = {floor};
  scene.thickness = 1e-4;
  scene.contact.material.friction = 0.5;
  return scene;
}

/// A cloth of n x n cells just above the floor, which all its points touch.
Scene cloth(int n) {
  Body body;
  body.name = "cloth";
  body.kind = BodyKind::cloth;
  body.geometry = Sheet{.size = {1, 1}, .cells = {n, n}, .origin = {0, 0, 2e-4}};
  body.self = false;
  return on_floor({body});
}

/// Regular tetrahedra with corners on a sphere of radius 0.01, n x n beside each other.
Scene gravel(int n) {
  std::vector<Body> stones;
  const double s = 0.01 / std::sqrt(3.0);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      Body stone;
      stone.name = "s" + std::to_string(stones.size());
      stone.kind = BodyKind::rigid;
      stone.geometry = Surface{{{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}},
                               {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
      stone.rigid.density = 2500;
      const double angle = 0.7 * static_cast<double>(stones.size());
      stone.pose.rotation = {std::cos(angle), std::sin(angle), 0, 0};
      stone.pose.position = {pitch * i, pitch * j, 0.0102};
      stones.push_back(stone);
    }
  }
  return on_floor(std::move(stones));
}

/// Elastic balls of 0.02 m, n x n beside each other; every second one falls from higher up.
Scene candies(int n) {
  std::vector<Body> balls;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      Body ball;
      ball.name = "c" + std::to_string(balls.size());
      ball.geometry = Shape{EllipsoidShape{{0.01, 0.01, 0.01}}};
      ball.lattice = Lattice{.cells = {{3, 3, 3}}};
      ball.material = {2e4, 0.3, 1000};
      ball.damping = {.alpha = 0, .gamma = 1e-3};
      ball.pose.position = {pitch * i, pitch * j, 0.0102 + ((i + j) % 2 == 0 ? 0 : 0.05)};
      balls.push_back(ball);
    }
  }
  return on_floor(std::move(balls));
}

struct TouchCase {
  const char* name;
  Scene (*make)(int size);
  int size;
  int settle, steps;  ///< before and while it is timed
};

/// Records of the steps after those that settle.
std::vector<StepRecord> records_of(Simulator& simulator, const TouchCase& of) {
  std::vector<StepRecord> records;
  for (int n = 0; n < of.settle + of.steps; ++n) {
    simulator.step();
    if (n >= of.settle) records.push_back(simulator.record());
  }
  return records;
}

template <class Number>
double median_of(const std::vector<StepRecord>& records, const Number& number) {
  std::vector<double> values;
  values.reserve(records.size());
  for (const StepRecord& record : records) values.push_back(static_cast<double>(number(record)));
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Timing timing_of(const std::vector<StepRecord>& records) {
  std::vector<double> seconds;
  seconds.reserve(records.size());
  for (const StepRecord& record : records) seconds.push_back(record.seconds.total);
  std::sort(seconds.begin(), seconds.end());
  Timing timing;
  timing.median = seconds[seconds.size() / 2];
  timing.low = seconds[seconds.size() / 4];
  timing.high = seconds[3 * seconds.size() / 4];
  timing.min = seconds.front();
  timing.kept = static_cast<int>(seconds.size());
  return timing;
}

void run_touch(benchmark::State& state, const TouchCase& of, int threads) {
  Simulator simulator(of.make(of.size), {.threads = threads});
  const std::vector<StepRecord> records = records_of(simulator, of);
  for (const StepRecord& record : records) {
    if (!(record.smallest_distance > 0)) return refuse(state, "surfaces intersect");
  }
  count_timing(state, timing_of(records));
  const std::pair<const char*, double StepSeconds::*> stages[] = {
      {"forces", &StepSeconds::forces},   {"assembly", &StepSeconds::assembly},
      {"linear", &StepSeconds::linear},   {"detection", &StepSeconds::detection},
      {"contact", &StepSeconds::contact}, {"update", &StepSeconds::update}};
  for (const auto& stage : stages) {
    state.counters[stage.first] = median_of(
        records, [&](const StepRecord& of_step) { return 1e3 * of_step.seconds.*stage.second; });
  }
  state.counters["contacts"] = median_of(records, [](const StepRecord& r) { return r.contacts; });
  state.counters["passes"] =
      median_of(records, [](const StepRecord& r) { return r.contact_passes; });
  state.counters["unconverged"] = static_cast<double>(std::count_if(
      records.begin(), records.end(), [](const StepRecord& r) { return !r.converged; }));
  state.counters["sweeps"] = median_of(records, [](const StepRecord& r) { return r.sweeps; });
}

double farthest_apart(const Simulator& a, const Simulator& b) {
  double farthest = 0;
  for (std::size_t body = 0; body < a.scene().bodies.size(); ++body) {
    const std::vector<Point3> one = a.node_positions(body), other = b.node_positions(body);
    for (std::size_t n = 0; n < one.size(); ++n) {
      for (std::size_t d = 0; d < 3; ++d) {
        farthest = std::max(farthest, std::abs(one[n][d] - other[n][d]));
      }
    }
  }
  return farthest;
}

/// The same steps with and without leaving work out.
void run_skip(benchmark::State& state, const TouchCase& of, bool SimulateSkipOptions::*what) {
  Scene scene = of.make(of.size);
  scene.solver.contact_tolerance = 1e-8;
  scene.solver.linear_tolerance = 1e-10;
  SimulateOptions all;
  all.threads = 1;
  all.expert.skip.*what = false;
  Simulator skips(scene, {.threads = 1}), does_all(scene, all);
  const Timing timings[] = {timing_of(records_of(skips, of)), timing_of(records_of(does_all, of))};
  const double difference = farthest_apart(skips, does_all) / *scene.thickness;
  if (!(difference < 1e-2)) return refuse(state, "what is left out changes positions");
  count_beside(state, timings, "all");
  state.counters["error"] = difference;
}

}  // namespace

void add_touch_rows(Extent extent) {
  std::vector<TouchCase> cases = {{"cloth", cloth, 9, 2, 8},     {"cloth", cloth, 31, 2, 6},
                                  {"gravel", gravel, 6, 6, 8},   {"gravel", gravel, 19, 6, 6},
                                  {"candies", candies, 6, 4, 8}, {"candies", candies, 12, 4, 6}};
  if (extent == Extent::full) {
    cases.push_back({"cloth", cloth, 99, 2, 3});
    cases.push_back({"cloth", cloth, 316, 2, 3});
    cases.push_back({"gravel", gravel, 60, 6, 3});
    cases.push_back({"candies", candies, 36, 4, 3});
  }
  for (const TouchCase& of : cases) {
    const std::string axes = std::string("/") + of.name + "/size:" + std::to_string(of.size);
    for (const int threads : {1, 2}) {
      if (threads > processor_threads()) continue;
      add_row("touch" + axes + "/threads:" + std::to_string(threads),
              [=](benchmark::State& state) { run_touch(state, of, threads); });
    }
  }
  const std::pair<const char*, bool SimulateSkipOptions::*> skips[] = {
      {"rotations", &SimulateSkipOptions::rotations},
      {"blocks", &SimulateSkipOptions::blocks},
      {"pairs", &SimulateSkipOptions::pairs},
      {"hits", &SimulateSkipOptions::hits},
      {"islands", &SimulateSkipOptions::islands}};
  for (const auto& [name, member] : skips) {
    add_row(std::string("skip/") + name + "/candies/size:6", [member = member](auto& state) {
      run_skip(state, {"candies", candies, 6, 0, 12}, member);
    });
  }
}

}  // namespace tetwarp::bench
