/// @file bench_contact.cpp
/// Time and error of contact solvers, from a problem in memory to impulses and velocities.
///
/// `tetwarp_bench_contact` runs the short list of rows; with --full, or with Google Benchmark's own
/// --benchmark_filter, all of them are there. TETWARP_FCLIB_DATA names a folder of recorded
/// problems, *.hdf5, that join the generated ones. --export=FOLDER writes the generated problems
/// without adhesion there instead, for other solvers. Rows and columns: contact_cases.hpp,
/// contact_measure.hpp. Ends with 1 when a result was wrong.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <tetwarp/backend.hpp>
#include <tetwarp/io.hpp>

#include "bench/build_info.hpp"
#include "bench/contact_cases.hpp"
#include "bench/contact_measure.hpp"
#include "bench/timed_row.hpp"

namespace {

using namespace tetwarp;

/// What a figure is worth nothing without.
void describe(int threads, const std::string& folder) {
  const char* const wait = std::getenv("OMP_WAIT_POLICY");
  benchmark::AddCustomContext("commit", bench::build_commit);
  benchmark::AddCustomContext("compiler", bench::build_compiler);
  benchmark::AddCustomContext("flags", bench::build_flags);
  benchmark::AddCustomContext("processor", available_backends()[1].device);
  benchmark::AddCustomContext("threads", std::to_string(threads));
  benchmark::AddCustomContext("omp_wait_policy", wait != nullptr ? wait : "not set");
  benchmark::AddCustomContext(
      "recorded_problems", folder.empty() ? "left out: TETWARP_FCLIB_DATA is not set" : "measured");
}

/// Shows what was measured and the counters that matter most; all rows and counters are in the file
/// of --benchmark_out.
class ShortConsole : public benchmark::ConsoleReporter {
 public:
  ShortConsole() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> shown = runs;
    std::erase_if(shown, [](const Run& run) { return run.error_message.starts_with("left out"); });
    if (shown.empty()) return;
    for (Run& run : shown) {
      std::erase_if(run.counters, [](const auto& counter) {
        constexpr std::string_view kept[] = {"error", "sweeps", "converged"};
        return std::find(std::begin(kept), std::end(kept), counter.first) == std::end(kept);
      });
    }
    benchmark::ConsoleReporter::ReportRuns(shown);
  }
};

void export_problems(bench::Extent extent, const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const bench::ContactInput& input : bench::contact_inputs(extent, "")) {
    const ContactProblem problem = input.make();
    if (!problem.adhesion.empty()) continue;
    const std::string path = folder + "/" + input.name + ".hdf5";
    write_contact_problem(path, problem);
    std::printf("%s\n", path.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const char* const data = std::getenv("TETWARP_FCLIB_DATA");
  const std::string recorded = data != nullptr ? data : "";

  std::vector<char*> arguments(argv, argv + argc);
  bench::Extent extent = bench::Extent::brief;
  const auto full = [](const char* argument) { return std::string_view(argument) == "--full"; };
  if (std::erase_if(arguments, full) > 0) extent = bench::Extent::full;
  for (const std::string_view argument : arguments) {
    if (argument.starts_with("--benchmark_filter")) extent = bench::Extent::full;
    if (argument.starts_with("--export=")) {
      export_problems(extent, std::string(argument.substr(argument.find('=') + 1)));
      return 0;
    }
  }
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;

  if (recorded.empty()) std::printf("No recorded problems: TETWARP_FCLIB_DATA is not set\n");
  for (const bench::ContactCase& row : bench::contact_cases(extent, threads, recorded)) {
    bench::register_contact_row(row);
  }
  describe(threads, recorded);
  ShortConsole console;
  benchmark::RunSpecifiedBenchmarks(&console);
  benchmark::Shutdown();
  if (bench::refused_rows() == 0) return 0;
  std::fprintf(stderr, "%d rows were not timed: their results are wrong\n", bench::refused_rows());
  return 1;
}
