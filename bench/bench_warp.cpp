/// @file bench_warp.cpp
/// Time and error of one warp step, memory to memory, setup included, no files but for chunks.hpp.
///
/// `tetwarp_bench` runs the short list of rows; with --full, or with Google Benchmark's own
/// --benchmark_filter, all of them are there. Rows and columns: warp_cases.hpp, measure.hpp,
/// series.hpp, overlap.hpp, region.hpp, chunks.hpp, analytic.hpp, labels.hpp, features.hpp,
/// fields.hpp. Ends with 1 when a result was wrong.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>
#include <tetwarp/tetwarp.hpp>

#include "bench/analytic.hpp"
#include "bench/chunks.hpp"
#include "bench/features.hpp"
#include "bench/fields.hpp"
#include "bench/floors.hpp"
#include "bench/labels.hpp"
#include "bench/measure.hpp"
#include "bench/overlap.hpp"
#include "bench/program.hpp"
#include "bench/region.hpp"
#include "bench/series.hpp"
#include "bench/timing.hpp"

namespace {

using namespace tetwarp;

std::string milliseconds(double seconds) {
  return std::to_string(1e3 * seconds) + " ms";
}

/// What a figure is worth nothing without.
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
  const bench::Extent extent = program.extent();
  if (!cuda.usable) {
    std::fprintf(stderr, "back end cuda is left out, none of its rows is measured: %s\n",
                 cuda.reason.c_str());
  }
  for (const bench::WarpCase& row : bench::warp_cases(extent, threads, cuda.usable)) {
    bench::register_row(row);
  }
  bench::register_series_rows(extent, threads, cuda.usable);
  bench::register_overlap_rows(extent, threads, cuda.usable);
  bench::register_region_rows(threads, cuda.usable);
  bench::register_chunk_rows(threads);
  bench::register_analytic_rows(extent, threads);
  bench::register_label_rows(extent, threads);
  bench::register_feature_rows(threads);
  bench::register_field_rows(extent, threads);
  describe(program, cuda, cuda_seconds, threads);
  return program.run({"floor_ratio", "ns_per_covered", "cost_share", "cells_touched", "max_error",
                      "rms_error", "wrong_share", "field_ns_per_covered", "position_max",
                      "position_rms"});
}
