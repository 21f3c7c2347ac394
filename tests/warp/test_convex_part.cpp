/// @file test_convex_part.cpp
/// Voxels cut by planes: the volumes of both sides add up to the whole, also where planes and faces
/// coincide.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kernels/warp/overlap/convex_part.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using Plane = std::array<double, 4>;

/// Numbers in [-1, 1), one after the other.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : seed_(seed) {}
  double next() { return 2 * scenes::uniform(seed_, at_++) - 1; }
  Plane plane() { return {next(), next(), next(), 0.3 * next()}; }

 private:
  std::uint64_t seed_;
  std::uint64_t at_ = 0;
};

/// The plane with other last bits, as another formula may compute it.
Plane nearly(const Plane& plane, double scale, Numbers& numbers) {
  Plane result;
  for (std::size_t n = 0; n < 4; ++n) {
    result[n] = scale * plane[n] * (1 + 1e-16 * numbers.next()) + 1e-16 * numbers.next();
  }
  return result;
}

double volume_beyond(const ConvexPart& part, const Plane& plane, double sign, ConvexPart& to) {
  const double normal[3] = {sign * plane[0], sign * plane[1], sign * plane[2]};
  return clip_part(part, normal, sign * plane[3], to) ? volume_of(to) : 0;
}

/// Up to ten cuts, as many as the raster makes; half of them near faces that are there already.
TEST(ConvexPart, CutsAddUpAndFit) {
  Numbers numbers(5);
  double worst = 0;
  int corners = 0, edges = 0;
  for (int round = 0; round < 20000; ++round) {
    ConvexPart part, above, below;
    set_box_part(part);
    EXPECT_EQ(volume_of(part), 1);
    std::vector<Plane> used = {{1, 0, 0, 0.5}, {0, -1, 0, 0.5}, {0, 0, 1, 0.5}};
    while (part.face_count < max_faces) {
      const double pick = numbers.next();
      const auto old = static_cast<std::size_t>(std::abs(pick) * static_cast<double>(used.size()));
      used.push_back(pick < 0 ? numbers.plane()
                              : nearly(used[old], pick < 0.5 ? 1.5 : -0.7, numbers));
      const double whole = volume_of(part);
      const double up = volume_beyond(part, used.back(), 1, above);
      const double down = volume_beyond(part, used.back(), -1, below);
      worst = std::max(worst, std::abs(whole - up - down));
      if (std::max(up, down) < 1e-12) break;
      part = up > down ? above : below;
      corners = std::max(corners, part.corner_count);
      edges = std::max(edges, part.edge_count);
    }
  }
  EXPECT_LE(worst, 2e-15);
  EXPECT_LE(corners, 28);
  EXPECT_LE(edges, 84);
  EXPECT_GE(corners, 24);
}
}  // namespace
}  // namespace tetwarp::test
