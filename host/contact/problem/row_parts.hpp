/// @file row_parts.hpp
/// Numbers of a problem that BlockProblem needs when it makes blocks and when it takes them apart.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact/problem/vectors.hpp"

namespace tetwarp {

/// An entry of a vector whose emptiness means zeros.
inline double entry_of(const std::vector<double>& values, std::size_t i) {
  return values.empty() ? 0.0 : values[i];
}

/// kappa_t of a contact [kg].
inline double tangent_spring(const AdhesionState& adhesion, std::size_t c) {
  if (adhesion.empty()) return 0;
  const double stiffness = adhesion.tangential_stiffness.empty() ? entry_of(adhesion.stiffness, c)
                                                                 : adhesion.tangential_stiffness[c];
  const double beta = adhesion.intensity[c];
  return adhesion.time_step * adhesion.time_step * entry_of(adhesion.area, c) * stiffness * beta *
         beta;
}

/// First row of each group, then the number of rows.
inline std::vector<std::int32_t> group_starts(const BilateralRows& rows) {
  if (!rows.group_start.empty()) return rows.group_start;
  std::vector<std::int32_t> starts;
  for (std::int64_t row = 0; row <= rows.row_count(); ++row) {
    starts.push_back(static_cast<std::int32_t>(row));
  }
  return starts;
}

}  // namespace tetwarp
