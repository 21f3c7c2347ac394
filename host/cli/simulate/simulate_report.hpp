/// @file simulate_report.hpp
/// The report of a simulation.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/cli/job/warnings.hpp"
#include "host/cli/simulate/simulate_arguments.hpp"
#include "host/cli/simulate/simulate_series.hpp"

namespace tetwarp::cli {

/// What a run did.
struct SimulateResult {
  std::int64_t first_step = 0;         ///< of the run: 0, or that of the checkpoint
  std::int64_t steps_done = 0;         ///< of the scene
  std::int64_t frames = 0;             ///< written by this run
  std::int64_t unconverged_steps = 0;  ///< above their tolerance
  std::int64_t late_steps = 0;         ///< whose solves ended by --max-step-seconds
  bool is_interrupted = false;
  std::string error;  ///< why a step failed; empty: none did
  double read_seconds = 0, setup_seconds = 0, step_seconds = 0, write_seconds = 0, warp_seconds = 0,
         draw_seconds = 0, total_seconds = 0;
  std::vector<std::string> outputs;
  Warnings warnings;
};

/// The report as JSON.
std::string report_json(const SimulateArguments& arguments,
                        const Simulator& simulator,
                        const StepSeries& series,
                        const SimulateResult& result);

}  // namespace tetwarp::cli
