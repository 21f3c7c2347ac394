/// @file program.hpp
/// Command line, context and output of the benchmark programs.
#pragma once
#include <string_view>
#include <vector>

namespace tetwarp::bench {

/// Which rows a program registers.
enum class Extent {
  brief,  ///< a few minutes on two cores, enough for every plot
  full
};

/// Reads the command line of a program; options of Google Benchmark are passed on to it.
class Program {
 public:
  Program(int argc, char** argv);

  /// Full with --full or with a filter, else brief.
  Extent extent() const { return extent_; }

  /// Whether names of rows are printed instead of measured: then those of back end cuda are
  /// registered without a device, too.
  bool lists() const { return lists_; }

  /// The value of --NAME=VALUE, which is removed from the arguments; empty when it is not there.
  std::string_view take(std::string_view name);

  /// Adds commit, compiler, flags, processor and threads to the context of the results file.
  void describe(int threads) const;

  /// Runs the registered rows. The console shows these counters and no rows that are left out; the
  /// file of --benchmark_out has everything.
  /// @returns exit code: 0, 1 when a result was wrong, 2 on an unknown argument
  int run(std::vector<std::string_view> shown_counters);

 private:
  std::vector<char*> arguments_;
  Extent extent_ = Extent::brief;
  bool lists_ = false;
};

/// Threads of the processor.
int processor_threads();

}  // namespace tetwarp::bench
