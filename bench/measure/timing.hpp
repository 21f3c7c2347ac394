/// @file timing.hpp
/// Medians of jobs timed in turn; repetitions that had too little processor time do not count.
#pragma once
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace tetwarp::bench {

/// How often a job is repeated, and which repetitions count.
struct Protocol {
  int repetitions = 9;
  int attempts = 27;        ///< upper limit, also reached on a busy machine
  double seconds = 10;      ///< no attempts beyond `repetitions` once this time is spent
  double busy_threads = 0;  ///< a repetition that used less than 0.9 times this many processors
                            ///< does not count; 0: all count
};

/// Wall times of the repetitions that count [s].
struct Timing {
  double median = 0;
  double low = 0;  ///< lower quartile
  double high = 0;
  double min = 0;
  int kept = 0;
  int discarded = 0;
  double busy = 0;  ///< median of processor time over wall time
  double processor = std::numeric_limits<double>::infinity();  ///< least time of a repetition, of
                                                               ///< all processors together [s]
  bool contended = false;  ///< fewer than half of `repetitions` counted, so all of them are used
};

/// Runs the jobs one after the other in rounds, so that changes of the machine affect all of them.
/// @returns one Timing per job
std::vector<Timing> time_in_turn(std::span<const std::function<void()>> jobs,
                                 const Protocol& protocol);

/// Seconds that a call takes.
double seconds_of(const std::function<void()>& call);

}  // namespace tetwarp::bench
