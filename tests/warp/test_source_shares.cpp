/// @file test_source_shares.cpp
/// Squares cut by lines, and volumes of parts of voxels in source voxels, from their faces: those
/// of bodies cut by the voxels' planes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "kernels/warp/overlap/voxel_part.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using Voxel = std::tuple<int, int, int>;
using Shares = std::map<Voxel, double>;

/// Numbers in [-1, 1), one after the other.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : seed_(seed) {}
  double next() { return 2 * scenes::uniform(seed_, at_++) - 1; }

 private:
  std::uint64_t seed_;
  std::uint64_t at_ = 0;
};

/// A voxel's box, a map to the source, and the first `planes` planes of a tetrahedron.
struct Case {
  TetSetup tet = {};
  double height[4] = {};  ///< of the voxel's center over the planes
  int planes = 0;
  SourceMap<double> map = {};

  void add_plane(double x, double y, double z, double offset) {
    tet.plane[0][planes] = x;
    tet.plane[1][planes] = y;
    tet.plane[2][planes] = z;
    height[planes++] = offset;
  }
};

/// Volumes in the source by SourceShares, in as many blocks as the body needs.
Shares shares_of(const Case& input) {
  const VoxelPart part({input.tet, input.height, input.map, map_volume(input.map) < 0 ? -1.0 : 1.0,
                        cuts_of(input.tet, input.height)});
  const VoxelRange& range = part.range();
  Shares found;
  if (part.count() == 0) return found;
  SourceShares shares;
  constexpr int edge = SourceShares::edge;
  for (int k = range.first[2]; k <= range.last[2]; k += edge) {
    for (int j = range.first[1]; j <= range.last[1]; j += edge) {
      for (int i = range.first[0]; i <= range.last[0]; i += edge) {
        const int block[3] = {i, j, k};
        int size[3];
        for (int axis = 0; axis < 3; ++axis) {
          size[axis] = min_of(range.last[axis] + 1 - block[axis], edge);
        }
        shares.set_block(block, size);
        for (int f = 0; f < part.count(); ++f) shares.add_face(part.face(f));
        shares.for_voxels(least_share * range.volume, [&](int a, int b, int c, double volume) {
          found[{a, b, c}] += volume;
        });
      }
    }
  }
  return found;
}

/// The part of the box within the planes. @returns false if it is empty
bool set_part(const Case& input, ConvexPart& part) {
  set_box_part(part);
  for (int plane = 0; plane < input.planes; ++plane) {
    const double normal[3] = {input.tet.plane[0][plane], input.tet.plane[1][plane],
                              input.tet.plane[2][plane]};
    ConvexPart cut;
    if (!clip_part(part, normal, input.height[plane], cut)) return false;
    part = cut;
  }
  return true;
}

/// The volume of the part in one source voxel, by six cuts.
double cut_volume(const ConvexPart& part, const SourceMap<double>& map, const Voxel& voxel) {
  const int n[3] = {std::get<0>(voxel), std::get<1>(voxel), std::get<2>(voxel)};
  ConvexPart now = part, next;
  for (int row = 0; row < 3; ++row) {
    for (const double sign : {1.0, -1.0}) {
      const double normal[3] = {sign * map.axis[0][row], sign * map.axis[1][row],
                                sign * map.axis[2][row]};
      if (!clip_part(now, normal, sign * (map.base[row] - n[row]) + 0.5, next)) return 0;
      now = next;
    }
  }
  return volume_of(now) * std::abs(map_volume(map));
}

/// Compares all voxels around the box. @returns the largest difference
double difference(const Case& input) {
  const Shares shares = shares_of(input);
  const VoxelRange range = range_of_box(input.map);
  ConvexPart part;
  const bool has_part = set_part(input, part);
  double largest = 0;
  for (int k = range.first[2] - 1; k <= range.last[2] + 1; ++k) {
    for (int j = range.first[1] - 1; j <= range.last[1] + 1; ++j) {
      for (int i = range.first[0] - 1; i <= range.last[0] + 1; ++i) {
        const auto found = shares.find({i, j, k});
        const double share = found == shares.end() ? 0 : found->second;
        const double expected = has_part ? cut_volume(part, input.map, {i, j, k}) : 0;
        largest = std::max(largest, std::abs(share - expected));
      }
    }
  }
  return largest;
}

SourceMap<double> random_map(RandomNumbers& numbers, double scale) {
  SourceMap<double> map = {};
  for (int row = 0; row < 3; ++row) {
    map.base[row] = 0.5 + 0.5 * numbers.next();
    for (auto& axis : map.axis) axis[row] = scale * numbers.next();
  }
  return map;
}

double area_of(const CutSquare& square) {
  double area = 0;
  for (int c = 0; c < square.count; ++c) {
    const double *a = square.corner[c], *b = square.corner[(c + 1) % square.count];
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return area;
}

/// Up to five lines, a third of them through corners or along sides: both sides of each add up.
TEST(CutSquare, CutsAddUpAndFit) {
  RandomNumbers numbers(6);
  int corners = 0;
  for (int round = 0; round < 20000; ++round) {
    CutSquare square;
    square.set_whole();
    for (int line = 0; line < 5; ++line) {
      HalfPlane side = {0.4 * numbers.next(), {numbers.next(), numbers.next()}};
      if (line % 3 == 2) side = {0.5, {round % 2 == 0 ? 1.0 : -1.0, round % 4 < 2 ? 0.0 : 0.5}};
      CutSquare above = square, below = square;
      const double whole = area_of(square);
      const double up = above.cut(side) ? area_of(above) : 0;
      const double down =
          below.cut({-side.offset, {-side.slope[0], -side.slope[1]}}) ? area_of(below) : 0;
      ASSERT_NEAR(up + down, whole, 1e-15) << round;
      square = up > down ? above : below;
      corners = std::max(corners, square.count);
    }
  }
  EXPECT_GE(corners, 7);
  EXPECT_LE(corners, max_square_corners);
}

TEST(SourceShares, AreTheVolumesOfBoxesAndCutBoxes) {
  RandomNumbers numbers(3);
  for (int round = 0; round < 2000; ++round) {
    const double scale = 1 << round % 4;
    Case input;
    input.map = random_map(numbers, scale);
    while (input.planes < round % 5) {
      const double x = numbers.next(), y = numbers.next(), z = numbers.next();
      input.add_plane(x, y, z, 0.4 * numbers.next() + 0.2);
    }
    ASSERT_LE(difference(input), 1e-13 * std::pow(scale, 3)) << round;
  }
}

/// Faces in the planes between voxels, edges and corners on them.
TEST(SourceShares, AreTheVolumesWhereFacesMeetPlanes) {
  const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  RandomNumbers numbers(4);
  for (int round = 0; round < 2000; ++round) {
    Case input;
    const auto eighth = [&] { return std::floor(4 * numbers.next()) / 4; };
    for (int row = 0; row < 3; ++row) {
      input.map.base[row] = eighth();
      input.map.axis[orders[round % 6][row]][row] = round % 2 == 0 ? 1 + row : -0.5;
      if (round % 5 == 0) input.map.axis[(row + round) % 3][row] += eighth();
    }
    if (map_volume(input.map) == 0) continue;
    if (round % 3 > 0) {
      const double x = eighth(), y = eighth(), z = eighth();
      if (x != 0 || y != 0 || z != 0) input.add_plane(x, y, z, eighth() / 2);
    }
    ASSERT_LE(difference(input), 1e-13) << round;
  }
}

/// A box that is one source voxel has nothing in its neighbors.
TEST(SourceShares, OfAVoxelAreThatVoxel) {
  Case input;
  for (int row = 0; row < 3; ++row) input.map.base[row] = input.map.axis[row][row] = 1;
  EXPECT_EQ(shares_of(input), (Shares{{{1, 1, 1}, 1.0}}));
}
}  // namespace
}  // namespace tetwarp::test
