/// @file race_order.hpp
/// What orders the accesses of emulated threads to memory, told to the thread sanitizer, which then
/// reports every race that a run contains, whatever the order of threads was. Without that
/// sanitizer nothing here does anything.
#pragma once
#include <set>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>

extern "C" {
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
void AnnotateIgnoreWritesBegin(const char* file, int line);
void AnnotateIgnoreWritesEnd(const char* file, int line);
}
#endif

namespace tetwarp::simt {

#if defined(__SANITIZE_THREAD__)
constexpr bool has_thread_sanitizer = true;

/// A thread as the sanitizer knows it. One that runs on the stack of another is switched to.
class RaceThread {
 public:
  RaceThread() : fiber_(__tsan_create_fiber(0)) {}
  RaceThread(const RaceThread&) = delete;
  RaceThread& operator=(const RaceThread&) = delete;
  ~RaceThread() { __tsan_destroy_fiber(fiber_); }

  /// From now on this thread runs. @returns the one that ran before
  void* take_over() const {
    void* const before = __tsan_get_current_fiber();
    give_back(fiber_);
    return before;
  }
  static void give_back(void* before) {
    __tsan_switch_to_fiber(before, __tsan_switch_to_fiber_no_sync);
  }
  /// What this thread has done is before what follows an acquire() at the same address.
  void release(void* at) const {
    void* const before = take_over();
    __tsan_release(at);
    give_back(before);
  }
  void acquire(void* at) const {
    void* const before = take_over();
    __tsan_acquire(at);
    give_back(before);
  }
  /// The same for the running thread.
  static void release_own(void* at) { __tsan_release(at); }
  static void acquire_own(void* at) { __tsan_acquire(at); }

 private:
  void* fiber_;
};

/// During its life the sanitizer ignores accesses of the running thread: those of the emulation.
class IgnoredAccesses {
 public:
  IgnoredAccesses() {
    AnnotateIgnoreReadsBegin(__FILE__, __LINE__);
    AnnotateIgnoreWritesBegin(__FILE__, __LINE__);
  }
  IgnoredAccesses(const IgnoredAccesses&) = delete;
  IgnoredAccesses& operator=(const IgnoredAccesses&) = delete;
  ~IgnoredAccesses() {
    AnnotateIgnoreWritesEnd(__FILE__, __LINE__);
    AnnotateIgnoreReadsEnd(__FILE__, __LINE__);
  }
};
#else
constexpr bool has_thread_sanitizer = false;

class RaceThread {
 public:
  void* take_over() const { return nullptr; }
  static void give_back(void*) {}
  void release(void*) const {}
  void acquire(void*) const {}
  static void release_own(void*) {}
  static void acquire_own(void*) {}
};
class IgnoredAccesses {
 public:
  IgnoredAccesses() {}
};
#endif

/// Source lines of barriers that ordered accesses, and the one that is taken not to do so: with it
/// a test shows that a barrier is needed.
struct BarrierLines {
  std::set<int> seen;
  int without_order = 0;

  /// @returns whether a barrier in this line orders accesses
  bool note(int line) {
    if (has_thread_sanitizer) seen.insert(line);
    return line != without_order;
  }
};
inline BarrierLines own_barrier_lines;
inline BarrierLines& barrier_lines() {
  return own_barrier_lines;
}

}  // namespace tetwarp::simt
