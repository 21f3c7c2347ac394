/// @file contact_device.cpp
#include "host/contact_device.hpp"

#include <algorithm>
#include <limits>

#include "host/contact_run.hpp"

namespace tetwarp {

namespace {

SweepLimit limit_of(const ContactOptions& options) {
  constexpr std::int64_t patience = 100;
  SweepLimit limit;
  limit.by_eta = options.measure == ContactMeasure::eta;
  limit.tolerance = options.tolerance;
  limit.max_sweeps = options.method == ContactMethod::automatic
                         ? std::max<std::int64_t>(options.max_sweeps / 2, 1)
                         : options.max_sweeps;
  limit.patience = options.method == ContactMethod::gauss_seidel
                       ? std::numeric_limits<std::int64_t>::max()
                       : patience;
  return limit;
}

/// Islands that sweeps can solve, those of most contacts first, so that none of them is begun last.
std::vector<std::int64_t> sweepable_islands(const ContactStructure& structure) {
  std::vector<std::int64_t> order;
  for (std::int64_t i = 0; i < structure.contact_islands; ++i) {
    if (!structure.islands[static_cast<std::size_t>(i)].is_coupled) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::int64_t a, std::int64_t b) {
    return structure.islands[static_cast<std::size_t>(a)].contact_count() >
           structure.islands[static_cast<std::size_t>(b)].contact_count();
  });
  return order;
}

void note(const SweepProgress& progress,
          const StopRule& rule,
          std::int64_t contacts,
          IslandOutcome& outcome) {
  outcome.methods = {"gauss_seidel"};
  outcome.sweeps = progress.sweeps;
  outcome.contact_updates = progress.sweeps * contacts;
  outcome.events.push_back({progress.best_sweep, rule.error_of(progress.sums)});
  outcome.reason = progress.excess <= 1 ? StopReason::converged : StopReason::exhausted;
}

}  // namespace

std::vector<double> sweep_on_device(ContactDevice& device,
                                    const ContactOptions& options,
                                    const ContactStructure& structure,
                                    const ContactSystem<double>& system,
                                    const std::vector<StopRule>& rules,
                                    std::vector<double> impulse,
                                    std::vector<IslandOutcome>& outcomes) {
  if (impulse.empty()) impulse.assign(system.free_velocity.size(), 0.0);
  const std::vector<std::int64_t> order = sweepable_islands(structure);
  if (order.empty()) return impulse;
  SweepTask task{{}, limit_of(options), switches_of(options)};
  for (const std::int64_t i : order) {
    const ContactIsland& island = structure.islands[static_cast<std::size_t>(i)];
    task.islands.push_back({island.slot_begin, island.slot_end, island.color_begin,
                            island.color_end, island.dof_begin, island.dof_end,
                            rules[static_cast<std::size_t>(i)].allowed});
  }
  std::vector<SweepProgress> progress;
  if (options.precision == ContactPrecision::float32) {
    std::vector<float> rounded(impulse.begin(), impulse.end());
    progress = device.sweep(task, structure, make_float32(system), rounded);
    impulse.assign(rounded.begin(), rounded.end());
  } else {
    progress = device.sweep(task, structure, system, impulse);
  }
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto i = static_cast<std::size_t>(order[k]);
    note(progress[k], rules[i], task.islands[k].contact_count(), outcomes[i]);
  }
  return impulse;
}

}  // namespace tetwarp
