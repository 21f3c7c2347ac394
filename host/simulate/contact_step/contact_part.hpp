/// @file contact_part.hpp
/// ContactPart: what contact did in a step or in a part of one.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/simulate.hpp>

namespace tetwarp {

struct ContactPart {
  bool is_completed = true;         ///< false: `progress` ended it
  std::vector<std::int32_t> woken;  ///< sleeping bodies that something moving reaches; if there are
                                    ///< any, no body has moved
  bool converged = true;
  double residual = 0;  ///< eta, the largest
  std::int64_t contacts = 0, islands = 0;
  std::int64_t passes = 0, sweeps = 0, outer_iterations = 0;
  std::int64_t clamped_islands = 0, stalled_scripts = 0;
  double smallest_fraction = 1;  ///< of the step that an island moved
  StepSeconds seconds;
};

/// Adds counts and seconds of a later part; contacts and islands are those of the last part.
void add_part(const ContactPart& part, ContactPart& sum);

}  // namespace tetwarp
