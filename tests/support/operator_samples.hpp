/// @file operator_samples.hpp
/// Samples that operators of warps take and give.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <tetwarp/warp_operator.hpp>
#include <vector>

#include "tests/support/scenes.hpp"

namespace tetwarp::test {

using Samples = std::vector<double>;

inline Samples random_samples(const Grid& grid, std::uint64_t seed, std::int64_t components = 1) {
  Samples samples(static_cast<std::size_t>(grid.voxel_count() * components));
  for (std::size_t s = 0; s < samples.size(); ++s) samples[s] = scenes::uniform(seed, s) - 0.5;
  return samples;
}

inline double dot_of(const Samples& a, const Samples& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

inline double length_of(const Samples& a) {
  return std::sqrt(dot_of(a, a));
}

inline Samples forward_of(const WarpOperator& warp, const Samples& x) {
  const auto components = std::ssize(x) / warp.source_grid().voxel_count();
  Samples y(static_cast<std::size_t>(warp.output_grid().voxel_count() * components), NAN);
  warp.forward(x, y);
  return y;
}

inline Samples adjoint_of(const WarpOperator& warp, const Samples& y) {
  const auto components = std::ssize(y) / warp.output_grid().voxel_count();
  Samples x(static_cast<std::size_t>(warp.source_grid().voxel_count() * components), NAN);
  warp.adjoint(y, x);
  return x;
}

}  // namespace tetwarp::test
