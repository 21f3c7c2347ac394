/// @file engine.hpp
/// The solve of a checked contact problem. Read solve() in engine.cpp first: it makes the
/// structure, solves the islands whose bodies A does not couple, then coupled islands, then bodies
/// without contacts, and repeats this with raised offsets where contacts contradict each other.
#pragma once
#include <optional>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/solve/coupled_islands.hpp"
#include "host/contact/solve/engine_result.hpp"
#include "host/contact/solve/island_solver.hpp"
#include "host/contact/structure/structure.hpp"

namespace tetwarp {

class ContactEngine {
 public:
  /// @param device  solves the islands, kept by the caller; null: the host solves them
  ContactEngine(const ContactOptions& options, int threads, ContactDevice* device);

  /// @param budget  limits of this solve
  /// @param found   what the device has found for this problem with the present structure; taken;
  ///                null: nothing
  /// @pre check_problem(problem) has passed
  /// @throws ContactProblemError  A as a whole is not positive definite
  EngineResult solve(const ContactProblem& problem,
                     SolveBudget& budget,
                     DeviceRun* found = nullptr);

  /// Makes the structure of a problem, unless it is the present one.
  /// @pre check_problem(problem) has passed
  void set_structure(const ContactProblem& problem);
  const ContactStructure& structure() const { return islands_.structure(); }

 private:
  void solve_contactless(const ContactProblem& problem, EngineResult& result);

  ContactOptions options_;
  ContactDevice* device_;
  std::optional<ContactPattern> pattern_;  ///< that of the structure
  IslandSolver islands_;
  CoupledIslands coupled_;
};

}  // namespace tetwarp
