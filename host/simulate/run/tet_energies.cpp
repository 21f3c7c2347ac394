/// @file tet_energies.cpp
/// Elastic energies of tetrahedra, several at a time.
#include "host/simulate/run/tet_energies.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"

namespace tetwarp {

/// Sums of ranges of fixed length, then of the ranges in order.
TetSums tet_energies(const Model& model, const ModelState& state, int threads) {
  constexpr std::int64_t range = 512;
  const ModelTets& tets = model.tets;
  const std::int64_t count = std::ssize(tets.nodes);
  if (count == 0) return {};
  const TetShapes shapes = {{tets.nodes.front().data(), 4 * count},
                            {tets.gradient.front().data(), 9 * count},
                            {tets.volume.data(), count},
                            {tets.lambda.data(), count},
                            {tets.mu.data(), count},
                            {state.position.front().data(), 3 * std::ssize(state.position)}};
  std::vector<TetSums> parts(index_of((count + range - 1) / range));
  parallel_for(threads, std::ssize(parts), [&](std::int64_t p) {
    parts[index_of(p)] =
        vector_stages().tet_energies(shapes, p * range, std::min(p * range + range, count));
  });
  TetSums sum;
  for (const TetSums& part : parts) {
    sum.energy += part.energy;
    sum.inverted += part.inverted;
  }
  return sum;
}

}  // namespace tetwarp
