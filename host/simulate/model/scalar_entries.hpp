/// @file scalar_entries.hpp
/// Constant multiples of the identity in A, before they are sorted and summed.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// One entry of the constant scalar blocks.
struct ScalarEntry {
  std::int32_t row = 0, column = 0;
  double mass = 0, bend = 0;
};

/// Sums entries of equal row and column, in their order, and appends them sorted.
void add_scalar_entries(std::vector<ScalarEntry> entries, const Damping& damping, Model& model);

}  // namespace tetwarp
