/// @file file_call.hpp
/// Calls of the library that use files.
#pragma once
#include <pthread.h>

#include <mutex>
#include <new>

#include "python/interpreter_lock.hpp"

namespace tetwarp::python {

/// Held by calls that use files.
inline std::mutex& file_mutex() {
  static std::mutex one_at_a_time;
  return one_at_a_time;
}

/// A fork waits for the call that runs, so that its child finds files and the mutex at rest. A call
/// gives the mutex back before it takes the interpreter's lock, so that a forking thread, which
/// holds that lock, can wait for it. Programs are started by posix_spawn(), which runs no such
/// handlers. However often the module is imported, they are registered once.
inline void make_files_survive_forks() {
  static const int error = pthread_atfork(
      [] { file_mutex().lock(); }, [] { file_mutex().unlock(); }, [] { file_mutex().unlock(); });
  if (error != 0) throw std::bad_alloc();
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
