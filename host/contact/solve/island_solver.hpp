/// @file island_solver.hpp
/// The solve of the islands of a contact problem on the host or on a device: sweeps where A couples
/// no bodies, block Jacobi where it does.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/cuda/device.hpp"
#include "host/contact/problem/budget.hpp"
#include "host/contact/solve/engine_result.hpp"
#include "host/contact/solve/feasibility.hpp"
#include "host/contact/solve/island_attempt.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"
#include "host/contact/sweeps/run.hpp"

namespace tetwarp {

template <class Exec>
struct BlockJacobiMemory;

/// What a device has found for a problem whose arrays it has, where an island has not converged.
struct DeviceRun {
  ResidentEnd end;  ///< has run, is not solved
  std::vector<IslandOutcome> outcomes;
};

/// Holds one structure and, on the host, on a device or on both, the numbers of one problem.
class IslandSolver {
 public:
  /// @param device  solves the islands, kept by the caller; null: the host solves them
  IslandSolver(const ContactOptions& options, int threads, ContactDevice* device);

  const ContactStructure& structure() const { return structure_; }
  void set_structure(ContactStructure structure) { structure_ = std::move(structure); }

  /// Limits of the next calls, kept by the caller; null: none.
  void set_budget(SolveBudget* budget) { budget_ = budget; }

  /// Sets the numbers from a problem that has the pattern of the structure.
  /// @param problem  kept by the caller, unchanged, for the calls below
  /// @param found    of the same problem on the device, which is not asked again; taken by
  ///                 solve_uncoupled(); null: none
  /// @return rows and springs that were left out
  ContactSavings set_problem(const ContactProblem& problem, DeviceRun* found = nullptr);

  /// Call before another solver uses the device; the next use copies the problem again.
  void forget_device() { has_device_system_ = false; }

  /// Solves all islands whose blocks A does not couple, by sweeps first; those that these do not
  /// solve by IslandFallback.
  /// @param result  in: make_result()
  void solve_uncoupled(EngineResult& result);

  /// Iterates one island whose blocks A couples.
  /// @param max_iterations  outer iterations at most
  void iterate(std::int64_t island, std::int64_t max_iterations, EngineResult& result);

  /// v without impulses, [dofs] in the order of the structure; of coupled islands not set. Set by
  /// solve_uncoupled().
  const std::vector<double>& free_motion() const { return free_motion_; }

 private:
  ContactSystem<double>& host_system();
  ContactSavings set_device_problem();
  std::vector<double> guess() const;
  HostProblem host_problem() const { return {options_, structure_, *problem_, budget_}; }

  void solve_on_host(EngineResult& result);
  void solve_on_device(EngineResult& result);
  void finish(std::int64_t island, ContactRun<double>& run, EngineResult& result);

  ContactOptions options_;
  int threads_;
  ContactDevice* device_;
  SolveBudget* budget_ = nullptr;
  ContactStructure structure_;
  const ContactProblem* problem_ = nullptr;
  DeviceRun* found_ = nullptr;                ///< see set_problem()
  ContactSystem<double> system_;              ///< kept, so that its memory is reused
  bool has_host_system_ = false;              ///< system_ has the numbers of the problem
  bool has_device_system_ = false;            ///< the device has them
  ContradictionMemory contradiction_memory_;  ///< of the problem
  std::vector<double> free_motion_;
  std::shared_ptr<BlockJacobiMemory<CpuExec>>
      block_jacobi_memory_;  ///< null: no island iterated so far
};

}  // namespace tetwarp
