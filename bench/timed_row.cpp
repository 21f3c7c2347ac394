/// @file timed_row.cpp
#include "bench/timed_row.hpp"

namespace tetwarp::bench {

namespace {

int refused = 0;

}  // namespace

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

void refuse(benchmark::State& state, const std::string& fault) {
  ++refused;
  state.SkipWithError(("wrong result: " + fault).c_str());
}

int refused_rows() {
  return refused;
}

}  // namespace tetwarp::bench
