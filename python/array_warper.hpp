/// @file array_warper.hpp
/// A Warper of the library on arrays of Python, which it keeps as long as it reads or writes them.
#pragma once
#include <nanobind/nanobind.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <exception>
#include <optional>
#include <string>
#include <tetwarp/warp.hpp>
#include <utility>
#include <vector>

#include "python/arrays.hpp"

namespace tetwarp::python {

/// What a step reads and writes; a copy refers to the same arrays.
struct StepArrays {
  AnyPoints deformed;
  std::vector<AnyOut> volumes;  ///< one per source
  nb::dict extras;              ///< further outputs by name
  std::uintptr_t stream = 0;    ///< of CUDA; 0: none

  /// @returns what refers to `samples`, which are filled with the addresses of the volumes
  WarpTarget target(std::vector<void*>& samples) const;
  PositionsView positions() const;
};

/// One call at a time; each begins and ends with the interpreter's lock, which it gives back while
/// the library computes.
class ArrayWarper {
 public:
  ArrayWarper(std::vector<AnySamples> sources,
              const Grid& grid,
              const CurvedMesh& mesh,
              const WarpOptions& options);

  /// @throws std::invalid_argument  an output shares memory with what the step reads or another
  ///                                output
  /// @throws std::runtime_error     a call is running, or a step is in flight
  StepReport step(const StepArrays& arrays, nb::object progress);

  /// Begins a step, which a call that throws does not.
  /// @param given  what finish_step() returns with the report
  /// @throws as step(), but two steps may be in flight; what the callback raised, Cancelled
  void begin_step(StepArrays arrays, nb::object given, nb::object progress);

  /// Ends the oldest step in flight.
  /// @throws std::runtime_error  there is none; or the error of the step, which is then over
  std::pair<nb::object, StepReport> finish_step();

  std::size_t steps_in_flight() const { return flights_.size(); }

  /// What all steps share, with the records of the last steps.
  /// @throws std::runtime_error  a call is running
  std::string report();

  /// @pre no step is running
  const Report& shared() const { return warper_.report(); }

 private:
  struct Flight {
    StepArrays arrays;
    nb::object given;
    std::optional<StepReport> report = {};  ///< once the library has finished the step
    std::exception_ptr error = {};
  };

  Warper make_warper(const Grid& grid, const CurvedMesh& mesh, const WarpOptions& options) const;
  void check_arrays(const StepArrays& arrays) const;
  void settle(Flight& flight);

  std::vector<AnySamples> sources_;
  std::deque<Flight> flights_;  ///< oldest first
  Warper warper_;               ///< destroyed before the arrays that its steps write to
  std::atomic<bool> is_running_ = false;
};

}  // namespace tetwarp::python
