/// @file interpreter_lock.hpp
/// The interpreter's lock, given back and taken again. Python ends a daemon thread that takes it
/// while the program ends by pthread_exit(), which unwinds the stack: through C++ functions that
/// would abort the program. Such a thread stands still instead, as from Python 3.14 on.
#pragma once
#include <nanobind/nanobind.h>
#include <unistd.h>

namespace tetwarp::python {

/// Takes the lock by a call of Python, or never returns.
template <class Take>
auto take_lock(const Take& take) {
  try {
    return take();
  } catch (...) {  // pthread_exit(); these calls throw nothing else
    while (true) pause();
  }
}

/// The thread does without the lock as long as this exists.
class LockReleased {
 public:
  LockReleased() : state_(PyEval_SaveThread()) {}
  ~LockReleased() {
    take_lock([&] { PyEval_RestoreThread(state_); });
  }
  LockReleased(const LockReleased&) = delete;
  LockReleased& operator=(const LockReleased&) = delete;

 private:
  PyThreadState* state_;
};

/// The thread has the lock as long as this exists.
class LockHeld {
 public:
  LockHeld() : state_(take_lock(&PyGILState_Ensure)) {}
  ~LockHeld() { PyGILState_Release(state_); }
  LockHeld(const LockHeld&) = delete;
  LockHeld& operator=(const LockHeld&) = delete;

 private:
  PyGILState_STATE state_;
};

}  // namespace tetwarp::python
