/// @file engine_result.hpp
/// What the solve of a whole contact problem returns.
#pragma once
#include <cstdint>
#include <vector>

#include "host/contact/sweeps/run.hpp"
#include "kernels/contact/contact_fill.hpp"

namespace tetwarp {

/// Arrays are in the order of the problem.
struct EngineResult {
  std::vector<double> impulse;          ///< [3 contacts]
  std::vector<double> body_velocity;    ///< [dofs]; empty in local form
  std::vector<IslandOutcome> outcomes;  ///< of the islands that have contacts
  ContactSavings savings;               ///< rows and springs that were left out
  std::int64_t colors = 0;              ///< of the island with the most
  std::int64_t updates_skipped = 0;     ///< as in ContactReport, like the next two
  std::int64_t bodies_skipped = 0;
  std::int64_t condensations_kept = 0;
  std::vector<std::int32_t> clamped;    ///< contacts whose normal offsets were raised to 0, because
                                        ///< no velocity satisfies them together
  double clamped_speed = 0;             ///< at which the clamped contacts approach each other, by a
                                        ///< certificate [m/s]; 0: found without one
  std::vector<std::int32_t> unbounded;  ///< contacts of an ImpulseDirection with friction
  double unbounded_speed = 0;           ///< of that direction [m/s]
  double setup_seconds = 0;
};

/// Zero impulses and velocities, and room for the outcomes.
inline EngineResult make_result(const ContactProblem& problem, const ContactStructure& structure) {
  EngineResult result;
  result.impulse.assign(3 * problem.friction.size(), 0.0);
  result.body_velocity.assign(index_of(problem.dof_count()), 0.0);
  result.outcomes.resize(index_of(structure.contact_islands));
  return result;
}

}  // namespace tetwarp
