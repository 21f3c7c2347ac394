/// @file touching_sweep.cpp
/// Divides a list of contacts into groups and sweeps these.
#include "host/simulate/solve/two_level/touching_sweep.hpp"

#include <algorithm>
#include <functional>
#include <span>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"

namespace tetwarp {
namespace {

// Passes in a sweep over a group of a few contacts among others: bonds make impulses within a group
// converge slowly. Passes over one group alone are sweeps without acceleration, and those over
// many contacts take longer than they save.
constexpr int group_passes = 3;
constexpr std::size_t most_of_passes = 64;  // contacts
// Multiplications from which two threads are faster than one.
constexpr std::int64_t parallel_from = 2'000;

}  // namespace

void TouchingSweep::set(const ElasticSpace& elastic) {
  groups_.set(elastic, blocks_.block_start(), blocks_.row());
  packed_.clear();
  operations_ = 0;
}

void TouchingSweep::begin(std::vector<std::int32_t>& working) {
  const std::vector<std::int32_t>& changed = groups_.group(working, threads_);
  for (const std::int32_t group : changed) {
    for (const std::int32_t contact : groups_.contacts(group)) packed_.forget_group_of(contact);
  }
  matrices_.make(changed, threads_);
}

/// @param contacts  of the group in the list
/// @param all       contacts of the list
int TouchingSweep::passes_over(std::int32_t group, std::size_t contacts, std::size_t all) const {
  const bool is_small = groups_.contacts(group).size() <= most_of_passes;
  return groups_.size(group) > 0 && is_small && contacts != all ? group_passes : 1;
}

/// Sweeps one or two groups that have matrices.
/// @param first  in ranges_
void TouchingSweep::run_pair(std::size_t first,
                             const std::vector<std::int32_t>& list,
                             double* y,
                             double* impulse) {
  const std::span<const MatrixRange> pair(ranges_.data() + first,
                                          std::min(ranges_.size() - first, std::size_t{2}));
  const int threads = pair.back().operations < parallel_from ? 1 : threads_;
  parallel_tasks(threads, static_cast<std::int64_t>(pair.size()), [&](std::int64_t m) {
    matrices_.sweep(switches_, pair[index_of(m)].range, list, y, impulse);
  });
  const std::array<std::int32_t, 2> groups{pair.front().range.group, pair.back().range.group};
  for (const MatrixRange& own : pair) operations_ += own.operations;
  operations_ += groups_.finish({groups.data(), pair.size()}, y, threads);
}

void TouchingSweep::run(const std::vector<std::int32_t>& list, double* y, double* impulse) {
  ranges_.clear();
  for (std::size_t begin = 0, end = 0; begin < list.size(); begin = end) {
    const std::int32_t group = group_of(list[begin]);
    while (end < list.size() && group_of(list[end]) == group) ++end;
    const GroupRange range{group, begin, end, passes_over(group, end - begin, list.size())};
    if (matrices_.has(group)) {
      ranges_.push_back({range, matrices_.operations(range)});
    } else {
      operations_ += packed_.sweep(switches_, range, list, y, impulse);
    }
  }
  // Side by side what takes about as long.
  std::ranges::stable_sort(ranges_, std::ranges::greater{}, &MatrixRange::operations);
  for (std::size_t k = 0; k < ranges_.size(); k += 2) run_pair(k, list, y, impulse);
}

void TouchingSweep::list_moved(const std::vector<std::int32_t>& list,
                               std::vector<std::int64_t>& places) {
  moved_.clear();
  for (const std::int32_t contact : list) {
    blocks_.for_blocks(index_of(contact), [this](std::size_t b) {
      if (!blocks_.is_elastic(b)) moved_.push_back({blocks_.place(b), 3});
    });
    groups_.list_ranges(groups_.of_contact(index_of(contact)), moved_);
  }
  std::sort(moved_.begin(), moved_.end());
  moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
  places.clear();
  for (const auto& [first, size] : moved_) {
    for (std::int64_t k = 0; k < size; ++k) places.push_back(first + k);
  }
}

}  // namespace tetwarp
