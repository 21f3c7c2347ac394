/// @file test_source_shares.cpp
/// Volumes of bodies in source voxels, from their faces: those of bodies cut by the voxels' planes.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "kernels/warp/convex_part.hpp"
#include "tests/scenes/scenes.hpp"

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

/// Volumes in the source by SourceShares, in as many blocks as the body needs.
Shares shares_of(const ConvexPart& part, const SourceMap<double>& map) {
  double corner[max_corners][3];
  for (int c = 0; c < part.corner_count; ++c) set_source_position(map, part.corner[c], corner[c]);
  const VoxelRange range = range_of(corner, part.corner_count);
  const int end[3] = {range.last[0] + 1, range.last[1] + 1, range.last[2] + 1};
  Shares found;
  SourceShares shares;
  for (int k = range.first[2]; k < end[2]; k += SourceShares::edge) {
    for (int j = range.first[1]; j < end[1]; j += SourceShares::edge) {
      for (int i = range.first[0]; i < end[0]; i += SourceShares::edge) {
        shares.set_block({i, j, k}, end);
        FaceLoops loops(part);
        Polygon face;
        for (int e = 0; e < part.edge_count; ++e) {
          if (loops.take(part.edge[e], corner, face)) shares.add_face(face);
        }
        shares.for_voxels(map_volume(map) < 0 ? -1 : 1, [&](const int* voxel, double volume) {
          found[{voxel[0], voxel[1], voxel[2]}] += volume;
        });
      }
    }
  }
  return found;
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

/// Compares all voxels around the body. @returns the largest difference
double difference(const ConvexPart& part, const SourceMap<double>& map) {
  const Shares shares = shares_of(part, map);
  double corner[max_corners][3];
  for (int c = 0; c < part.corner_count; ++c) set_source_position(map, part.corner[c], corner[c]);
  const VoxelRange range = range_of(corner, part.corner_count);
  double largest = 0;
  for (int k = range.first[2] - 1; k <= range.last[2] + 1; ++k) {
    for (int j = range.first[1] - 1; j <= range.last[1] + 1; ++j) {
      for (int i = range.first[0] - 1; i <= range.last[0] + 1; ++i) {
        const auto found = shares.find({i, j, k});
        const double share = found == shares.end() ? 0 : found->second;
        largest = std::max(largest, std::abs(share - cut_volume(part, map, {i, j, k})));
      }
    }
  }
  return largest;
}

SourceMap<double> random_map(RandomNumbers& numbers, double scale) {
  SourceMap<double> map = {};
  for (int row = 0; row < 3; ++row) {
    map.base[row] = numbers.next();
    for (auto& axis : map.axis) axis[row] = scale * numbers.next();
  }
  return map;
}

TEST(SourceShares, AreTheVolumesOfBoxesAndCutBoxes) {
  RandomNumbers numbers(3);
  for (int round = 0; round < 600; ++round) {
    const SourceMap<double> map = random_map(numbers, 1 << round % 4);
    ConvexPart part, cut;
    set_box_part(part);
    for (int plane = 0; plane < round % 5; ++plane) {
      const double normal[3] = {numbers.next(), numbers.next(), numbers.next()};
      if (!clip_part(part, normal, 0.3 * numbers.next() + 0.2, cut)) break;
      part = cut;
    }
    ASSERT_LE(difference(part, map), 1e-13 * std::pow(8, round % 4)) << round;
  }
}

/// Faces in the planes between voxels, edges and corners on them.
TEST(SourceShares, AreTheVolumesWhereFacesMeetPlanes) {
  const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  RandomNumbers numbers(4);
  for (int round = 0; round < 600; ++round) {
    SourceMap<double> map = {};
    const auto eighth = [&] { return std::floor(4 * numbers.next()) / 4; };
    for (int row = 0; row < 3; ++row) {
      map.base[row] = eighth();
      map.axis[orders[round % 6][row]][row] = round % 2 == 0 ? 1 + row : -0.5;
      if (round % 5 == 0) map.axis[(row + round) % 3][row] += eighth();
    }
    if (map_volume(map) == 0) continue;
    ConvexPart part, cut;
    set_box_part(part);
    const double normal[3] = {eighth(), eighth(), eighth()};
    if (round % 3 > 0 && clip_part(part, normal, eighth() / 2, cut)) part = cut;
    ASSERT_LE(difference(part, map), 1e-13) << round;
  }
}

/// A box that is one source voxel has nothing in its neighbours.
TEST(SourceShares, OfAVoxelAreThatVoxel) {
  SourceMap<double> map = {};
  for (int row = 0; row < 3; ++row) map.base[row] = map.axis[row][row] = 1;
  ConvexPart part;
  set_box_part(part);
  EXPECT_EQ(shares_of(part, map), (Shares{{{1, 1, 1}, 1.0}}));
}
}  // namespace
}  // namespace tetwarp::test
