/// @file file_call.hpp
/// Calls of the library that use files.
#pragma once
#include <pthread.h>

#include <mutex>

#include "python/interpreter_lock.hpp"

namespace tetwarp::python {

/// Held by calls that use files.
inline std::mutex& file_mutex() {
  static std::mutex one_at_a_time;
  return one_at_a_time;
}

/// A fork waits for the call that runs, so that its child finds files and the mutex at rest. Calls
/// end without the interpreter's lock, which the forking thread holds, and start programs by
/// posix_spawn(), which calls no such handlers.
inline void make_files_survive_forks() {
  pthread_atfork([] { file_mutex().lock(); }, [] { file_mutex().unlock(); },
                 [] { file_mutex().unlock(); });
}

/// Runs a call without the interpreter's lock, and no two at a time: HDF5 may be built without
/// support for threads.
template <class Call>
auto file_call(const Call& call) {
  const LockReleased release;
  const std::lock_guard lock(file_mutex());
  return call();
}

}  // namespace tetwarp::python
