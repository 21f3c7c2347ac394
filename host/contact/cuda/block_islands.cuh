/// @file block_islands.cuh
/// The small islands of a problem on a device, each solved by one block or by one warp.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/contact/sweeps/run.hpp"
#include "kernels/contact/cuda/contact_block.cuh"
#include "kernels/exec/device_limits.cuh"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

class BlockIslands {
 public:
  /// @param exec  kept by the caller
  BlockIslands(CudaExec& exec, const DeviceLimits& limits) : exec_(exec), limits_(limits) {}

  /// Sorts the islands by falling size, so that no long one starts last, and copies their ranges to
  /// the device.
  /// @param numbers  of the islands
  void set(const ContactStructure& structure, std::vector<std::int64_t> numbers) {
    numbers_ = std::move(numbers);
    const auto contacts = [&](std::int64_t i) {
      return structure.islands[index_of(i)].contact_count();
    };
    std::stable_sort(numbers_.begin(), numbers_.end(),
                     [&](std::int64_t a, std::int64_t b) { return contacts(a) > contacts(b); });
    warp_begin_ = std::find_if(numbers_.begin(), numbers_.end(),
                               [&](std::int64_t i) { return contacts(i) <= warp_contacts; }) -
                  numbers_.begin();
    const ContactIndices indices = structure.indices();
    std::vector<ContactIsland> islands;
    host_tasks_.clear();
    for (const std::int64_t i : numbers_) {
      islands.push_back(structure.islands[index_of(i)]);
      host_tasks_.push_back({islands.back(), {}, island_arrays(indices, islands.back())});
    }
    exec_.put(islands, islands_);
  }

  /// Measures the current impulses.
  /// @param job   its islands and sums are set here
  /// @param take  (std::size_t island, const IslandSums&), called once for each island
  template <class Take>
  void measure(MeasureJob<double> job, const Take& take) {
    if (numbers_.empty()) return;
    measured_.resize(count());
    job.islands = view_of(std::as_const(islands_));
    job.sums = view_of(measured_);
    contact_measure_islands(exec_.stream(), job);
    exec_.get(measured_, host_sums_);
    for (std::size_t k = 0; k < host_sums_.size(); ++k) {
      take(index_of(numbers_[k]), host_sums_[k]);
    }
  }

  /// Solves all islands.
  /// @param job       its tasks, results and events are set here
  /// @param outcomes  out, of all islands of the problem
  template <class T>
  void solve(IslandJob<T> job,
             const ContactOptions& options,
             const std::vector<StopCriterion>& criteria,
             std::vector<IslandOutcome>& outcomes) {
    if (numbers_.empty()) return;
    for (std::size_t k = 0; k < host_tasks_.size(); ++k) {
      host_tasks_[k].criterion = criteria[index_of(numbers_[k])];
    }
    exec_.put(host_tasks_, tasks_);
    results_.resize(count());
    events_.resize(count() * events_per_island);
    solve_part<T, island_threads>(job, 0, warp_begin_);
    solve_part<T, 32>(job, warp_begin_, count());

    exec_.get(results_, host_results_);
    exec_.get(events_, host_events_);
    for (std::size_t k = 0; k < host_tasks_.size(); ++k) {
      IslandOutcome& outcome = outcomes[index_of(numbers_[k])];
      outcome.add(host_results_[k].end, options.method, host_tasks_[k].island.contact_count());
      const auto first = host_events_.begin() + static_cast<std::ptrdiff_t>(k) * events_per_island;
      outcome.events.assign(first, first + host_results_[k].events);
    }
  }

 private:
  static constexpr std::int64_t events_per_island = 32;

  std::int64_t count() const { return static_cast<std::int64_t>(numbers_.size()); }

  /// Solves islands first to last - 1 of the sorted ones by `threads` threads each.
  template <class T, int threads>
  void solve_part(IslandJob<T> job, std::int64_t first, std::int64_t last) {
    if (first == last) return;
    const std::int64_t size = last - first;
    // Two blocks of a multiprocessor share its memory, if there are as many.
    const std::int64_t blocks = size * threads / island_threads;
    const std::int64_t most =
        blocks > limits_.multiprocessors ? limits_.shared_bytes / 2 - 1024 : limits_.shared_bytes;
    job.shared_bytes = shared_bytes_for<T, threads>({host_tasks_.data() + first, size},
                                                    job.numbers.is_local, most);
    job.tasks = {view_of(tasks_).data + first, size};
    job.results = {view_of(results_).data + first, size};
    job.events = {view_of(events_).data + first * events_per_island, size * events_per_island};
    job.events_per_island = events_per_island;
    contact_solve_islands<T, threads>(exec_.stream(), job);
  }

  CudaExec& exec_;
  DeviceLimits limits_;
  std::vector<std::int64_t> numbers_;
  std::int64_t warp_begin_ = 0;  ///< the first that is solved by a warp
  std::vector<IslandTask> host_tasks_;
  std::vector<IslandSums> host_sums_;
  std::vector<IslandResult> host_results_;
  std::vector<ContactEvent> host_events_;
  DeviceVector<ContactIsland> islands_;
  DeviceVector<IslandSums> measured_;
  DeviceVector<IslandTask> tasks_;
  DeviceVector<IslandResult> results_;
  DeviceVector<ContactEvent> events_;
};

}  // namespace tetwarp
