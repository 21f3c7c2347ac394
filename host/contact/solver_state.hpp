/// @file solver_state.hpp
/// What a ContactSolver keeps between its solves.
#pragma once
#include <chrono>
#include <cstdint>
#include <memory>

#include <tetwarp/contact.hpp>

#include "host/contact/cuda/device.hpp"
#include "host/contact/solve/engine.hpp"

namespace tetwarp {

struct ContactSolver::State {
  ContactOptions options;
  Backend backend;
  int threads;
  std::unique_ptr<ContactDevice> device;  ///< null unless the back end is cuda
  ContactEngine engine;
  std::unique_ptr<ContactProblem> pattern = {};  ///< of set_structure(); null: not called
  std::int64_t pattern_serial = 0;               ///< of the structure made for it

  /// Solves on the host or by the device.
  /// @param found  what the device has found for this problem already; null: nothing
  ContactSolution solve(const ContactProblem& problem, SolveBudget& budget, DeviceRun* found);
  /// Sets what a report says of the solver and of the sizes of a problem.
  void describe(const ContactProblem& problem, ContactReport& report) const;
};

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace tetwarp
