#include "bench/measure/program.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <tetwarp/backend.hpp>
#include <thread>
#include <utility>

#include "bench/build_info.hpp"
#include "bench/measure/row.hpp"

namespace tetwarp::bench {
namespace {
class ShortConsole : public benchmark::ConsoleReporter {
 public:
  explicit ShortConsole(std::vector<std::string_view> counters)
      : ConsoleReporter(OO_Tabular), counters_(std::move(counters)) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> shown = runs;
    std::erase_if(shown, [](const Run& run) { return run.error_message.starts_with("left out"); });
    if (shown.empty()) return;
    for (Run& run : shown) {
      std::erase_if(run.counters, [&](const auto& counter) {
        return std::ranges::find(counters_, counter.first) == counters_.end();
      });
    }
    benchmark::ConsoleReporter::ReportRuns(shown);
  }

 private:
  std::vector<std::string_view> counters_;
};
}  // namespace

Program::Program(int argc, char** argv) : arguments_(argv, argv + argc) {
  const auto is_full = [](std::string_view argument) { return argument == "--full"; };
  const auto is_filter = [](std::string_view argument) {
    return argument.starts_with("--benchmark_filter");
  };
  const auto is_list = [](std::string_view argument) {
    return argument.starts_with("--benchmark_list_tests");
  };
  lists_ = std::ranges::any_of(arguments_, is_list);
  if (std::ranges::any_of(arguments_, is_filter)) extent_ = Extent::full;
  if (std::erase_if(arguments_, is_full) > 0) extent_ = Extent::full;
}

std::string_view Program::take(std::string_view name) {
  const std::string start = "--" + std::string(name) + "=";
  const auto found = std::ranges::find_if(
      arguments_, [&](std::string_view argument) { return argument.starts_with(start); });
  if (found == arguments_.end()) return {};
  const std::string_view value = std::string_view(*found).substr(start.size());
  arguments_.erase(found);
  return value;
}

void Program::describe(int threads) const {
  const char* const wait = std::getenv("OMP_WAIT_POLICY");
  benchmark::AddCustomContext("commit", build_commit);
  benchmark::AddCustomContext("compiler", build_compiler);
  benchmark::AddCustomContext("flags", build_flags);
  benchmark::AddCustomContext("processor", available_backends()[1].device);
  benchmark::AddCustomContext("threads", std::to_string(threads));
  benchmark::AddCustomContext("omp_wait_policy", wait != nullptr ? wait : "not set");
}

int Program::run(std::vector<std::string_view> shown_counters) {
  int count = static_cast<int>(arguments_.size());
  benchmark::Initialize(&count, arguments_.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments_.data())) return 2;
  ShortConsole console(std::move(shown_counters));
  benchmark::RunSpecifiedBenchmarks(&console);
  benchmark::Shutdown();
  if (refused_rows() == 0) return 0;
  std::fprintf(stderr, "%d rows were not timed: their results are wrong\n", refused_rows());
  return 1;
}

int processor_threads() {
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace tetwarp::bench
