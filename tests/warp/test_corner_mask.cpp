/// @file test_corner_mask.cpp
/// A bit of a mask is set only where rounding cannot have set it.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/support/brute_force.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
template <class Exec>
class CornerMask : public EachExec<Exec> {
 protected:
  Stages<Exec> run(const StageInput& input) { return {this->arrays(), input}; }
};
TYPED_TEST_SUITE(CornerMask, Execs, ExecNames);

/// Legs of 16 voxels; faces 1, 2, 3 lie in the planes x = 0, y = 0, z = 0.
StageInput corner_tet() {
  const std::vector<Node> nodes = {node_at(0, 0, 0), node_at(16, 0, 0), node_at(0, 16, 0),
                                   node_at(0, 0, 16)};
  return one_tet(nodes, nodes, frame_of(24, 24, 24));
}

/// A corner on a face is on neither side for certain.
TYPED_TEST(CornerMask, HasABitPerSideACornerIsCertainlyOn) {
  const auto masks = this->download(this->run(corner_tet()).masks);
  const auto at = [&](int i, int j, int k) {
    return masks[static_cast<std::size_t>((k * 4 + j) * 4 + i)];
  };

  ASSERT_EQ(masks.size(), 64u);
  EXPECT_EQ(at(0, 0, 0), 0b0001'0000'0000);  // node 0: b = (1, 0, 0, 0)
  EXPECT_EQ(at(2, 0, 0), 0b0010'0000'0000);  // node 1
  EXPECT_EQ(at(1, 1, 1), 0b1110'0000'0001);  // b = (-1/2, 1/2, 1/2, 1/2)
  EXPECT_EQ(at(3, 0, 0), 0b0010'0000'1001);  // b = (-1/2, 3/2, 0, 0)
}

/// Bits that are set agree with exact barycentric coordinates on every scene, and almost all
/// corners away from the faces have one set.
TYPED_TEST(CornerMask, IsNeverWrongAndSeldomUndecided) {
  for (const scenes::Scene& scene : scenes::adversarial_scenes(24)) {
    const StageInput input = input_of(scene);
    const Stages<TypeParam> stages = this->run(input);
    const auto setups = this->download(stages.setups);
    const auto offsets = this->download(stages.corner_offsets);
    const auto masks = this->download(stages.masks);
    const auto tets = tets_of(scene.output_grid, scene.mesh, scene.deformed);
    std::int64_t undecided = 0;
    for (std::size_t t = 0; t < setups.size(); ++t) {
      const int nx = last_cell(setups[t], 0) - first_cell(setups[t], 0) + 2;
      const int ny = last_cell(setups[t], 1) - first_cell(setups[t], 1) + 2;
      for (std::int64_t item = offsets[t]; item < offsets[t + 1]; ++item) {
        const std::int64_t local = item - offsets[t];
        const Quanta x = voxel_center((first_cell(setups[t], 0) + local % nx) * cell_edge,
                                      (first_cell(setups[t], 1) + local / nx % ny) * cell_edge,
                                      (first_cell(setups[t], 2) + local / nx / ny) * cell_edge);
        const Wide whole = volume6(tets[t]) < 0 ? -volume6(tets[t]) : volume6(tets[t]);
        for (unsigned face = 0; face < 4; ++face) {
          const Wide part = part6(tets[t], face, x);
          const unsigned mask = masks[static_cast<std::size_t>(item)];
          const bool below = mask >> (2 * face) & 1, above = mask >> (2 * face + 1) & 1,
                     inside = mask >> (8 + face) & 1;
          ASSERT_TRUE(!below || part < 0) << scene.name << ", tetrahedron " << t;
          ASSERT_TRUE(!above || part > whole) << scene.name << ", tetrahedron " << t;
          ASSERT_TRUE(!inside || part > 0) << scene.name << ", tetrahedron " << t;
          undecided += part != 0 && !below && !inside;
        }
      }
    }
    EXPECT_LE(undecided, static_cast<std::int64_t>(masks.size()) / 100) << scene.name;
  }
}

/// Small tetrahedra have none.
TYPED_TEST(CornerMask, HasCornersWhereTheBoxIsLarge) {
  const auto corners = [&](double size) {
    const std::vector<Node> nodes = {node_at(0, 0, 0), node_at(size, 0, 0), node_at(0, size, 0),
                                     node_at(0, 0, size)};
    return this->run(one_tet(nodes, nodes, frame_of(32, 32, 32))).masks.size;
  };

  EXPECT_EQ(corners(15.5), 0);        // 2x2x2 cells
  EXPECT_EQ(corners(16), 4 * 4 * 4);  // 3x3x3 cells
  EXPECT_EQ(corners(31.5), 5 * 5 * 5);
}

/// Boxes of all sizes up to 30 cells per axis.
TEST(CornerMaskRoom, IsEnoughForEveryBox) {
  for (std::int64_t x = 1; x <= 30; ++x) {
    for (std::int64_t y = 1; y <= 30; ++y) {
      for (std::int64_t z = 1; z <= 30; ++z) {
        if (x * y * z < fewest_culled_cells) continue;
        ASSERT_LE((x + 1) * (y + 1) * (z + 1), most_corners(x * y * z));
      }
    }
  }
}

TYPED_TEST(CornerMask, IsTheSameAloneAndInAList) {
  for (const std::int64_t size : tricky_sizes) {
    const scenes::Scene scene = scene_of_tets(size);
    const Stages<TypeParam> stages = this->run(input_of(scene));
    const auto setups = this->download(stages.setups);
    std::vector<std::uint16_t> expected;
    for (const TetSetup& tet : setups) {
      if (box_cells(tet) < fewest_culled_cells) continue;
      for (int k = first_cell(tet, 2); k <= last_cell(tet, 2) + 1; ++k) {
        for (int j = first_cell(tet, 1); j <= last_cell(tet, 1) + 1; ++j) {
          for (int i = first_cell(tet, 0); i <= last_cell(tet, 0) + 1; ++i) {
            expected.push_back(corner_mask_of(tet, i * cell_edge, j * cell_edge, k * cell_edge));
          }
        }
      }
    }

    EXPECT_EQ(this->download(stages.masks), expected);
  }
}

TYPED_TEST(CornerMask, WritesNothingBeyondItsRoom) {
  const Stages<TypeParam> stages = this->run(corner_tet());
  const auto whole = this->download(stages.masks);
  const auto masks = this->upload(std::vector<std::uint16_t>(64, 0xbeef));

  corner_mask(this->exec(), View<const TetSetup>(stages.setups),
              View<const std::int64_t>(stages.corner_offsets), View<std::uint16_t>{masks.data, 20});

  const auto found = this->download(masks);
  EXPECT_TRUE(std::equal(found.begin(), found.begin() + 20, whole.begin()));
  EXPECT_EQ(std::count(found.begin() + 20, found.end(), 0xbeef), 44);
}
}  // namespace
}  // namespace tetwarp::test
