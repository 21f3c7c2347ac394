/// @file contact_cuda.cuh
/// The contact solver on a device. An island that fits one block is solved by one kernel launch;
/// larger ones, and those whose blocks A couples, run stage by stage on the whole device.
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "host/contact/cuda/device.hpp"
#include "host/contact/cuda/device_memory.cuh"
#include "host/contact/structure/indices.hpp"
#include "host/contact/sweeps/run.hpp"
#include "kernels/contact/contact_block.cuh"
#include "kernels/contact/contact_components.hpp"
#include "kernels/contact/contact_grid.cuh"
#include "kernels/contact/contact_memory.hpp"
#include "kernels/contact/contact_system.hpp"

namespace tetwarp {

class CudaContactDevice final : public ContactDevice {
 public:
  CudaContactDevice(int device, std::string name)
      : exec_(device), grid_(exec_), name_(std::move(name)) {}

  ContactSavings set_problem(const ContactOptions& options,
                             const ContactStructure& structure,
                             const ContactInput& input) override {
    const DeviceScope scope(exec_.number());
    if (serial_ != structure.serial) {
      grid_.forget_sweeps();  // a new structure may move the arrays
      indices_in_memory_.restart();
      indices_ = make_indices(structure, [&](const auto& array) {
        return indices_in_memory_.put(grid_, view_of(array));
      });
      serial_ = structure.serial;
    }
    structure_ = &structure;
    float64_.system.resize(grid_, indices_);
    const ContactSavings savings =
        fill_numbers(grid_, input_on_device(grid_, input, input_in_memory_), indices_,
                     choices_of(options), float64_.system.views());
    float64_.numbers = float64_.system.numbers(indices_);
    if (options.precision == ContactPrecision::float32) {
      convert_system(grid_, indices_, float64_.system, float32_.system);
      float32_.numbers = float32_.system.numbers(indices_);
    }
    return savings;
  }

  std::int64_t solve_uncoupled(const ContactOptions& options,
                               std::vector<double>& impulse,
                               std::vector<double>& body_velocity,
                               std::vector<IslandOutcome>& outcomes) override {
    const DeviceScope scope(exec_.number());
    float64_.state.reset(grid_, float64_.numbers, freezes_contacts(options));
    sort_islands();
    measure(options, [&](std::size_t i, const IslandSums& sums) {
      outcomes[i].free = sums.sums;
      outcomes[i].free_square = sums.free_square;
    });
    const std::vector<StopCriterion> criteria = stop_criteria(options, *structure_, outcomes);
    put(impulse, float64_.state.impulse);
    std::int64_t skipped = 0;
    if (options.precision == ContactPrecision::float64) {
      skipped = solve(options, criteria, float64_, outcomes);
    } else {
      float32_.state.reset(grid_, float32_.numbers, freezes_contacts(options));
      convert(grid_, View<const double>(view_of(float64_.state.impulse)),
              view_of(float32_.state.impulse));
      skipped = solve(options, criteria, float32_, outcomes);
      convert(grid_, View<const float>(view_of(float32_.state.impulse)),
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
    get(float64_.state.impulse, impulse);
    get(float64_.state.body_velocity, body_velocity);
    return skipped;
  }

  void solve_coupled(const ContactOptions& options,
                     const ContactIsland& island,
                     const std::vector<double>& guess,
                     std::int64_t max_iterations,
                     std::vector<double>& impulse,
                     std::vector<double>& body_velocity,
                     IslandOutcome& outcome) override {
    const DeviceScope scope(exec_.number());
    put(guess, guess_);
    const auto colors = view_of(structure_->color_start);
    const auto start = view_of(std::as_const(guess_));
    const CoupledTask task{options,          island, colors,         float64_.numbers,
                           float32_.numbers, start,  max_iterations, budget};
    const CoupledSolution best = solve_coupled_island(grid_, task, block_jacobi_memory_, outcome);
    grid_.get(best.impulse, impulse.data());
    grid_.get(best.body_velocity, body_velocity.data());
  }

  std::vector<std::int32_t> lowest_connected(const Lists& lists, std::int64_t item_count) override {
    const DeviceScope scope(exec_.number());
    input_in_memory_.restart();
    labels_.resize(item_count);
    contact_components(grid_, on_device(lists.start), on_device(lists.item), view_of(labels_));
    return labels();
  }

  void evolve(const ContactAdhesionBody& body) override {
    const DeviceScope scope(exec_.number());
    ContactAdhesionBody on_device = body;
    on_device.in = adhesion_on_device(grid_, body.in, input_in_memory_);
    next_intensity_.resize(body.next_intensity.size);
    next_gap_.resize(body.next_gap.size);
    debonded_.resize(body.debonded.size);
    on_device.next_intensity = view_of(next_intensity_);
    on_device.next_gap = view_of(next_gap_);
    on_device.debonded = view_of(debonded_);
    contact_adhesion(grid_, on_device);
    grid_.get(view_of(std::as_const(next_intensity_)), body.next_intensity.data);
    grid_.get(view_of(std::as_const(next_gap_)), body.next_gap.data);
    grid_.get(view_of(std::as_const(debonded_)), body.debonded.data);
  }

  std::string name() const override { return name_; }

 private:
  static constexpr std::int64_t events_per_island = 32;

  template <class T>
  struct Problem {
    SystemMemory<GridContactExec, T> system;
    ContactNumbers<T> numbers;  ///< views of `system`
    StateMemory<GridContactExec, T> state;
    MethodMemory<GridContactExec, T> work;
  };

  template <class T>
  void put(const std::vector<T>& host, DeviceVector<T>& device) {
    grid_.put(host.data(), static_cast<std::int64_t>(host.size()), device);
  }
  template <class T>
  void get(const DeviceVector<T>& device, std::vector<T>& host) {
    host.resize(static_cast<std::size_t>(view_of(device).size));
    grid_.get(view_of(device), host.data());
  }

  template <class T>
  View<const T> on_device(const std::vector<T>& host) {
    return input_in_memory_.put(grid_, view_of(host));
  }
  std::vector<std::int32_t> labels() {
    std::vector<std::int32_t> result;
    get(labels_, result);
    return result;
  }

  /// Divides the islands into those for one block each and those for the whole device. The small
  /// ones are sorted by falling size, so that no long block starts last.
  void sort_islands() {
    small_.clear();
    large_.clear();
    for (std::int64_t i = 0; i < structure_->contact_islands; ++i) {
      if (island(i).is_coupled) continue;
      (island(i).contact_count() > block_contacts ? large_ : small_).push_back(i);
    }
    std::stable_sort(small_.begin(), small_.end(), [&](std::int64_t a, std::int64_t b) {
      return island(a).contact_count() > island(b).contact_count();
    });
  }

  /// Measures the current impulses in float64.
  /// @param take  (std::size_t island, const IslandSums&), called once for each uncoupled island
  template <class Take>
  void measure(const ContactOptions& options, const Take& take) {
    if (!small_.empty()) {
      std::vector<ContactIsland> islands;
      for (const std::int64_t i : small_) islands.push_back(island(i));
      put(islands, islands_);
      measured_.resize(static_cast<std::int64_t>(islands.size()));
      contact_measure_islands<double>(
          exec_.stream(),
          {float64_.numbers, float64_.state.views(), indices_.color_start, switches_of(options),
           view_of(std::as_const(islands_)), view_of(measured_)});
      std::vector<IslandSums> sums;
      get(measured_, sums);
      for (std::size_t k = 0; k < sums.size(); ++k) {
        take(static_cast<std::size_t>(small_[k]), sums[k]);
      }
    }
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
    if (!small_.empty()) solve_small(options, criteria, problem, work, outcomes);
    for (const std::int64_t i : large_) {
      auto pipeline = pipeline_of(options, i, problem);
      HostEventLog log{.events = {}, .budget = budget};
      const auto k = static_cast<std::size_t>(i);
      const IslandEnd end = solve_island(pipeline, criteria[k], plan_of(options), 0, work, log);
      outcomes[k].add(end, options.method, island(i).contact_count());
      outcomes[k].events = std::move(log.events);
    }
    std::vector<std::int32_t> skipped;
    get(problem.state.skipped_visits, skipped);
    return std::accumulate(skipped.begin(), skipped.end(), std::int64_t{0});
  }

  template <class T>
  void solve_small(const ContactOptions& options,
                   const std::vector<StopCriterion>& criteria,
                   Problem<T>& problem,
                   const MethodWork<T>& work,
                   std::vector<IslandOutcome>& outcomes) {
    std::vector<IslandTask> tasks;
    for (const std::int64_t i : small_) {
      tasks.push_back({island(i), criteria[static_cast<std::size_t>(i)]});
    }
    put(tasks, tasks_);
    results_.resize(view_of(tasks_).size);
    events_.resize(view_of(tasks_).size * events_per_island);
    contact_solve_islands<T>(
        exec_.stream(), {problem.numbers, problem.state.views(), work, indices_.color_start,
                         switches_of(options), plan_of(options), view_of(std::as_const(tasks_)),
                         shared_values_for<T>(view_of(std::as_const(tasks))), view_of(results_),
                         view_of(events_), events_per_island});

    std::vector<IslandResult> results;
    std::vector<ContactEvent> events;
    get(results_, results);
    get(events_, events);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      IslandOutcome& outcome = outcomes[static_cast<std::size_t>(small_[k])];
      outcome.add(results[k].end, options.method, tasks[k].island.contact_count());
      const auto first = events.begin() + static_cast<std::ptrdiff_t>(k) * events_per_island;
      outcome.events.assign(first, first + results[k].events);
    }
  }

  template <class T>
  ContactPipeline<GridContactExec, T> pipeline_of(const ContactOptions& options,
                                                  std::int64_t i,
                                                  Problem<T>& problem) {
    return {grid_,     problem.numbers,      view_of(structure_->color_start),
            island(i), switches_of(options), problem.state.views()};
  }

  const ContactIsland& island(std::int64_t i) const {
    return structure_->islands[static_cast<std::size_t>(i)];
  }

  CudaExec exec_;
  GridContactExec grid_;
  std::string name_;
  const ContactStructure* structure_ = nullptr;
  std::int64_t serial_ = 0;  ///< of the structure that `indices_` were copied from
  DeviceArrays indices_in_memory_, input_in_memory_;
  ContactIndices indices_;  ///< views of indices_in_memory_
  Problem<double> float64_;
  Problem<float> float32_;  ///< set if options_.precision is float32
  BlockJacobiMemory<GridContactExec> block_jacobi_memory_;
  DeviceVector<double> guess_, next_intensity_, next_gap_;
  DeviceVector<std::int32_t> labels_;
  DeviceVector<std::uint8_t> debonded_;
  std::vector<std::int64_t> small_, large_;  ///< islands; see sort_islands()
  DeviceVector<ContactIsland> islands_;
  DeviceVector<IslandSums> measured_;
  DeviceVector<IslandTask> tasks_;
  DeviceVector<IslandResult> results_;
  DeviceVector<ContactEvent> events_;
};

}  // namespace tetwarp
