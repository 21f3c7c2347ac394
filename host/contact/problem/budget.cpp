/// @file budget.cpp
/// Compares what a solve has used with its limits.
#include "host/contact/problem/budget.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <vector>

namespace tetwarp {
namespace {
double bytes_of(const SparseMatrix& matrix) {
  return static_cast<double>(matrix.row_start.size() * sizeof(std::int64_t) +
                             matrix.column.size() * sizeof(matrix.column[0]) +
                             matrix.value.size() * sizeof(double));
}

/// Memory of the arrays of A, J or W and of the vectors.
double bytes_of(const ContactProblem& problem) {
  const std::size_t numbers = problem.load.size() + problem.velocity_offset.size() +
                              problem.free_velocity.size() + problem.friction.size();
  return bytes_of(problem.system) + bytes_of(problem.jacobian) + bytes_of(problem.delassus) +
         static_cast<double>(numbers * sizeof(double));
}

std::string megabytes(double bytes) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(0) << std::ceil(bytes / 1e6) << " MB";
  return text.str();
}
}  // namespace

SolveBudget::SolveBudget(const ContactOptions& options, const ContactProblem& problem)
    : options_(options),
      is_watched_(std::isfinite(options.max_seconds) || options.progress != nullptr),
      memory_limit_(options.max_memory > 0
                        ? static_cast<double>(options.max_memory)
                        : std::max(20 * bytes_of(problem), ContactOptions::least_memory)) {}

double SolveBudget::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

bool SolveBudget::is_over() {
  if (!is_watched_) return false;
  if (stop_ != Stop::none) return true;
  const double now = seconds();
  Stop stop = now >= options_.max_seconds ? Stop::time : Stop::none;
  if (stop == Stop::none && options_.progress && std::this_thread::get_id() == owner_) {
    try {
      if (!options_.progress({now, sweeps_, newton_steps_})) stop = Stop::cancelled;
    } catch (...) {
      error_ = std::current_exception();
      stop = Stop::cancelled;
    }
  }
  if (stop != Stop::none) stop_ = stop;
  return stop != Stop::none;
}

bool SolveBudget::count_sweep() {
  if (!is_watched_) return false;
  ++sweeps_;
  return is_over();
}

void SolveBudget::start_newton() {
  step_start_ = -1;
  longest_step_ = 0;
}

bool SolveBudget::allows_newton_step() {
  if (newton_steps_ >= options_.max_newton) {
    is_out_of_newton_ = true;
    return false;
  }
  if (is_over()) return false;
  if (std::isfinite(options_.max_seconds)) {
    const double now = seconds();
    if (step_start_ >= 0) longest_step_ = std::max(longest_step_, now - step_start_);
    step_start_ = now;
    if (now + longest_step_ > options_.max_seconds) {
      stop_ = Stop::time;
      return false;
    }
  }
  ++newton_steps_;
  return true;
}

bool SolveBudget::allows_memory(double bytes) {
  if (bytes <= memory_limit_) return true;
  refused_memory_ = std::max(refused_memory_, bytes);
  return false;
}

std::string SolveBudget::reason() const {
  if (stop_ == Stop::cancelled) return "cancelled by the progress callback";
  if (stop_ == Stop::time) return "the time limit, max_seconds, was reached";
  if (is_out_of_newton_) return "the limit of Newton steps, max_newton, was reached";
  if (refused_memory_ > 0) {
    return "a factorization of about " + megabytes(refused_memory_) +
           " was left out, the limit, max_memory, is " + megabytes(memory_limit_);
  }
  return {};
}

void SolveBudget::rethrow() const {
  if (error_) std::rethrow_exception(error_);
}

}  // namespace tetwarp
