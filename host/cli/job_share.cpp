/// @file job_share.cpp
#include "host/cli/job_share.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/cli/block_run.hpp"
#include "host/cli/memory_plan.hpp"
#include "host/cli/volume_run.hpp"

namespace tetwarp::cli {

namespace {

/// The steps of a volume that a rank takes, and their outputs, when whole outputs are shared out.
VolumePlan share_of(VolumePlan volume, const Ranks& ranks, std::size_t task) {
  const std::vector<std::int64_t> steps = std::exchange(volume.steps, {});
  const std::vector<std::string> outputs = std::exchange(volume.outputs, {});
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    const auto owner = static_cast<int>((task + o) % static_cast<std::size_t>(ranks.count()));
    if (owner != ranks.rank()) continue;
    volume.outputs.push_back(outputs[o]);
    if (outputs.size() == steps.size()) volume.steps.push_back(steps[o]);
  }
  return volume;
}

static_assert(std::is_trivially_copyable_v<StepReport>, "ranks exchange its bytes");

/// What a rank did but its steps.
struct Sums {
  Timings timings;
  Counts counts;
  std::int64_t written;
  std::int64_t skipped;
};

}  // namespace

void run_volume(const WarpArguments& arguments,
                const JobPlan& plan,
                const VolumePlan& volume,
                Ranks& ranks,
                std::size_t task,
                ProgressBar& bar,
                JobResult& result) {
  const bool is_single = plan.volumes.size() == 1 && volume.outputs.size() == 1;
  if (ranks.count() > 1 && is_single && needs_all_at_once(arguments).empty()) {
    BlockRun(arguments, plan, volume, ranks, bar, result).run();
    return;
  }
  const VolumePlan share = share_of(volume, ranks, task);
  if (share.outputs.empty()) return;
  if (volume.memory_limit > 0) {
    Ranks alone;
    BlockRun(arguments, plan, share, alone, bar, result).run();
  } else {
    VolumeRun(arguments, plan, share, bar, result).run();
  }
}

void plan_only(const WarpArguments& arguments,
               const JobPlan& plan,
               const VolumePlan& volume,
               ProgressBar& bar,
               JobResult& result) {
  if (volume.memory_limit > 0) {
    Ranks alone;
    BlockRun(arguments, plan, volume, alone, bar, result).plan_only();
    return;
  }
  for (const std::int64_t step : plan.steps) {
    StepPlan& how = result.plans.emplace_back();
    how.volume = volume.path;
    how.step = step;
    how.dims = volume.written_grid.dims;
    how.memory = volume.memory;
  }
}

void gather_results(const Ranks& ranks, JobResult& result) {
  Report& report = result.report;
  const Sums mine{report.timings, report.counts, result.written, result.skipped};
  const auto steps = std::as_bytes(std::span(report.steps));
  std::vector<std::byte> bytes(sizeof mine + steps.size());
  std::memcpy(bytes.data(), &mine, sizeof mine);
  std::ranges::copy(steps, bytes.begin() + sizeof mine);
  const std::vector<std::vector<std::byte>> all = ranks.gather(bytes);
  for (std::size_t r = 1; r < all.size(); ++r) {
    Sums other;
    std::memcpy(&other, all[r].data(), sizeof other);
    report.timings += other.timings;
    report.counts += other.counts;
    result.written += other.written;
    result.skipped += other.skipped;
    std::vector<StepReport> more((all[r].size() - sizeof other) / sizeof(StepReport));
    std::ranges::copy(std::span(all[r]).subspan(sizeof other),
                      std::as_writable_bytes(std::span(more)).begin());
    report.steps.insert(report.steps.end(), more.begin(), more.end());
  }
  if (ranks.count() > 1) std::ranges::stable_sort(report.steps, {}, &StepReport::step);
}

}  // namespace tetwarp::cli
