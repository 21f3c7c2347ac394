/// @file test_voxel_bodies.cpp
/// Parts of a voxel's box in two tetrahedra: the face in which they meet is left out of both where
/// its integrals cancel, and the volumes in the source voxels stay the same.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "kernels/warp/overlap/voxel_bodies.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using Shares = std::map<std::tuple<int, int, int>, double>;

/// The box around voxel (0, 0, 0), divided by the plane x = cut between tetrahedra 0 and 1. The
/// source is at 1.5 x, turned a little; on the upper side x grows 1.2 times as fast.
struct Pair {
  static constexpr double growth = 1.2;
  double cut;
  bool is_folded;  ///< tetrahedron 1 lies on the same side as tetrahedron 0, mirrored
  TetSetup setups[2] = {};
  std::int32_t tets[8] = {0, 1, 2, 3, 1, 2, 3, 4};  // share the face opposite nodes 0 and 4
  VoxelBodies bodies;

  Pair(double cut, bool is_folded) : cut(cut), is_folded(is_folded) {
    const double turn = 0.2;
    for (int t = 0; t < 2; ++t) {
      const int face = t == 0 ? 0 : 3;
      const double side = t == 0 || is_folded ? -1 : 1;  // of the tetrahedron along x
      for (int f = 0; f < 4; ++f) setups[t].plane[3][f] = 10;
      setups[t].plane[0][face] = side;
      VoxelBody& body = bodies.next();
      body = {};
      body.tet = t;
      body.cuts = 1 << face;
      for (double& height : body.height) height = 10;
      body.height[face] = -side * cut;
      const double along = t == 0 ? 1 : is_folded ? -growth : growth;
      const double columns[3][3] = {{1.5 * std::cos(turn), 1.5 * std::sin(turn), 0.3},
                                    {-1.5 * std::sin(turn), 1.5 * std::cos(turn), 0.1},
                                    {0.2, -0.3, 1.5}};
      for (int row = 0; row < 3; ++row) {
        for (int axis = 0; axis < 3; ++axis) body.map.axis[axis][row] = columns[axis][row];
        body.map.axis[0][row] *= along;
        body.map.base[row] = 0.37 + cut * (columns[0][row] - body.map.axis[0][row]);
        body.map.whole[row] = 5 + 2 * t;  // align() makes them the same
        body.map.base[row] -= 2 * t;
      }
      body.weight = map_volume(body.map) < 0 ? -1 : 1;
      bodies.add();
    }
  }

  /// Volumes in source voxels, with or without the face in which the bodies meet.
  Shares shares(bool leaves_out) {
    VoxelRange range;
    bodies.align(range);
    bodies.meet(setups, tets);
    int size[3];
    for (int axis = 0; axis < 3; ++axis) size[axis] = range.last[axis] + 1 - range.first[axis];
    SourceShares sum;
    sum.set_block(range.first, size);
    for (int b = 0; b < bodies.count(); ++b) {
      const PartFaces faces = leaves_out ? bodies.faces(b, setups) : bodies.all_faces(b, setups);
      for (int n = 0; n < max_part_faces; ++n) {
        SourceFace face;
        if (faces.set_face(n, face)) sum.add_face(face);
      }
    }
    Shares found;
    sum.for_voxels(least_share * range.volume, [&](int i, int j, int k, double volume) {
      found[{i, j, k}] = volume;
    });
    return found;
  }
};

void expect_equal(const Shares& found, const Shares& expected) {
  for (const auto& [voxel, volume] : expected) {
    const auto at = found.find(voxel);
    EXPECT_NEAR(at == found.end() ? 0 : at->second, volume, 1e-14);
  }
  EXPECT_LE(found.size(), expected.size());
}

double sum_of(const Shares& shares) {
  double sum = 0;
  for (const auto& [voxel, volume] : shares) sum += volume;
  return sum;
}

TEST(VoxelBodies, LeaveOutTheFaceInWhichTheyMeet) {
  for (const bool is_folded : {false, true}) {
    for (const double cut : {-0.4, -0.1, 0.0, 0.3}) {
      Pair pair(cut, is_folded);
      const double below = 0.5 + cut, above = is_folded ? 0.5 + cut : 0.5 - cut;
      const double unit = std::abs(map_volume(pair.bodies.body(0).map));
      const Shares all = pair.shares(false), fewer = pair.shares(true);
      EXPECT_EQ(pair.bodies.body(0).met, 1);
      EXPECT_EQ(pair.bodies.body(1).met, 8);
      EXPECT_NEAR(sum_of(all), unit * (below + Pair::growth * above), 1e-13);
      expect_equal(fewer, all);
    }
  }
}

/// Both lie on one side of the face at rest: the deformation mirrors neither or both.
TEST(VoxelBodies, KeepTheFaceWhereTheyOverlapAtRest) {
  Pair pair(0.1, true);
  VoxelBodies overlapping;
  for (int t = 0; t < 2; ++t) {
    overlapping.next() = pair.bodies.body(0);
    overlapping.next().tet = t;
    overlapping.next().cuts = t == 0 ? 1 : 8;
    overlapping.add();
  }
  overlapping.meet(pair.setups, pair.tets);
  EXPECT_EQ(overlapping.body(0).met, 0);
  EXPECT_EQ(overlapping.body(1).met, 0);
}

/// Weights that differ keep the face: its integrals do not cancel.
TEST(VoxelBodies, KeepTheFaceBetweenDifferentWeights) {
  Pair pair(0.1, false);
  VoxelBodies different;
  for (int t = 0; t < 2; ++t) {
    different.next() = pair.bodies.body(t);
    if (t == 1) different.next().weight *= 1.001;
    different.add();
  }
  different.meet(pair.setups, pair.tets);
  EXPECT_EQ(different.body(0).met, 0);
}
}  // namespace
}  // namespace tetwarp::test
