/// @file main.cpp
/// tetwarp_bench_simulate: time of the stages of a step of an elastic block, and of products with
/// its system against the rate of copying memory; time against the error of cells, steps and
/// tolerances.
///
/// Runs blocks of 1e3 to 1e5 tetrahedra; with --full, or with Google Benchmark's
/// --benchmark_filter, also 1e6. rows.hpp lists rows and counters. Exit code 1 when a result was
/// wrong.
#include <benchmark/benchmark.h>

#include <string>

#include <tetwarp/backend.hpp>

#include "bench/measure/program.hpp"
#include "bench/simulate/rows.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

int main(int argc, char** argv) {
  using namespace tetwarp;
  bench::Program program(argc, argv);
  const BackendStatus cuda = available_backends().front();
  bench::add_simulate_rows(program.extent(), cuda.usable || program.lists());
  bench::add_error_rows(program.extent());
  bench::add_touch_rows(program.extent());
  program.describe(bench::processor_threads());
  benchmark::AddCustomContext("device", cuda.usable ? cuda.device : "none: " + cuda.reason);
  benchmark::AddCustomContext("vectors", vector_stages().name);
  return program.run({"forces", "assembly", "linear", "iterations", "copy_share", "error",
                      "detection", "contact", "contacts"});
}
