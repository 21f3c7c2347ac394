/// @file feasibility.hpp
/// Finds contacts whose normal offsets no velocity satisfies together, and solves such problems.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/budget.hpp"
#include "host/contact/solve/engine_result.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"
#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/contact_memory.hpp"

namespace tetwarp {

/// How long contradictory contacts are searched for.
struct ContradictionSearch {
  std::int64_t max_sweeps = 4096;  ///< at most
  bool stops_early = false;        ///< ends when no impulse grows as fast as such contacts usually
                                   ///< make it grow
};

/// What a search needs of a problem, kept between the searches on its islands.
struct ContradictionMemory {
  std::optional<ContactSystem<double>>
      bare;  ///< without friction and springs; empty: of no problem
  StateMemory<CpuExec, double> state;
};

/// Slots of an island whose normal offsets contradict each other; empty when none do, and for
/// islands with other blocks of rows than contacts.
///
/// For any y >= 0, every velocity that satisfies all contacts differs from the free one by at least
/// -y.q / sqrt(y.B y) in the energy norm. Where the offsets contradict each other, the impulses of
/// frictionless sweeps grow without bound along a y for which this is infinite; the slots with
/// y > 0 are returned.
/// @param memory  of searches on the same system, or empty
/// @param budget  ends the search; null: no limits
/// @pre A does not couple the blocks of the island
std::vector<std::int64_t> contradicting_slots(const ContactStructure& structure,
                                              const ContactSystem<double>& system,
                                              const ContactIsland& island,
                                              const ContradictionSearch& search,
                                              ContradictionMemory& memory,
                                              SolveBudget* budget = nullptr);

/// Solves a problem; as long as contacts that contradict each other are found, raises their
/// negative normal offsets (local form: free velocities) to 0 and solves again.
/// @param given        the problem
/// @param changed      a changed copy to solve instead, or none
/// @param solve_round  solves one problem and sets EngineResult::clamped to the contacts it found
/// @return the result of the last round, with the contacts found in all rounds
EngineResult solve_feasible(const ContactProblem& given,
                            std::optional<ContactProblem> changed,
                            const std::function<EngineResult(const ContactProblem&)>& solve_round);

}  // namespace tetwarp
