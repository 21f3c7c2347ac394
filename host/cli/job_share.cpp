/// @file job_share.cpp
#include "host/cli/job_share.hpp"

#include <algorithm>
#include <cstdint>
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

/// What a rank did but its steps.
struct Sums {
  Timings timings;
  Counts counts;
  std::int64_t written;
  std::int64_t skipped;
};

/// A step without its totals, which follow it: `total_count` of before, then as many of after.
struct StepBytes {
  std::int64_t step;
  Timings timings;
  Counts counts;
  std::size_t total_count;
};

template <class T>
void append(std::vector<std::byte>& bytes, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>, "ranks exchange its bytes");
  const auto more = std::as_bytes(values);
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// Copies `values` from the front of `bytes`, which then starts behind them.
template <class T>
void take(std::span<const std::byte>& bytes, std::span<T> values) {
  const auto to = std::as_writable_bytes(values);
  std::ranges::copy(bytes.first(to.size()), to.begin());
  bytes = bytes.subspan(to.size());
}

StepReport take_step(std::span<const std::byte>& bytes) {
  StepBytes step;
  take(bytes, std::span(&step, 1));
  Totals totals{std::vector<double>(step.total_count), std::vector<double>(step.total_count)};
  take(bytes, std::span(totals.before));
  take(bytes, std::span(totals.after));
  return {step.step, step.timings, step.counts, std::move(totals)};
}

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
  std::vector<std::byte> bytes;
  append(bytes, std::span(&mine, 1));
  for (const StepReport& step : report.steps) {
    const StepBytes part{step.step, step.timings, step.counts, step.totals.before.size()};
    append(bytes, std::span(&part, 1));
    append(bytes, std::span<const double>(step.totals.before));
    append(bytes, std::span<const double>(step.totals.after));
  }
  const std::vector<std::vector<std::byte>> all = ranks.gather(bytes);
  for (std::size_t r = 1; r < all.size(); ++r) {
    std::span<const std::byte> left(all[r]);
    Sums other;
    take(left, std::span(&other, 1));
    report.timings += other.timings;
    report.counts += other.counts;
    result.written += other.written;
    result.skipped += other.skipped;
    while (!left.empty()) report.steps.push_back(take_step(left));
  }
  if (ranks.count() > 1) std::ranges::stable_sort(report.steps, {}, &StepReport::step);
}

}  // namespace tetwarp::cli
