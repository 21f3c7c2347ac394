/// @file bench_warp.cpp
/// Time and error of one warp step, memory to memory, setup included, no files.
///
/// `tetwarp_bench` runs the short list of rows; with --full, or with Google Benchmark's own
/// --benchmark_filter, all of them are there. Rows and columns:
/// warp_cases.hpp, measure.hpp, series.hpp, analytic.hpp. Ends with 1 when a result was wrong.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <tetwarp/tetwarp.hpp>
#include <thread>
#include <vector>

#include "bench/analytic.hpp"
#include "bench/build_info.hpp"
#include "bench/floors.hpp"
#include "bench/measure.hpp"
#include "bench/region.hpp"
#include "bench/series.hpp"
#include "bench/timing.hpp"

namespace {

using namespace tetwarp;

std::string milliseconds(double seconds) {
  return std::to_string(1e3 * seconds) + " ms";
}

/// What a figure is worth nothing without.
void describe(const BackendStatus& cuda, double cuda_seconds, int threads) {
  int team = 0;
  const double threads_seconds = bench::seconds_of([&] {
#pragma omp parallel num_threads(threads)
#pragma omp atomic
    ++team;
  });
  const char* const wait = std::getenv("OMP_WAIT_POLICY");
  benchmark::AddCustomContext("commit", bench::build_commit);
  benchmark::AddCustomContext("compiler", bench::build_compiler);
  benchmark::AddCustomContext("flags", bench::build_flags);
  benchmark::AddCustomContext("processor", available_backends()[1].device);
  benchmark::AddCustomContext("vectors", bench::vector_target());
  benchmark::AddCustomContext("threads", std::to_string(team));
  benchmark::AddCustomContext("threads_start", milliseconds(threads_seconds));
  benchmark::AddCustomContext("omp_wait_policy", wait != nullptr ? wait : "not set");
  benchmark::AddCustomContext("device", cuda.usable ? cuda.device : "none: " + cuda.reason);
  benchmark::AddCustomContext("device_start", milliseconds(cuda_seconds));
  benchmark::AddCustomContext("copy_gigabytes_per_second",
                              std::to_string(1e-9 * bench::copy_bandwidth(threads)));
}

/// Shows the counters that matter most; all of them are in the file of --benchmark_out.
class ShortConsole : public benchmark::ConsoleReporter {
 public:
  ShortConsole() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> shown = runs;
    for (Run& run : shown) {
      std::erase_if(run.counters, [](const auto& counter) {
        constexpr std::string_view kept[] = {"floor_ratio",   "ns_per_covered", "cost_share",
                                             "cells_touched", "max_error",      "rms_error",
                                             "position_max",  "position_rms"};
        return std::find(std::begin(kept), std::end(kept), counter.first) == std::end(kept);
      });
    }
    benchmark::ConsoleReporter::ReportRuns(shown);
  }
};

}  // namespace

int main(int argc, char** argv) {
  BackendStatus cuda;
  const double cuda_seconds = bench::seconds_of([&] { cuda = available_backends().front(); });
  const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));

  std::vector<char*> arguments(argv, argv + argc);
  bench::Extent extent = bench::Extent::brief;
  const auto full = [](const char* argument) { return std::string_view(argument) == "--full"; };
  if (std::erase_if(arguments, full) > 0) extent = bench::Extent::full;
  for (const std::string_view argument : arguments) {
    if (argument.starts_with("--benchmark_filter")) extent = bench::Extent::full;
  }
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;

  if (!cuda.usable) {
    std::fprintf(stderr, "back end cuda is left out, none of its rows is measured: %s\n",
                 cuda.reason.c_str());
  }
  for (const bench::WarpCase& row : bench::warp_cases(extent, threads, cuda.usable)) {
    bench::register_row(row);
  }
  bench::register_series_rows(extent, threads, cuda.usable);
  bench::register_region_rows(threads, cuda.usable);
  bench::register_analytic_rows(extent, threads);
  describe(cuda, cuda_seconds, threads);
  ShortConsole console;
  benchmark::RunSpecifiedBenchmarks(&console);
  benchmark::Shutdown();
  if (bench::refused_rows() == 0) return 0;
  std::fprintf(stderr, "%d rows were not timed: their results are wrong\n", bench::refused_rows());
  return 1;
}
