#include "bench/measure/timing.hpp"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace tetwarp::bench {
namespace {
struct Repetition {
  double wall;
  double busy;  ///< processors used
};

/// Processor time of all threads of this process [s].
double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Repetition repetition_of(const std::function<void()>& job) {
  const double processor_start = processor_seconds();
  const double wall = seconds_of(job);
  return {wall, (processor_seconds() - processor_start) / wall};
}

/// Linear between the two nearest ranks.
double quantile(const std::vector<double>& sorted, double share) {
  const double rank = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (rank - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

bool counts(const Repetition& repetition, const Protocol& protocol) {
  return repetition.busy >= 0.9 * protocol.busy_threads;
}

int count_of(const std::vector<Repetition>& all, const Protocol& protocol) {
  return static_cast<int>(std::count_if(
      all.begin(), all.end(), [&](const Repetition& one) { return counts(one, protocol); }));
}

Timing timing_of(const std::vector<Repetition>& all, const Protocol& protocol) {
  Timing timing;
  timing.kept = count_of(all, protocol);
  timing.discarded = static_cast<int>(all.size()) - timing.kept;
  timing.contended = 2 * timing.kept < protocol.repetitions;
  std::vector<double> walls, busy;
  for (const Repetition& one : all) {
    if (!timing.contended && !counts(one, protocol)) continue;
    walls.push_back(one.wall);
    busy.push_back(one.busy);
    timing.processor = std::min(timing.processor, one.wall * one.busy);
  }
  std::sort(walls.begin(), walls.end());
  std::sort(busy.begin(), busy.end());
  timing.median = quantile(walls, 0.5);
  timing.low = quantile(walls, 0.25);
  timing.high = quantile(walls, 0.75);
  timing.min = walls.front();
  timing.busy = quantile(busy, 0.5);
  return timing;
}
}  // namespace

double seconds_of(const std::function<void()>& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<Timing> time_in_turn(std::span<const std::function<void()>> jobs,
                                 const Protocol& protocol) {
  std::vector<std::vector<Repetition>> repetitions(jobs.size());
  double spent = 0;
  for (int attempt = 1; attempt <= protocol.attempts; ++attempt) {
    bool all_done = true;
    for (std::size_t job = 0; job < jobs.size(); ++job) {
      repetitions[job].push_back(repetition_of(jobs[job]));
      spent += repetitions[job].back().wall;
      all_done = all_done && count_of(repetitions[job], protocol) >= protocol.repetitions;
    }
    if (all_done || (attempt >= protocol.repetitions && spent > protocol.seconds)) break;
  }
  std::vector<Timing> timings;
  timings.reserve(repetitions.size());
  for (const std::vector<Repetition>& all : repetitions) {
    timings.push_back(timing_of(all, protocol));
  }
  return timings;
}

}  // namespace tetwarp::bench
