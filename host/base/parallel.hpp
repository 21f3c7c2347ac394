/// @file parallel.hpp
/// Loops on several host threads. The threads belong to the process, are started when first needed
/// and sleep while there is no loop.
#pragma once
#include <algorithm>
#include <cstdint>

#include <tetwarp/export.hpp>

namespace tetwarp {

/// Most threads that a loop uses.
inline constexpr int max_threads = 1024;

/// Number of threads for an option.
/// @param requested  0: one per processor that this process may use, at most max_threads
/// @throws std::invalid_argument  it is not from 0 to max_threads
TETWARP_EXPORT int thread_count(int requested);

/// Calls call(context, i) once for every i in [0, count). Internal to parallel_tasks().
void run_parallel_tasks(int threads,
                        std::int64_t count,
                        const void* context,
                        void (*call)(const void* context, std::int64_t i));

/// task(i) once for every i in [0, count), in any order, on at most `threads` threads, the calling
/// one included. It returns when all tasks are done. The calling thread also takes the tasks that
/// no other thread has started, so a processor that is busy with other programs delays it by one
/// task at most. Calls from within a task run on the thread of that task alone.
/// @throws what a task throws; of several the one with the smallest i, in every run. Tasks that
/// have not begun when one throws may be left out.
template <class Task>
void parallel_tasks(int threads, std::int64_t count, const Task& task) {
  if (threads <= 1 || count <= 1) {
    for (std::int64_t i = 0; i < count; ++i) task(i);
    return;
  }
  run_parallel_tasks(threads, count, &task, [](const void* context, std::int64_t i) {
    (*static_cast<const Task*>(context))(i);
  });
}

/// Threads for a loop over `count` indices of about a tenth of a microsecond each: fewer indices
/// than this per thread are not worth its start.
inline int threads_for(int threads, std::int64_t count) {
  constexpr std::int64_t per_thread = 256;
  return static_cast<int>(std::min<std::int64_t>(threads, 1 + count / per_thread));
}

/// op(i) once for every i in [0, count), as parallel_tasks(), in contiguous ranges: four per
/// thread, so that threads which start late take fewer.
/// @param op  copied, so that the compiler can keep its members in registers
template <class Op>
void parallel_for(int threads, std::int64_t count, const Op& op) {
  const auto run = [](const Op own, std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) own(i);
  };
  if (threads <= 1) return run(op, 0, count);
  const std::int64_t ranges = std::min<std::int64_t>(count, 4 * threads);
  parallel_tasks(threads, ranges, [&](std::int64_t range) {
    run(op, count * range / ranges, count * (range + 1) / ranges);
  });
}

}  // namespace tetwarp
