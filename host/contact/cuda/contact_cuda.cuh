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

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "host/contact/cuda/device.hpp"
#include "host/contact/cuda/device_memory.cuh"
#include "host/contact/sweeps/run.hpp"
#include "kernels/contact/contact_block.cuh"
#include "kernels/contact/contact_color.hpp"
#include "kernels/contact/contact_components.hpp"
#include "kernels/contact/contact_grid.cuh"

namespace tetwarp {

class CudaContactDevice final : public ContactDevice {
 public:
  CudaContactDevice(int device, std::string name)
      : exec_(device), grid_(exec_), name_(std::move(name)) {}

  ContactSavings set_problem(const ContactOptions& options,
                             const ContactStructure& structure,
                             const ContactInput& input) override {
    exec_.use_stream(nullptr);  // makes the device current on this thread
    if (serial_ != structure.serial) {
      grid_.forget_sweeps();  // with the same structure they find everything in its place
      indices_ = indices_on_device(grid_, structure.indices(), arrays_);
      serial_ = structure.serial;
    }
    structure_ = &structure;
    float64_.resize(grid_, indices_);
    const ContactSavings savings = fill_numbers(grid_, input_on_device(grid_, input, given_),
                                                indices_, choices_of(options), float64_.views());
    numbers_ = float64_.numbers(indices_);
    if (options.precision == ContactPrecision::float32) {
      convert_system(grid_, indices_, float64_, float32_);
      rounded_ = float32_.numbers(indices_);
    }
    return savings;
  }

  std::int64_t solve_uncoupled(const ContactOptions& options,
                               std::vector<double>& impulse,
                               std::vector<double>& body_velocity,
                               std::vector<IslandOutcome>& outcomes) override {
    state64_.reset(grid_, numbers_, freezes_contacts(options));
    sort_islands();
    grid_.resize(state64_.impulse, numbers_.free_velocity.size);
    measure(options, [&](std::size_t i, const IslandSums& sums) {
      outcomes[i].free = sums.sums;
      outcomes[i].free_square = sums.free_square;
    });
    const std::vector<StopCriterion> criteria = stop_criteria(options, *structure_, outcomes);
    put(impulse, state64_.impulse);
    std::int64_t skipped = 0;
    if (options.precision == ContactPrecision::float64) {
      skipped = solve(options, criteria, numbers_, state64_, outcomes);
    } else {
      state32_.reset(grid_, rounded_, freezes_contacts(options));
      state32_.impulse.resize(numbers_.free_velocity.size);
      convert(grid_, View<const double>(view_of(state64_.impulse)), view_of(state32_.impulse));
      skipped = solve(options, criteria, rounded_, state32_, outcomes);
      convert(grid_, View<const float>(view_of(state32_.impulse)), view_of(state64_.impulse));
    }
    measure(options, [&](std::size_t i, const IslandSums& sums) {
      IslandOutcome& outcome = outcomes[i];
      outcome.sums = sums.sums;
      const bool is_done = criteria[i].excess_of(sums.sums) <= 1;
      if (is_done != (outcome.reason == StopReason::converged)) {
        outcome.reason = is_done ? StopReason::converged : StopReason::exhausted;
      }
    });
    get(state64_.impulse, impulse);
    get(state64_.body_velocity, body_velocity);
    return skipped;
  }

  void solve_coupled(const ContactOptions& options,
                     const ContactIsland& island,
                     const std::vector<double>& guess,
                     std::int64_t max_iterations,
                     std::vector<double>& impulse,
                     std::vector<double>& body_velocity,
                     IslandOutcome& outcome) override {
    put(guess, guess_);
    const CoupledTask task{options,       island,   view_of(structure_->color_start),
                           numbers_,      rounded_, view_of(std::as_const(guess_)),
                           max_iterations};
    const CoupledSolution best = solve_coupled_island(grid_, task, block_jacobi_memory_, outcome);
    grid_.get(best.impulse, impulse.data());
    grid_.get(best.body_velocity, body_velocity.data());
  }

  std::vector<std::int32_t> lowest_connected(const Lists& lists, std::int64_t item_count) override {
    exec_.use_stream(nullptr);
    given_.restart();
    const View<const std::int64_t> start = there(lists.start);
    const View<const std::int32_t> item = there(lists.item);
    labels_.resize(item_count);
    contact_components(grid_, start, item, view_of(labels_));
    return labels();
  }

  std::vector<std::int32_t> colors_of(const Lists& groups, const Lists& members) override {
    exec_.use_stream(nullptr);
    given_.restart();
    const ContactGroups views = {there(groups.start), there(groups.item), there(members.start),
                                 there(members.item)};
    labels_.resize(groups.size());
    contact_color(grid_, views, view_of(labels_));
    return labels();
  }

  void evolve(const ContactAdhesionBody& body) override {
    exec_.use_stream(nullptr);
    ContactAdhesionBody there = body;
    there.in = adhesion_on_device(grid_, body.in, given_);
    next_intensity_.resize(body.next_intensity.size);
    next_gap_.resize(body.next_gap.size);
    debonded_.resize(body.debonded.size);
    there.next_intensity = view_of(next_intensity_);
    there.next_gap = view_of(next_gap_);
    there.debonded = view_of(debonded_);
    contact_adhesion(grid_, there);
    grid_.get(view_of(std::as_const(next_intensity_)), body.next_intensity.data);
    grid_.get(view_of(std::as_const(next_gap_)), body.next_gap.data);
    grid_.get(view_of(std::as_const(debonded_)), body.debonded.data);
  }

  std::string name() const override { return name_; }

 private:
  static constexpr std::int64_t events_per_island = 32;

  template <class T>
  void put(const std::vector<T>& host, DeviceVector<T>& there) {
    grid_.put(host.data(), static_cast<std::int64_t>(host.size()), there);
  }
  template <class T>
  void get(const DeviceVector<T>& there, std::vector<T>& host) {
    host.resize(static_cast<std::size_t>(view_of(there).size));
    grid_.get(view_of(there), host.data());
  }

  template <class T>
  View<const T> there(const std::vector<T>& host) {
    return given_.put(grid_, view_of(host));
  }
  std::vector<std::int32_t> labels() {
    std::vector<std::int32_t> result;
    get(labels_, result);
    return result;
  }

  /// Those for blocks, the longest first, so that none of them is begun last; and the large ones.
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

  /// Sums of the impulses at hand, in float64, told to `take(island, sums)`.
  template <class Take>
  void measure(const ContactOptions& options, const Take& take) {
    if (!small_.empty()) {
      std::vector<ContactIsland> islands;
      for (const std::int64_t i : small_) islands.push_back(island(i));
      put(islands, islands_);
      measured_.resize(static_cast<std::int64_t>(islands.size()));
      contact_measure_islands<double>(
          exec_.stream(), {numbers_, state64_.state(), indices_.color_start, switches_of(options),
                           view_of(std::as_const(islands_)), view_of(measured_)});
      std::vector<IslandSums> sums;
      get(measured_, sums);
      for (std::size_t k = 0; k < sums.size(); ++k) {
        take(static_cast<std::size_t>(small_[k]), sums[k]);
      }
    }
    for (const std::int64_t i : large_) {
      take(static_cast<std::size_t>(i),
           measure_island(pipeline_of(options, i, numbers_, state64_)));
    }
  }

  /// @return visits left out
  template <class T>
  std::int64_t solve(const ContactOptions& options,
                     const std::vector<StopCriterion>& criteria,
                     const ContactNumbers<T>& numbers,
                     DeviceState<T>& state,
                     std::vector<IslandOutcome>& outcomes) {
    if (!small_.empty()) solve_small(options, criteria, numbers, state, outcomes);
    for (const std::int64_t i : large_) {
      auto pipeline = pipeline_of(options, i, numbers, state);
      HostEventLog log;
      const auto k = static_cast<std::size_t>(i);
      const IslandEnd end =
          solve_island(pipeline, criteria[k], plan_of(options), 0, state.work(), log);
      outcomes[k].take(end, options.method, island(i).contact_count());
      outcomes[k].events = std::move(log.events);
    }
    std::vector<std::int32_t> visits;
    get(state.skipped_visits, visits);
    return std::accumulate(visits.begin(), visits.end(), std::int64_t{0});
  }

  template <class T>
  void solve_small(const ContactOptions& options,
                   const std::vector<StopCriterion>& criteria,
                   const ContactNumbers<T>& numbers,
                   DeviceState<T>& state,
                   std::vector<IslandOutcome>& outcomes) {
    std::vector<IslandTask> tasks;
    for (const std::int64_t i : small_) {
      tasks.push_back({island(i), criteria[static_cast<std::size_t>(i)]});
    }
    const auto count = static_cast<std::int64_t>(tasks.size());
    put(tasks, tasks_);
    results_.resize(count);
    events_.resize(count * events_per_island);
    contact_solve_islands<T>(
        exec_.stream(), {numbers, state.state(), state.work(), indices_.color_start,
                         switches_of(options), plan_of(options), view_of(std::as_const(tasks_)),
                         shared_values_for<T>(view_of(std::as_const(tasks))), view_of(results_),
                         view_of(events_), events_per_island});

    std::vector<IslandResult> results;
    std::vector<ContactEvent> events;
    get(results_, results);
    get(events_, events);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      IslandOutcome& outcome = outcomes[static_cast<std::size_t>(small_[k])];
      outcome.take(results[k].end, options.method, tasks[k].island.contact_count());
      const auto first = events.begin() + static_cast<std::ptrdiff_t>(k) * events_per_island;
      outcome.events.assign(first, first + results[k].events);
    }
  }

  template <class T>
  ContactPipeline<GridContactExec, T> pipeline_of(const ContactOptions& options,
                                                  std::int64_t i,
                                                  const ContactNumbers<T>& numbers,
                                                  DeviceState<T>& state) {
    return {
        grid_,        numbers, view_of(structure_->color_start), island(i), switches_of(options),
        state.state()};
  }

  const ContactIsland& island(std::int64_t i) const {
    return structure_->islands[static_cast<std::size_t>(i)];
  }

  CudaExec exec_;
  GridContactExec grid_;
  std::string name_;
  const ContactStructure* structure_ = nullptr;
  std::int64_t serial_ = 0;  ///< of the structure whose indices are there
  DeviceArrays arrays_, given_;
  ContactIndices indices_;
  SystemMemory<GridContactExec, double> float64_;
  SystemMemory<GridContactExec, float> float32_;
  ContactNumbers<double> numbers_;
  ContactNumbers<float> rounded_;
  DeviceState<double> state64_;
  DeviceState<float> state32_;
  BlockJacobiMemory<GridContactExec> block_jacobi_memory_;
  DeviceVector<double> guess_;
  DeviceVector<std::int32_t> labels_;
  DeviceVector<double> next_intensity_, next_gap_;
  DeviceVector<std::uint8_t> debonded_;
  std::vector<std::int64_t> small_, large_;
  DeviceVector<ContactIsland> islands_;
  DeviceVector<IslandSums> measured_;
  DeviceVector<IslandTask> tasks_;
  DeviceVector<IslandResult> results_;
  DeviceVector<ContactEvent> events_;
};

}  // namespace tetwarp
