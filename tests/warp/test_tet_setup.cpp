/// @file test_tet_setup.cpp
/// Planes, boxes, maps and classes of tetrahedra.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/support/brute_force.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
template <class Exec>
class TetSetupStage : public EachExec<Exec> {
 protected:
  Stages<Exec> run(const StageInput& input) { return {this->arrays(), input}; }
  TetSetup only(const StageInput& input) { return this->download(run(input).setups).front(); }
};
TYPED_TEST_SUITE(TetSetupStage, Execs, ExecNames);

/// Legs of `size` voxels along the axes from `at`.
std::vector<Node> corner_nodes(double size, const Point3& at = {0, 0, 0}) {
  return {node_at(at[0], at[1], at[2]), node_at(at[0] + size, at[1], at[2]),
          node_at(at[0], at[1] + size, at[2]), node_at(at[0], at[1], at[2] + size)};
}

const Node& node_of(const StageInput& input,
                    const std::vector<Node>& nodes,
                    std::size_t tet,
                    std::size_t corner) {
  return nodes[static_cast<std::size_t>(input.tets[4 * tet + corner])];
}

double voxels(std::int64_t position) {
  return static_cast<double>(position) / quanta;
}

/// A node relative to a tetrahedron's anchor [voxel].
Point3 from_anchor(const TetSetup& tet, const Node& node) {
  Point3 from;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    from[axis] = voxels(node.x[axis]) - static_cast<double>(tet.anchor[axis]);
  }
  return from;
}

TYPED_TEST(TetSetupStage, HasUnitInwardNormalsAndHeights) {
  const TetSetup tet =
      this->only(one_tet(corner_nodes(8, {1, 2, 3}), corner_nodes(8), frame_of(24, 24, 24)));

  const double third = std::sqrt(1.0 / 3.0);
  const double expected[4][4] = {
      {-third, -third, -third, 8 * third}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  for (int face = 0; face < 4; ++face) {
    EXPECT_NEAR(tet.height[face], face == 0 ? 8 * third : 8, 1e-14);
    for (int axis = 0; axis < 4; ++axis) {
      EXPECT_NEAR(tet.plane[axis][face], expected[face][axis], 1e-14);
    }
  }
}

TYPED_TEST(TetSetupStage, BoxesTheVoxelsWithinAndTheirCells) {
  const StageInput input =
      one_tet(corner_nodes(8.5, {1.5, 2, 7.25}), corner_nodes(8), frame_of(24, 24, 24));
  const Stages<TypeParam> stages = this->run(input);
  const TetSetup tet = this->download(stages.setups).front();

  EXPECT_EQ(std::vector(tet.anchor, tet.anchor + 3), (std::vector<std::int64_t>{1, 2, 7}));
  EXPECT_EQ(std::vector(tet.begin, tet.begin + 3), (std::vector{2, 2, 8}));
  EXPECT_EQ(std::vector(tet.end, tet.end + 3), (std::vector{11, 11, 16}));
  EXPECT_EQ(this->download(stages.pair_offsets), (std::vector<std::int64_t>{0, 2 * 2 * 1}));
}

TYPED_TEST(TetSetupStage, ClipsTheBoxToTheFrame) {
  OutputFrame frame = frame_of(13, 24, 24);
  frame.begin[1] = 5;
  const Stages<TypeParam> inside =
      this->run(one_tet(corner_nodes(30, {-3, -3, 0}), corner_nodes(8), frame));
  const Stages<TypeParam> beside =
      this->run(one_tet(corner_nodes(4, {13.5, 6, 6}), corner_nodes(8), frame));

  const TetSetup tet = this->download(inside.setups).front();
  EXPECT_EQ(std::vector(tet.begin, tet.begin + 3), (std::vector{0, 5, 0}));
  EXPECT_EQ(std::vector(tet.end, tet.end + 3), (std::vector{13, 24, 24}));
  EXPECT_EQ(this->download(beside.pair_offsets).back(), 0);
}

TYPED_TEST(TetSetupStage, TakesDeformedNodesToRestNodes) {
  for (const scenes::Scene& scene : scenes::adversarial_scenes(24)) {
    const StageInput input = input_of(scene);
    const std::vector<TetSetup> setups = this->download(this->run(input).setups);
    for (std::size_t t = 0; t < setups.size(); ++t) {
      const TetSetup& tet = setups[t];
      if (tet.tet_class == TetClass::flat) continue;
      for (std::size_t a = 0; a < 4; ++a) {
        const Point3 from = from_anchor(tet, node_of(input, input.deformed, t, a));
        const double distance = std::abs(from[0]) + std::abs(from[1]) + std::abs(from[2]) + 1;
        for (int row = 0; row < 3; ++row) {
          double x = tet.map[3][row];
          for (int axis = 0; axis < 3; ++axis) {
            x += tet.map[axis][row] * from[static_cast<std::size_t>(axis)];
          }
          // Entries are sums of edges over heights, which may cancel: a few roundings of each term.
          const double first = voxels(node_of(input, input.rest, t, 0).x[row]);
          double terms = std::abs(first);
          for (std::size_t f = 1; f < 4; ++f) {
            const double edge = voxels(node_of(input, input.rest, t, f).x[row]) - first;
            terms += std::abs(edge) * distance / tet.height[f];
          }
          const double bound = terms * 0x1p-49 + (tet.kind == MapKind::copy ? 0x1p-20 : 0);
          ASSERT_NEAR(x, voxels(node_of(input, input.rest, t, a).x[row]), bound)
              << scene.name << ", tetrahedron " << t;
        }
      }
    }
  }
}

TYPED_TEST(TetSetupStage, PlanesVanishOnTheirNodesAndReachTheirHeight) {
  for (const scenes::Scene& scene : scenes::adversarial_scenes(24)) {
    const StageInput input = input_of(scene);
    const std::vector<TetSetup> setups = this->download(this->run(input).setups);
    for (std::size_t t = 0; t < setups.size(); ++t) {
      const TetSetup& tet = setups[t];
      if (tet.tet_class == TetClass::flat) continue;
      for (int face = 0; face < 4; ++face) {
        for (std::size_t a = 0; a < 4; ++a) {
          const Point3 from = from_anchor(tet, node_of(input, input.deformed, t, a));
          double value = tet.plane[3][face], terms = std::abs(value);
          for (int axis = 0; axis < 3; ++axis) {
            value += tet.plane[axis][face] * from[static_cast<std::size_t>(axis)];
            terms += std::abs(from[static_cast<std::size_t>(axis)]);
          }
          const bool opposite = static_cast<int>(a) == face;
          ASSERT_NEAR(value, opposite ? tet.height[face] : 0.0, terms * 0x1p-48)
              << scene.name << ", tetrahedron " << t;
        }
      }
    }
  }
}

TYPED_TEST(TetSetupStage, CopiesWholeShiftsToWithinAQuantum) {
  std::vector<Node> rest = corner_nodes(8, {4, -2, 1});
  rest[2].x[0] += 1;
  rest[3].x[1] -= 1;
  const TetSetup copied = this->only(one_tet(corner_nodes(8), rest, frame_of(16, 16, 16)));
  rest[2].x[0] += 1;
  const TetSetup moved = this->only(one_tet(corner_nodes(8), rest, frame_of(16, 16, 16)));

  EXPECT_EQ(copied.kind, MapKind::copy);
  EXPECT_EQ(copied.map[0][0], 1);
  EXPECT_EQ(copied.map[1][0], 0);
  EXPECT_EQ(copied.map[3][0], 4);
  EXPECT_EQ(copied.map[3][1], -2);
  EXPECT_EQ(moved.kind, MapKind::affine);
}

TYPED_TEST(TetSetupStage, CallsMapsSteepThatStretchMoreThanFourfold) {
  const OutputFrame frame = frame_of(16, 16, 16);

  EXPECT_EQ(this->only(one_tet(corner_nodes(8), corner_nodes(32), frame)).kind, MapKind::affine);
  EXPECT_EQ(this->only(one_tet(corner_nodes(8), corner_nodes(33), frame)).kind, MapKind::steep);
}

TYPED_TEST(TetSetupStage, SortsOutWhatIsInvertedFlatBadOrTooLarge) {
  std::vector<Node> nodes = corner_nodes(8);
  nodes.push_back(nodes[1]);                   // 4: makes a flat one with 1
  nodes.push_back({{bad_node, 0, 0}});         // 5
  nodes.push_back(node_at(0, 0, 0x1p20 + 1));  // 6
  const std::vector<std::int32_t> tets = {0, 1, 2, 3, 0, 2, 1, 3, 0, 1,
                                          2, 4, 0, 1, 2, 5, 0, 1, 2, 6};
  const StageInput input = {tets, nodes, nodes, {1, 1, 1, 1, 1}, frame_of(16, 16, 16)};

  const Stages<TypeParam> stages = this->run(input);

  std::vector<TetClass> classes;
  for (const TetSetup& tet : this->download(stages.setups)) classes.push_back(tet.tet_class);
  EXPECT_EQ(classes, (std::vector{TetClass::inverted, TetClass::regular, TetClass::flat,
                                  TetClass::bad_position, TetClass::too_large}));
  EXPECT_EQ(this->download(stages.classes), (std::vector<std::int64_t>{0, 1, 1, 1, 1}));
  EXPECT_EQ(this->download(stages.pair_offsets), (std::vector<std::int64_t>{0, 8, 16, 16, 16, 16}));
}

/// The same bits at any position of a tetrahedron in the list.
TYPED_TEST(TetSetupStage, TreatsEveryTetrahedronAlone) {
  for (const std::int64_t size : tricky_sizes) {
    scenes::Scene scene = scene_of_tets(size);
    std::vector<TetSetup> forward = this->download(this->run(input_of(scene)).setups);
    std::ranges::reverse(scene.mesh.tets);
    const std::vector<TetSetup> backward = this->download(this->run(input_of(scene)).setups);

    std::ranges::reverse(forward);
    ASSERT_EQ(forward.size(), backward.size());
    if (size == 0) continue;
    EXPECT_EQ(std::memcmp(forward.data(), backward.data(), forward.size() * sizeof(TetSetup)), 0);
  }
}

/// Normals in 64 bits, for extents up to short_extent, its corners included.
TEST(SetPlanes, HaveTheSameBitsWithShortAndLongIntegers) {
  const OutputFrame frame = frame_of(1024, 1024, 1024);
  std::uint64_t draw = 0;
  for (int n = 0; n < 4000; ++n) {
    const double extent = std::ldexp(1.0, n % 31);
    TetNodes tet;
    for (auto& node : tet.x) {
      for (std::int64_t& x : node) {
        const double u = scenes::uniform(91, draw++);
        x = std::llrint(extent * (n % 2 == 0 ? u : std::round(u)));
      }
    }
    TetSetup shorter = {}, longer = {};
    ASSERT_LE(set_box(tet, frame, shorter), short_extent);
    set_box(tet, frame, longer);
    Barycentric of_nodes[2][4] = {};

    const int turned = set_planes<std::int64_t>(tet, shorter, of_nodes[0]);

    ASSERT_EQ(set_planes<Int128>(tet, longer, of_nodes[1]), turned);
    EXPECT_EQ(std::memcmp(&shorter, &longer, sizeof(TetSetup)), 0) << n;
    EXPECT_EQ(std::memcmp(of_nodes[0], of_nodes[1], sizeof(of_nodes[0])), 0) << n;
  }
}
}  // namespace
}  // namespace tetwarp::test
