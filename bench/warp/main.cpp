/// @file main.cpp
/// tetwarp_bench: time and error of warp steps, memory to memory, setup included.
///
/// Runs the short list of rows; with --full, or with Google Benchmark's --benchmark_filter, all
/// rows are registered. rows.hpp lists rows and counters. Exit code 1 when a result was wrong.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>
#include <tetwarp/tetwarp.hpp>

#include "bench/measure/floors.hpp"
#include "bench/measure/program.hpp"
#include "bench/warp/rows.hpp"

namespace {
using namespace tetwarp;

std::string milliseconds(double seconds) {
  return std::to_string(1e3 * seconds) + " ms";
}

/// Adds the machine and its start-up times to the context of the results file.
void describe(const bench::Program& program,
              const BackendStatus& cuda,
              double cuda_seconds,
              int threads) {
  int team = 0;
  const double threads_seconds = bench::seconds_of([&] {
#pragma omp parallel num_threads(threads)
#pragma omp atomic
    ++team;
  });
  program.describe(team);
  benchmark::AddCustomContext("vectors", bench::vector_target());
  benchmark::AddCustomContext("threads_start", milliseconds(threads_seconds));
  benchmark::AddCustomContext("device", cuda.usable ? cuda.device : "none: " + cuda.reason);
  benchmark::AddCustomContext("device_start", milliseconds(cuda_seconds));
  benchmark::AddCustomContext("copy_gigabytes_per_second",
                              std::to_string(1e-9 * bench::copy_bandwidth(threads)));
}
}  // namespace

int main(int argc, char** argv) {
  BackendStatus cuda;
  const double cuda_seconds = bench::seconds_of([&] { cuda = available_backends().front(); });
  const int threads = bench::processor_threads();
  bench::Program program(argc, argv);
  if (!cuda.usable && !program.lists()) {
    std::fprintf(stderr, "back end cuda is left out, none of its rows is measured: %s\n",
                 cuda.reason.c_str());
  }
  const bench::Selection selection{program.extent(), threads, cuda.usable || program.lists()};
  bench::add_step_rows(selection);
  bench::add_series_rows(selection);
  bench::add_overlap_rows(selection);
  bench::add_resident_rows(selection);
  bench::add_copy_rows(selection);
  bench::add_paper_rows(selection);
  bench::add_region_rows(selection);
  bench::add_chunk_rows(selection);
  bench::add_analytic_rows(selection);
  bench::add_label_rows(selection);
  bench::add_feature_rows(selection);
  bench::add_field_rows(selection);
  bench::add_transform_rows(selection);
  bench::add_point_rows(selection);
  if (!program.lists()) describe(program, cuda, cuda_seconds, threads);
  return program.run({"floor_ratio", "ns_per_covered", "cost_share", "cells_touched", "max_error",
                      "rms_error", "wrong_share", "field_ns_per_covered"});
}
