/// @file contact_cuda.cuh
/// The contact solver on a device: islands that one block can hold in one launch, the others and
/// those that A couples stage by stage on the whole device.
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "host/contact_device.hpp"
#include "host/contact_device_memory.cuh"
#include "host/contact_outer.hpp"
#include "host/contact_run.hpp"
#include "kernels/contact_block.cuh"
#include "kernels/contact_grid.cuh"

namespace tetwarp {

class CudaContactDevice final : public ContactDevice {
 public:
  CudaContactDevice(int device, std::string name)
      : exec_(device), grid_(exec_), name_(std::move(name)) {}

  void set_problem(const ContactOptions& options,
                   const ContactStructure& structure,
                   const ContactSystem<double>& system) override {
    exec_.use_stream(nullptr);  // makes the device current on this thread
    grid_.forget_sweeps();
    structure_ = &structure;
    indices_.put(grid_, structure);
    float64_.put(grid_, structure, indices_, system);
    if (options.precision == ContactPrecision::float32) {
      float32_.put(grid_, structure, indices_, make_float32(system));
    }
  }

  std::int64_t solve_uncoupled(const ContactOptions& options,
                               const std::vector<StopRule>& rules,
                               std::vector<double>& impulse,
                               std::vector<IslandOutcome>& outcomes) override {
    if (options.precision == ContactPrecision::float64) {
      return solve(options, rules, impulse, float64_, outcomes);
    }
    std::vector<float> rounded(impulse.begin(), impulse.end());
    const std::int64_t skipped = solve(options, rules, rounded, float32_, outcomes);
    impulse.assign(rounded.begin(), rounded.end());
    return skipped;
  }

  void solve_coupled(const ContactOptions& options,
                     const ContactIsland& island,
                     const std::vector<double>& guess,
                     std::int64_t most,
                     std::vector<double>& impulse,
                     std::vector<double>& body_velocity,
                     IslandOutcome& outcome) override {
    grid_.forget_sweeps();
    DeviceVector<double> guess_there;
    grid_.put(guess.data(), static_cast<std::int64_t>(guess.size()), guess_there);
    CoupledJudge<GridContactExec> judge(grid_, options, float64_.numbers, island);
    solve_coupled_island(grid_, options, float64_.numbers, float32_.numbers,
                         view_of(structure_->color_start), island,
                         view_of(std::as_const(guess_there)), most, judge, outcome);
    grid_.get(judge.best_impulse(), impulse.data());
    grid_.get(judge.best_body_velocity(), body_velocity.data());
  }

  std::string name() const override { return name_; }

 private:
  static constexpr std::int64_t events_per_island = 32;

  template <class T>
  std::int64_t solve(const ContactOptions& options,
                     const std::vector<StopRule>& rules,
                     std::vector<T>& impulse,
                     DeviceSystem<T>& system,
                     std::vector<IslandOutcome>& outcomes) {
    std::vector<std::int64_t> large, small;
    for (std::int64_t i = 0; i < structure_->contact_islands; ++i) {
      if (island(i).is_coupled) continue;
      (island(i).contact_count() > block_contacts ? large : small).push_back(i);
    }
    if (large.empty() && small.empty()) return 0;
    // Long ones first, so that none of them is begun last.
    std::stable_sort(small.begin(), small.end(), [&](std::int64_t a, std::int64_t b) {
      return island(a).contact_count() > island(b).contact_count();
    });
    grid_.put(impulse.data(), static_cast<std::int64_t>(impulse.size()), system.impulse);
    system.reset(grid_, freezes_contacts(options));
    if (!small.empty()) solve_small(options, rules, small, system, outcomes);
    for (const std::int64_t i : large) solve_large(options, rules, i, system, outcomes);
    grid_.get(view_of(std::as_const(system.impulse)), impulse.data());
    const View<const std::int32_t> left_out = view_of(std::as_const(system.left_out));
    std::vector<std::int32_t> visits(static_cast<std::size_t>(left_out.size));
    grid_.get(left_out, visits.data());
    return std::accumulate(visits.begin(), visits.end(), std::int64_t{0});
  }

  template <class T>
  void solve_small(const ContactOptions& options,
                   const std::vector<StopRule>& rules,
                   const std::vector<std::int64_t>& islands,
                   DeviceSystem<T>& system,
                   std::vector<IslandOutcome>& outcomes) {
    std::vector<IslandTask> tasks;
    for (const std::int64_t i : islands) {
      tasks.push_back({island(i), rules[static_cast<std::size_t>(i)]});
    }
    const auto count = static_cast<std::int64_t>(tasks.size());
    IslandJob<T> job;
    job.numbers = system.numbers;
    job.state = system.state();
    job.work = system.work();
    job.color_start = indices_.color_start();
    job.switches = switches_of(options);
    job.plan = plan_of(options);
    grid_.put(tasks.data(), count, tasks_);
    job.tasks = view_of(std::as_const(tasks_));
    job.shared_values = shared_values_for<T>(view_of(std::as_const(tasks)));
    results_.resize(count);
    job.results = results_.view();
    events_.resize(count * events_per_island);
    job.events = events_.view();
    job.events_per_island = events_per_island;
    contact_solve_islands(exec_.stream(), job);

    std::vector<IslandResult> results(tasks.size());
    std::vector<ContactEvent> events(static_cast<std::size_t>(job.events.size));
    grid_.get(View<const IslandResult>(job.results), results.data());
    grid_.get(View<const ContactEvent>(job.events), events.data());
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      IslandOutcome& outcome = outcomes[static_cast<std::size_t>(islands[k])];
      outcome.take(results[k].end, options.method, tasks[k].island.contact_count());
      const auto first = events.begin() + static_cast<std::ptrdiff_t>(k) * events_per_island;
      outcome.events.insert(outcome.events.end(), first, first + results[k].events);
    }
  }

  template <class T>
  void solve_large(const ContactOptions& options,
                   const std::vector<StopRule>& rules,
                   std::int64_t i,
                   DeviceSystem<T>& system,
                   std::vector<IslandOutcome>& outcomes) {
    IslandOutcome& outcome = outcomes[static_cast<std::size_t>(i)];
    ContactPipeline<GridContactExec, T> pipeline(grid_, system.numbers,
                                                 view_of(structure_->color_start), island(i),
                                                 switches_of(options), system.state());
    HostEventLog log;
    const IslandEnd end = solve_island(pipeline, rules[static_cast<std::size_t>(i)],
                                       plan_of(options), outcome.sweeps, system.work(), log);
    outcome.take(end, options.method, island(i).contact_count());
    outcome.events.insert(outcome.events.end(), log.events.begin(), log.events.end());
  }

  const ContactIsland& island(std::int64_t i) const {
    return structure_->islands[static_cast<std::size_t>(i)];
  }

  CudaExec exec_;
  GridContactExec grid_;
  std::string name_;
  const ContactStructure* structure_ = nullptr;
  DeviceIndices indices_;
  DeviceSystem<double> float64_;
  DeviceSystem<float> float32_;
  DeviceVector<IslandTask> tasks_;
  DeviceVector<IslandResult> results_;
  DeviceVector<ContactEvent> events_;
};

}  // namespace tetwarp
