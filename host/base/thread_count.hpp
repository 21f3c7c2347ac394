/// @file thread_count.hpp
/// Number of host threads that a computation uses.
#pragma once

namespace tetwarp {

/// The largest number of threads; with tens of thousands the OpenMP runtime runs out of memory and
/// ends the process.
constexpr int max_threads = 1024;

/// Number of host threads for an option.
/// @param requested  0: as many as there are cores, at most max_threads
/// @throws std::invalid_argument when it is not from 0 to max_threads
int thread_count(int requested);

}  // namespace tetwarp
