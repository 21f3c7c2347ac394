/// @file timed_row.hpp
/// What all rows of Google Benchmark have in common: a checked result, then a median.
#pragma once
#include <benchmark/benchmark.h>

#include <string>

#include "bench/timing.hpp"

namespace tetwarp::bench {

/// Makes a Timing the time of a row, and its counters.
void count_timing(benchmark::State& state, const Timing& timing);

/// Ends a row without a time.
void refuse(benchmark::State& state, const std::string& fault);

/// Rows so far whose result was wrong.
int refused_rows();

}  // namespace tetwarp::bench
