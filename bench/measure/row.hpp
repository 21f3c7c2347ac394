/// @file row.hpp
/// Rows of Google Benchmark whose result is checked before its time is taken.
#pragma once
#include <benchmark/benchmark.h>

#include <functional>
#include <span>
#include <string>

#include "bench/measure/timing.hpp"

namespace tetwarp::bench {

/// Registers a row. Google Benchmark calls `run` once; it ends with count_timing(), count_beside()
/// or refuse(). The name is an interface: the report finds the parts of a row in it.
void add_row(const std::string& name, std::function<void(benchmark::State&)> run);

/// Makes the median of a Timing the time of the row and all its numbers counters [ms].
void count_timing(benchmark::State& state, const Timing& timing);

/// The same for the first of two jobs timed in turn. Adds the median of the second [ms] as counter
/// `other`, and first / second as `ratio`.
void count_beside(benchmark::State& state,
                  std::span<const Timing> timings,
                  const char* other,
                  const char* ratio = "cost_share");

/// Ends a row without a time because its result is wrong.
void refuse(benchmark::State& state, const std::string& fault);

/// How many rows were refused so far.
int refused_rows();

}  // namespace tetwarp::bench
