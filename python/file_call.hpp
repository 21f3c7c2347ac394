/// @file file_call.hpp
/// Calls of the library that use files.
#pragma once
#include <mutex>

#include "python/interpreter_lock.hpp"

namespace tetwarp::python {

/// Held by calls that use files.
inline std::mutex& file_mutex() {
  static std::mutex one_at_a_time;
  return one_at_a_time;
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
