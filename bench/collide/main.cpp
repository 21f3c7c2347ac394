/// @file main.cpp
/// tetwarp_bench_collide: time of collision detection against the number of triangles, beside a
/// sort-and-sweep.
///
/// Runs piles of 1e4 and 1e5 triangles; with --full, or with Google Benchmark's
/// --benchmark_filter, also 1e6. --export=FOLDER writes the piles for other programs and runs
/// nothing. rows.hpp lists rows and counters. Exit code 1 when a result was wrong.
#include <string>

#include <benchmark/benchmark.h>

#include "bench/collide/rows.hpp"
#include "bench/measure/program.hpp"

int main(int argc, char** argv) {
  using namespace tetwarp;
  bench::Program program(argc, argv);
  const std::string folder(program.take("export"));
  if (!folder.empty()) return bench::export_piles(folder, program.extent());
  bench::add_collide_rows(program.extent());
  program.describe(bench::processor_threads());
  return program.run({"broad", "narrow", "entries", "box_tests", "box_pairs", "pairs"});
}
