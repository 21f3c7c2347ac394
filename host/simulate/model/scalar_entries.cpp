/// @file scalar_entries.cpp
/// Sums the entries of equal places and appends them to a model.
#include "host/simulate/model/scalar_entries.hpp"

#include <algorithm>
#include <cstddef>

namespace tetwarp {

void add_scalar_entries(std::vector<ScalarEntry> entries, const Damping& damping, Model& model) {
  std::stable_sort(entries.begin(), entries.end(), [](const ScalarEntry& a, const ScalarEntry& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  });
  ModelScalarBlocks& blocks = model.scalar_blocks;
  for (std::size_t i = 0; i < entries.size();) {
    ScalarEntry sum = entries[i];
    for (++i; i < entries.size() && entries[i].row == sum.row && entries[i].column == sum.column;
         ++i) {
      sum.mass += entries[i].mass;
      sum.bend += entries[i].bend;
    }
    blocks.nodes.push_back({sum.row, sum.column});
    blocks.mass.push_back(sum.mass);
    blocks.mass_alpha.push_back(sum.mass * damping.alpha);
    blocks.bend.push_back(sum.bend);
    blocks.bend_gamma.push_back(sum.bend * damping.gamma);
  }
}

}  // namespace tetwarp
