/// @file job_share.cpp
/// Divides the outputs of a job among ranks and gathers their results.
#include "host/cli/warp/job_share.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/cli/job/memory_plan.hpp"
#include "host/cli/warp/volumes/report_exchange.hpp"
#include "host/cli/warp/volumes/volume_run.hpp"

namespace tetwarp::cli {
namespace {
/// The plan with only this rank's steps and outputs, which are assigned round-robin.
VolumePlan share_of(VolumePlan volume, const Ranks& ranks, std::size_t task) {
  const std::vector<WarpStep> steps = std::exchange(volume.steps, {});
  const std::vector<std::string> outputs = std::exchange(volume.outputs, {});
  const std::vector<std::string> files = std::exchange(volume.files, {});
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    const auto owner = static_cast<int>((task + o) % static_cast<std::size_t>(ranks.count()));
    if (owner != ranks.rank()) continue;
    volume.outputs.push_back(outputs[o]);
    const std::size_t count = files.size() / outputs.size();
    const auto first = files.begin() + static_cast<std::ptrdiff_t>(o * count);
    volume.files.insert(volume.files.end(), first, first + static_cast<std::ptrdiff_t>(count));
    if (!volume.is_series) volume.steps.push_back(steps[o]);
  }
  if (volume.is_series) volume.steps = steps;
  return volume;
}
}  // namespace

void run_volume(const WarpArguments& arguments,
                const JobPlan& plan,
                const VolumePlan& volume,
                Ranks& ranks,
                std::size_t task,
                ProgressBar& bar,
                JobResult& result) {
  if (shares_blocks(volume, arguments, ranks.count())) {
    VolumeRun(arguments, plan, volume, ranks, bar, result).run();
    return;
  }
  const VolumePlan share = share_of(volume, ranks, task);
  if (share.outputs.empty()) return;
  Ranks alone;
  VolumeRun(arguments, plan, share, alone, bar, result).run();
}

void plan_only(const WarpArguments& arguments,
               const JobPlan& plan,
               const VolumePlan& volume,
               ProgressBar& bar,
               JobResult& result) {
  Ranks alone;
  VolumeRun(arguments, plan, volume, alone, bar, result).plan_only();
}

void gather_results(const Ranks& ranks, JobResult& result) {
  if (ranks.count() == 1) return;
  const std::vector<std::string> all = ranks.gather(text_of(result));
  for (std::size_t r = 1; r < all.size(); ++r) add_text_to(result, all[r]);
  std::ranges::stable_sort(result.report.steps, {}, &StepReport::step);
}

}  // namespace tetwarp::cli
