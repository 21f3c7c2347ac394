/// @file soft_problem.hpp
/// SoftProblem: the islands and contacts that the two-level iteration solves.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/simulate/model/model.hpp"
#include "host/simulate/solve/problem/contact_islands.hpp"
#include "host/simulate/solve/problem/contact_rows.hpp"

namespace tetwarp {

struct SoftProblem {
  const ModelState& state;  ///< at the start of the step
  const ContactIslands& islands;
  std::span<const ContactSides> sides;        ///< of all contacts
  const ContactRows& rows;                    ///< of all contacts; set where the host solves
  const std::vector<std::uint8_t>& takes;     ///< [coupling islands] 1: solved here
  const std::vector<std::int32_t>& contacts;  ///< on these islands; ascending
  const ContactProblem& laws;  ///< friction, offsets, adhesion and guess of these contacts
  /// Change of the velocities by contacts in the step before, [block_count], or empty.
  const std::vector<Point3>& change;
};

}  // namespace tetwarp
