/// @file interruption.hpp
/// Long calls of the library: without the lock of the interpreter, ended by Ctrl-C or by a callback
/// of the caller, one at a time for each object.
#pragma once
#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <utility>

#include "python/interpreter_lock.hpp"

namespace tetwarp::python {

namespace nb = nanobind;

/// Decides within a call whether it goes on. Made and destroyed with the interpreter's lock.
class Interruption {
 public:
  /// @param progress  called with what go_on() gets; only False, also that of NumPy, ends the call.
  ///                  None: no callback
  explicit Interruption(nb::object progress) : progress_(std::move(progress)) {}

  /// Called by the library, without the lock. False: the caller pressed Ctrl-C, or the callback
  /// returned False or raised. Signals are looked at every 20 ms.
  template <class... Values>
  bool go_on(const Values&... values) {
    const auto now = std::chrono::steady_clock::now();
    if (progress_.is_none() && now < next_) return true;
    next_ = now + std::chrono::milliseconds(20);
    const LockHeld lock;
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (progress_.is_none()) return true;
      const nb::object answer = progress_(values...);
      return answer.is_none() || answer.is(Py_True) || !is_false(answer);
    } catch (const nb::python_error&) {
      error_ = std::current_exception();
      return false;
    }
  }

  /// Runs a call of the library without the lock. @throws what Python raised within it, or what the
  /// call throws
  template <class Call>
  auto run(const Call& call) {
    try {
      const LockReleased release;
      return call();
    } catch (...) {
      throw_error();
      throw;
    }
  }
  /// Throws what Python raised in go_on(), if anything.
  void throw_error() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  static bool is_false(const nb::object& answer) {
    const auto is_numpys = [&] {
      return nb::isinstance(answer, nb::module_::import_("numpy").attr("bool_"));
    };
    return answer.is(Py_False) || (is_numpys() && !nb::bool_(answer));
  }

  nb::object progress_;
  std::chrono::steady_clock::time_point next_ =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(20);
  std::exception_ptr error_;
};

/// Marks an object as busy during a call. Threads of Python and progress callbacks could call it
/// again meanwhile, which the objects of the library do not allow.
class OneCall {
 public:
  /// @throws std::runtime_error  a call of this object is running
  OneCall(std::atomic<bool>& is_running, const char* object);
  ~OneCall() { is_running_ = false; }
  OneCall(const OneCall&) = delete;
  OneCall& operator=(const OneCall&) = delete;

 private:
  std::atomic<bool>& is_running_;
};

}  // namespace tetwarp::python
