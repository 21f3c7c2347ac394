/// @file program.hpp
/// What the benchmark programs have in common around their rows.
#pragma once
#include <string_view>
#include <vector>

#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Reads the command line of a program; what is Google Benchmark's goes there.
class Program {
 public:
  Program(int argc, char** argv);

  /// Brief, unless all rows were asked for: by --full or a filter.
  Extent extent() const { return extent_; }

  /// The value of --NAME=VALUE, which no longer counts as unknown; empty when it is not there.
  std::string_view take(std::string_view name);

  /// Adds what a figure is worth nothing without: commit, compiler, flags, processor, threads.
  void describe(int threads) const;

  /// Runs the registered rows; the console shows these counters and no rows that are left out, the
  /// file of --benchmark_out everything.
  /// @returns exit code: 0, 1 when a result was wrong, 2 on an unknown argument
  int run(std::vector<std::string_view> shown_counters);

 private:
  std::vector<char*> arguments_;
  Extent extent_ = Extent::brief;
};

/// Threads of the processor.
int processor_threads();

}  // namespace tetwarp::bench
