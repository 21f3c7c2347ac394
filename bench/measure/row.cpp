#include "bench/measure/row.hpp"

#include <utility>

namespace tetwarp::bench {
namespace {
int refused = 0;
}  // namespace

void add_row(const std::string& name, std::function<void(benchmark::State&)> run) {
  benchmark::RegisterBenchmark(name.c_str(), std::move(run))
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

void count_timing(benchmark::State& state, const Timing& timing) {
  for (auto _ : state) state.SetIterationTime(timing.median);
  state.counters["low"] = 1e3 * timing.low;
  state.counters["high"] = 1e3 * timing.high;
  state.counters["min"] = 1e3 * timing.min;
  state.counters["kept"] = timing.kept;
  state.counters["discarded"] = timing.discarded;
  state.counters["busy"] = timing.busy;
  state.counters["contended"] = timing.contended;
}

void count_beside(benchmark::State& state,
                  std::span<const Timing> timings,
                  const char* other,
                  const char* ratio) {
  count_timing(state, timings[0]);
  state.counters[other] = 1e3 * timings[1].median;
  state.counters[ratio] = timings[0].median / timings[1].median;
}

void refuse(benchmark::State& state, const std::string& fault) {
  ++refused;
  state.SkipWithError(("wrong result: " + fault).c_str());
}

int refused_rows() {
  return refused;
}

}  // namespace tetwarp::bench
