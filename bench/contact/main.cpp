/// @file main.cpp
/// tetwarp_bench_contact: time and error of contact solvers, from a problem in memory to impulses
/// and velocities.
///
/// Runs the short list of rows; with --full, or with Google Benchmark's --benchmark_filter, all
/// rows are registered. The environment variable TETWARP_FCLIB_DATA names folders of recorded
/// problems (*.hdf5), with colons between them, that are added to the generated ones.
/// --export=FOLDER writes the generated problems without adhesion to that folder instead, as input
/// of other solvers. rows.hpp lists the counters. Exit code 1 when a result was wrong.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <tetwarp/backend.hpp>
#include <tetwarp/io.hpp>

#include "bench/contact/cases.hpp"
#include "bench/contact/rows.hpp"
#include "bench/measure/program.hpp"

namespace {
using namespace tetwarp;

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
  const char* const data = std::getenv("TETWARP_FCLIB_DATA");
  const std::string recorded = data != nullptr ? data : "";
  const int threads = bench::processor_threads();
  bench::Program program(argc, argv);
  if (const std::string folder(program.take("export")); !folder.empty()) {
    export_problems(program.extent(), folder);
    return 0;
  }
  if (recorded.empty()) std::printf("No recorded problems: TETWARP_FCLIB_DATA is not set\n");
  const BackendStatus cuda = available_backends().front();
  for (const bench::ContactCase& row :
       bench::contact_cases(program.extent(), threads, recorded, cuda.usable || program.lists())) {
    bench::add_contact_row(row);
  }
  program.describe(threads);
  benchmark::AddCustomContext("device", cuda.usable ? cuda.device : "none: " + cuda.reason);
  benchmark::AddCustomContext("recorded_problems", recorded.empty()
                                                       ? "left out: TETWARP_FCLIB_DATA is not set"
                                                       : "measured");
  return program.run({"error", "sweeps", "converged"});
}
