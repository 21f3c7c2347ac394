/// @file race_reports.hpp
/// Races that the thread sanitizer has found, counted. For programs compiled with it.
#pragma once
#include <utility>

#include "tests/emulator/race_order.hpp"

namespace tetwarp::test {

inline int race_count = 0;

/// Races since the last time this was called.
inline int take_races() {
  return std::exchange(race_count, 0);
}

}  // namespace tetwarp::test

extern "C" {
/// Called by the sanitizer for each race. One is enough where a barrier is taken to order nothing.
__attribute__((visibility("default"), no_sanitize("thread"))) void __tsan_on_report(void*) {
  ++tetwarp::test::race_count;
  tetwarp::simt::barrier_lines().without_order = 0;
}
/// Tests take what they expect, and the listener of the program refuses the rest. Lines of the
/// source are printed with TSAN_OPTIONS=symbolize=1, which takes long.
__attribute__((visibility("default"), no_sanitize("thread"))) const char* __tsan_default_options() {
  return "exitcode=0:symbolize=0:suppress_equal_stacks=0:suppress_equal_addresses=0:history_size=4";
}
}
