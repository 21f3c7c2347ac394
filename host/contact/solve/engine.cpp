/// @file engine.cpp
/// The order in which the islands of a problem are solved.
#include "host/contact/solve/engine.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "host/contact/problem/row_blocks.hpp"
#include "host/contact/solve/condense.hpp"
#include "host/contact/solve/feasibility.hpp"
#include "host/contact/structure/extract.hpp"

namespace tetwarp {
namespace {
using Clock = std::chrono::steady_clock;

/// Whether the normal offset of any contact is below -speed.
bool exceeds(const ContactProblem& problem, double speed) {
  for (std::size_t row = 0; row < problem.velocity_offset.size(); row += 3) {
    if (problem.velocity_offset[row] < -speed && is_contact_block(problem, row / 3)) return true;
  }
  return false;
}

/// The problem with normal offsets of at least -speed.
ContactProblem with_recovery_speed(ContactProblem problem, double speed) {
  for (std::size_t row = 0; row < problem.velocity_offset.size(); row += 3) {
    if (!is_contact_block(problem, row / 3)) continue;
    problem.velocity_offset[row] = std::max(problem.velocity_offset[row], -speed);
  }
  return problem;
}
}  // namespace

ContactEngine::ContactEngine(const ContactOptions& options, int threads, ContactDevice* device)
    : options_(options),
      device_(device),
      islands_(options, threads, device),
      coupled_(options, threads, device) {}

EngineResult ContactEngine::solve(const ContactProblem& given,
                                  SolveBudget& budget,
                                  DeviceRun* found) {
  const auto start = Clock::now();
  islands_.set_budget(&budget);
  std::optional<ContactProblem> changed;
  if (exceeds(given, options_.recovery_speed)) {
    changed = with_recovery_speed(given, options_.recovery_speed);
  }
  return solve_feasible(given, std::move(changed), [&](const ContactProblem& problem) {
    budget.is_over();
    set_structure(problem);
    budget.is_over();
    coupled_.begin(problem, islands_.structure());
    EngineResult result = make_result(problem, islands_.structure());
    result.savings = islands_.set_problem(problem, std::exchange(found, nullptr));
    result.setup_seconds = std::chrono::duration<double>(Clock::now() - start).count();
    islands_.solve_uncoupled(result);
    coupled_.solve(problem, islands_, budget, result);
    solve_contactless(problem, result);
    return result;
  });
}

void ContactEngine::set_structure(const ContactProblem& problem) {
  if (pattern_ && has_pattern(problem, *pattern_)) return;
  islands_.set_structure(device_ != nullptr
                             ? make_structure(problem, options_.expert.skip, *device_)
                             : make_structure(problem, options_.expert.skip));
  pattern_ = pattern_of(problem);
  coupled_.clear();
}

void ContactEngine::solve_contactless(const ContactProblem& problem, EngineResult& result) {
  const ContactStructure& structure = islands_.structure();
  for (std::size_t i = index_of(structure.contact_islands); i < structure.islands.size(); ++i) {
    const ContactIsland& island = structure.islands[i];
    result.bodies_skipped += island.block_end - island.block_begin;
    if (!island.is_coupled) {
      scatter_velocities(structure, island, islands_.free_motion().data() + island.dof_begin,
                         result.body_velocity);
      continue;
    }
    const CondensedProblem condensed(make_island_problem(problem, structure, island));
    scatter_velocities(structure, island, condensed.body_velocity({}).data(), result.body_velocity);
  }
}

}  // namespace tetwarp
