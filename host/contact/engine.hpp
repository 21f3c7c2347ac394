/// @file engine.hpp
/// From a checked problem to impulses and velocities: structure, islands, methods, fallbacks.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/cuda/device.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"
#include "host/contact/sweeps/run.hpp"

namespace tetwarp {

/// What comes out of an engine, in the order of the problem.
struct EngineResult {
  std::vector<double> impulse;        ///< [3 contacts]
  std::vector<double> body_velocity;  ///< [dofs]; empty in local form
  std::vector<IslandOutcome> outcomes;
  ContactSavings savings;
  std::int64_t colors = 0;
  std::int64_t updates_skipped = 0;
  std::int64_t bodies_skipped = 0;
  std::int64_t condensations_kept = 0;
  std::vector<std::int32_t> clamped;  ///< contacts whose offsets no velocity could meet
  double setup_seconds = 0;
};

struct Condensation;
template <class Exec>
struct BlockJacobiMemory;

/// What a series of problems with the same A and J has of its coupled islands.
struct KeptSystem {
  /// Of one island.
  struct Island {
    std::shared_ptr<Condensation> condensation;  ///< null: none
    std::int64_t outer_iterations = 0;           ///< so far
  };

  std::vector<double> system, jacobian;  ///< stored numbers of A and J
  std::vector<Island> islands;
};

class ContactEngine {
 public:
  /// @param device  solves the islands, kept by the caller; null: the host does
  ContactEngine(const ContactOptions& options, int threads, ContactDevice* device = nullptr);

  /// @pre check_problem(problem) has passed
  /// @throws ContactProblemError  A as a whole is not positive definite
  EngineResult solve(const ContactProblem& problem);

 private:
  void prepare(const ContactProblem& problem, EngineResult& result);
  ContactSystem<double>& host_system(const ContactProblem& problem);
  void take_to_device(const ContactProblem& problem, EngineResult& result);
  void forget_unless_same(const ContactProblem& problem);

  void solve_uncoupled(const ContactProblem& problem, EngineResult& result);
  void solve_on_host(const ContactProblem& problem, EngineResult& result);
  void solve_on_device(const ContactProblem& problem, EngineResult& result);
  void take_from_run(const ContactProblem& problem,
                     std::int64_t island,
                     ContactRun<double>& run,
                     EngineResult& result);
  void fall_back(const ContactProblem& problem,
                 std::int64_t island,
                 ContactRun<double>& run,
                 EngineResult& result);
  void polish(const ContactProblem& problem,
              std::int64_t island,
              ContactRun<double>& run,
              IslandOutcome& outcome);

  void solve_coupled(const ContactProblem& problem, EngineResult& result);
  void iterate(const ContactProblem& problem,
               std::int64_t island,
               std::int64_t max_iterations,
               EngineResult& result);
  void condense(const ContactProblem& problem, std::int64_t island, EngineResult& result);

  void solve_contactless(const ContactProblem& problem, EngineResult& result);
  std::vector<double> guess_of(const ContactProblem& problem) const;

  ContactOptions options_;
  int threads_;
  ContactDevice* device_;
  std::optional<ContactPattern> pattern_;
  ContactStructure structure_;
  ContactSystem<double> system_;     ///< kept for its memory
  bool has_host_system_ = false;     ///< it is that of the problem at hand
  bool has_device_system_ = false;   ///< the device has that
  std::vector<double> free_motion_;  ///< v without contacts, [dofs]; of coupled islands not set
  std::shared_ptr<BlockJacobiMemory<CpuContactExec>>
      block_jacobi_memory_;  ///< null: not needed so far
  KeptSystem kept_;
};

}  // namespace tetwarp
