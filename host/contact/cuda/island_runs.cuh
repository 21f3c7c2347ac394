/// @file island_runs.cuh
/// The islands of a problem that A does not couple, solved on a device in either precision.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "host/contact/cuda/block_islands.cuh"
#include "host/contact/problem/budget.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"
#include "host/contact/sweeps/run.hpp"
#include "kernels/contact/contact_memory.hpp"
#include "kernels/contact/contact_system.hpp"
#include "kernels/contact/cuda/device_sweep.cuh"
#include "kernels/contact/cuda/grid_island.cuh"
#include "kernels/exec/device_limits.cuh"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

/// One index = one contact: how many of its visits sweeps have skipped.
struct SkippedVisitsOp {
  View<const std::int32_t> visits;

  TETWARP_HD PlainSums<1> operator()(std::int64_t slot) const {
    return {{static_cast<double>(visits[slot])}};
  }
};

/// Numbers and unknowns of one problem on a device. Islands that one block each solves quickly are
/// solved by one launch, larger ones one after the other by the whole device.
class IslandRuns {
 public:
  /// @param exec  kept by the caller
  explicit IslandRuns(CudaExec& exec)
      : exec_(exec), limits_(device_limits(exec.number())), blocks_(exec, limits_) {}

  /// Sets the numbers, in the order of the structure.
  /// @param structure  kept by the caller until the next call
  /// @param indices    of the structure, in memory of the device
  /// @param input      in memory of the device
  ContactSavings set_problem(const ContactOptions& options,
                             const ContactStructure& structure,
                             const ContactIndices& indices,
                             const ContactInput& input) {
    if (structure_serial_ != structure.serial) {
      sort_islands(structure);
      structure_serial_ = structure.serial;
    }
    structure_ = &structure;
    indices_ = indices;
    float64_.system.resize(exec_, indices_);
    const ContactSavings savings =
        fill_numbers(exec_, input, indices_, choices_of(options), float64_.system.views());
    float64_.numbers = float64_.system.numbers(indices_);
    if (options.precision == ContactPrecision::float32) {
      convert_system(exec_, indices_, float64_.system, float32_.system);
      float32_.numbers = float32_.system.numbers(indices_);
    }
    return savings;
  }

  /// Solves all islands whose blocks A does not couple, in the precision of the options, and
  /// measures the result in float64.
  /// @param start     sets the first impulses in impulse(), which are zero before
  /// @param budget    limits of large islands; null: none
  /// @param outcomes  out, [islands with contacts]
  /// @return  visits of frozen contacts that sweeps skipped
  template <class Start>
  std::int64_t solve(const ContactOptions& options,
                     const Start& start,
                     SolveBudget* budget,
                     std::vector<IslandOutcome>& outcomes) {
    budget_ = budget;
    float64_.state.reset(exec_, float64_.numbers, freezes_contacts(options));
    measure(options, [&](std::size_t i, const IslandSums& sums) {
      outcomes[i].free = sums.sums;
      outcomes[i].free_square = sums.free_square;
    });
    const std::vector<StopCriterion> criteria = stop_criteria(options, *structure_, outcomes);
    start();
    std::int64_t skipped = 0;
    if (options.precision == ContactPrecision::float64) {
      skipped = solve(options, criteria, float64_, outcomes);
    } else {
      float32_.state.reset(exec_, float32_.numbers, freezes_contacts(options));
      convert(exec_, View<const double>(view_of(float64_.state.impulse)),
              view_of(float32_.state.impulse));
      skipped = solve(options, criteria, float32_, outcomes);
      convert(exec_, View<const float>(view_of(float32_.state.impulse)),
              view_of(float64_.state.impulse));
    }
    measure(options, [&](std::size_t i, const IslandSums& sums) {
      IslandOutcome& outcome = outcomes[i];
      outcome.sums = sums.sums;
      const bool is_done = criteria[i].excess_of(sums.sums) <= 1;
      if (is_done != (outcome.reason == StopReason::converged)) {
        outcome.reason = is_done ? StopReason::converged : StopReason::exhausted;
      }
    });
    return skipped;
  }

  DeviceVector<double>& impulse() { return float64_.state.impulse; }              ///< [3 slots]
  DeviceVector<double>& body_velocity() { return float64_.state.body_velocity; }  ///< [dofs]
  const ContactNumbers<double>& numbers() const { return float64_.numbers; }

 private:
  static constexpr std::int64_t events_per_grid = 1024;

  template <class T>
  struct Problem {
    SystemMemory<CudaExec, T> system;
    ContactNumbers<T> numbers;  ///< views of `system`
    StateMemory<CudaExec, T> state;
    MethodMemory<CudaExec, T> work;
  };

  /// Divides the islands into those for one block or warp each and those for the whole device.
  void sort_islands(const ContactStructure& structure) {
    struct Island {
      std::int64_t number;
      TeamTimes times;
    };
    const ContactIndices indices = structure.indices();
    std::vector<Island> islands;
    for (std::int64_t i = 0; i < structure.contact_islands; ++i) {
      const ContactIsland& own = structure.islands[index_of(i)];
      if (own.is_coupled) continue;
      const std::int64_t bytes =
          island_bytes<double>(own, island_arrays(indices, own), indices.is_local);
      islands.push_back({i, sweep_times(own, bytes)});
    }
    std::stable_sort(islands.begin(), islands.end(), [](const Island& a, const Island& b) {
      return a.times.block > b.times.block;
    });
    std::vector<TeamTimes> times;
    for (const Island& one : islands) times.push_back(one.times);
    const std::size_t by_grid = count_by_grid(times, limits_.multiprocessors);
    std::vector<std::int64_t> small;
    large_.clear();
    for (std::size_t k = 0; k < islands.size(); ++k) {
      (k < by_grid ? large_ : small).push_back(islands[k].number);
    }
    std::sort(large_.begin(), large_.end());
    std::sort(small.begin(), small.end());
    blocks_.set(structure, std::move(small));
  }

  /// Measures the current impulses in float64.
  /// @param take  (std::size_t island, const IslandSums&), called once for each uncoupled island
  template <class Take>
  void measure(const ContactOptions& options, const Take& take) {
    blocks_.measure({float64_.numbers,
                     float64_.state.views(),
                     indices_.color_start,
                     switches_of(options),
                     {},
                     {}},
                    take);
    for (const std::int64_t i : large_) {
      take(static_cast<std::size_t>(i), measure_island(pipeline_of(options, i, float64_)));
    }
  }

  /// Solves all uncoupled islands.
  /// @return  visits of frozen contacts that sweeps skipped
  template <class T>
  std::int64_t solve(const ContactOptions& options,
                     const std::vector<StopCriterion>& criteria,
                     Problem<T>& problem,
                     std::vector<IslandOutcome>& outcomes) {
    const MethodWork<T> work = problem.work.reserve(indices_.slots());
    blocks_.solve(IslandJob<T>{problem.numbers,
                               problem.state.views(),
                               work,
                               indices_.color_start,
                               switches_of(options),
                               plan_of(options),
                               {},
                               0,
                               {},
                               {},
                               0},
                  options, criteria, outcomes);
    const bool is_watched =
        options.progress || options.max_seconds < std::numeric_limits<double>::infinity();
    for (const std::int64_t i : large_) {
      if (limits_.is_cooperative && !is_watched) {
        solve_by_grid(options, i, criteria[index_of(i)], problem, work, outcomes[index_of(i)]);
        continue;
      }
      auto pipeline = pipeline_of(options, i, problem);
      HostEventLog log{.events = {}, .budget = budget_};
      const auto k = static_cast<std::size_t>(i);
      const IslandEnd end = solve_island(pipeline, criteria[k], plan_of(options), 0, work, log);
      outcomes[k].add(end, options.method, island(i).contact_count());
      outcomes[k].events = std::move(log.events);
    }
    const View<const std::int32_t> visits = view_of(std::as_const(problem.state.skipped_visits));
    const auto skipped =
        exec_.sum<PlainSums<1>>("contact/sweep", 0, visits.size, SkippedVisitsOp{visits});
    return static_cast<std::int64_t>(skipped.value[0]);
  }

  /// Solves a large island in one launch, which no limit of time can interrupt.
  template <class T>
  void solve_by_grid(const ContactOptions& options,
                     std::int64_t i,
                     const StopCriterion& criterion,
                     Problem<T>& problem,
                     const MethodWork<T>& work,
                     IslandOutcome& outcome) {
    const std::int64_t terms = most_terms_of(island(i));
    method_state_.resize(GridExec::state_bytes);
    sums_.resize(GridTeam::sum_bytes(terms));
    grid_result_.resize(1);
    grid_events_.resize(events_per_grid);
    contact_solve_by_grid<T>(
        exec_.stream(),
        {problem.numbers, problem.state.views(), work, indices_.color_start, switches_of(options),
         plan_of(options), IslandTask{island(i), criterion}, view_of(method_state_).data,
         view_of(sums_).data, terms, view_of(grid_result_), view_of(grid_events_)},
        limits_.multiprocessors);
    exec_.get(grid_result_, host_result_);
    const IslandResult result = host_result_[0];
    outcome.events.resize(index_of(result.events));
    exec_.get({view_of(grid_events_).data, result.events}, outcome.events.data());
    outcome.add(result.end, options.method, island(i).contact_count());
  }

  template <class T>
  ContactPipeline<CudaExec, T> pipeline_of(const ContactOptions& options,
                                           std::int64_t i,
                                           Problem<T>& problem) {
    return {exec_,     problem.numbers,      view_of(structure_->color_start),
            island(i), switches_of(options), problem.state.views()};
  }

  const ContactIsland& island(std::int64_t i) const {
    return structure_->islands[static_cast<std::size_t>(i)];
  }

  CudaExec& exec_;
  DeviceLimits limits_;
  SolveBudget* budget_ = nullptr;
  const ContactStructure* structure_ = nullptr;
  std::int64_t structure_serial_ = 0;  ///< of the structure that the islands were sorted for
  ContactIndices indices_;
  Problem<double> float64_;
  Problem<float> float32_;  ///< set if the precision of the options is float32
  BlockIslands blocks_;
  std::vector<std::int64_t> large_;  ///< islands; see sort_islands()
  std::vector<IslandResult> host_result_;
  DeviceVector<std::byte> method_state_, sums_;  ///< of the island that a grid solves
  DeviceVector<IslandResult> grid_result_;
  DeviceVector<ContactEvent> grid_events_;
};

}  // namespace tetwarp
