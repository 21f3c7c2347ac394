/// @file budget.hpp
/// The limits of a solve: time, Newton steps, memory, and cancellation by the caller.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <string>
#include <thread>

#include <tetwarp/contact.hpp>

namespace tetwarp {

/// Thrown and caught inside the solver where a solve ends in the middle of a phase without a
/// result.
struct BudgetOver {};

/// The limits of ContactOptions during one solve. Every phase calls is_over() and stops when it is
/// true. The clock is read only if there is a time limit or a progress callback, so that without
/// them results do not depend on time. The first limit that stops the solve gives the reason.
///
/// Sweeps of several threads may call is_over() and count_sweep() at the same time. Only the thread
/// that made the object calls the callback.
class SolveBudget {
 public:
  /// The limits of `options`, counted from now.
  /// @param problem  its arrays set the default limit of memory
  SolveBudget(const ContactOptions& options, const ContactProblem& problem);

  /// Whether the solve must end. Calls the progress callback; what it throws is kept for rethrow().
  bool is_over();

  /// Counts a sweep of an island. @returns is_over()
  bool count_sweep();

  /// Call before the first of successive Newton steps: their durations are measured from here.
  void start_newton();

  /// Counts a Newton step (one factorization). False if it must not be made: a limit is reached, or
  /// the time left is less than the longest step of this series took.
  bool allows_newton_step();

  /// Whether a factorization may take this much memory; if not, it is noted for the reason.
  /// @param bytes  estimated
  bool allows_memory(double bytes);

  /// Limit of allows_memory() [bytes].
  double memory_limit() const { return memory_limit_; }

  /// What ended the solve or kept a method from running, as a clause; empty: nothing.
  std::string reason() const;

  /// Throws what the progress callback has thrown.
  void rethrow() const;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Stop { none, time, cancelled };

  double seconds() const;

  const ContactOptions& options_;
  Clock::time_point start_ = Clock::now();
  std::thread::id owner_ = std::this_thread::get_id();
  bool is_watched_;  ///< there is a time limit or a callback
  double memory_limit_;
  std::atomic<Stop> stop_ = Stop::none;
  std::atomic<std::int64_t> sweeps_ = 0;
  std::int64_t newton_steps_ = 0;
  double step_start_ = -1;  ///< of the current Newton step [s]; negative: none so far
  double longest_step_ = 0;
  bool is_out_of_newton_ = false;
  double refused_memory_ = 0;  ///< the largest that was refused [bytes]
  std::exception_ptr error_;
};

}  // namespace tetwarp
