/// @file timing.hpp
/// How a time is taken: several jobs in turn, medians, and no repetition that lost its processors.
#pragma once
#include <functional>
#include <span>
#include <vector>

namespace tetwarp::bench {

/// How often, and what a repetition must be like to count.
struct Protocol {
  int repetitions = 9;
  int attempts = 27;        ///< at most, so that a busy machine ends, too
  double seconds = 10;      ///< after this and `repetitions` attempts no further ones are made
  double busy_threads = 0;  ///< a repetition that used less than 0.9 of so many processors does not
                            ///< count; 0: all count
};

/// Wall times of the repetitions that count [s].
struct Timing {
  double median = 0;
  double low = 0;  ///< lower quartile
  double high = 0;
  double min = 0;
  int kept = 0;
  int discarded = 0;
  double busy = 0;         ///< median of processor time over wall time
  bool contended = false;  ///< too few counted, so all of them are in: not a figure to quote
};

/// Runs the jobs one after the other, again and again, so that all of them meet the same machine.
/// @returns one Timing per job
std::vector<Timing> time_in_turn(std::span<const std::function<void()>> jobs,
                                 const Protocol& protocol);

/// Seconds that a call takes.
double seconds_of(const std::function<void()>& call);

}  // namespace tetwarp::bench
