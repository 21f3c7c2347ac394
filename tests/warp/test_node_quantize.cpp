/// @file test_node_quantize.cpp
/// Node positions become the same integers on every back end.
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "kernels/warp/node_quantize.hpp"
#include "tests/support/brute_force.hpp"
#include "tests/support/each_exec.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
constexpr IndexFromWorld unit_map = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};
constexpr double quantum = 0x1p-20;  ///< [voxel]

template <class Exec>
class NodeQuantize : public EachExec<Exec> {
 protected:
  std::vector<Node> nodes_of(const IndexFromWorld& map,
                             const std::vector<Point3>& world,
                             const std::vector<std::int64_t>& frame = {0, 0, 0}) {
    std::vector<double> xyz;
    for (const Point3& p : world) xyz.insert(xyz.end(), p.begin(), p.end());
    const auto nodes = this->template zeros<Node>(static_cast<std::int64_t>(world.size()));
    node_quantize(this->exec(), map, frame.data(), View<const double>(this->upload(std::move(xyz))),
                  nodes);
    return this->download(nodes);
  }
  std::vector<std::int64_t> node_of(const IndexFromWorld& map,
                                    const Point3& world,
                                    const std::vector<std::int64_t>& frame = {0, 0, 0}) {
    const Node node = nodes_of(map, {world}, frame).front();
    return {node.x[0], node.x[1], node.x[2]};
  }
};
TYPED_TEST_SUITE(NodeQuantize, Execs, ExecNames);

using Integers = std::vector<std::int64_t>;

TYPED_TEST(NodeQuantize, RoundsHalfAQuantumToEven) {
  EXPECT_EQ(this->node_of(unit_map, {0.5 * quantum, 1.5 * quantum, 2.5 * quantum}),
            (Integers{0, 2, 2}));
  EXPECT_EQ(this->node_of(unit_map, {-0.5 * quantum, -1.5 * quantum, -0.51 * quantum}),
            (Integers{0, -2, -1}));
}

TYPED_TEST(NodeQuantize, SubtractsOriginThenMultipliesThenMovesToTheFrame) {
  const IndexFromWorld map = {{{0, 2, 0}, {0.5, 0, 0}, {0, 0, -1}}, {10, 20, 30}};

  EXPECT_EQ(this->node_of(map, {14, 21.5, 31}, {-8, 0, 16}),
            (Integers{11 * quanta, 2 * quanta, -17 * quanta}));
}

TYPED_TEST(NodeQuantize, RoundsEveryProductAndSumOnItsOwn) {
  const IndexFromWorld map = index_from_world(scenes::oblique_grid(40, 40, 40));
  for (const std::int64_t size : tricky_sizes) {
    std::vector<Point3> world;
    std::vector<Integers> expected;
    for (std::int64_t n = 0; n < size; ++n) {
      Point3 p;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::uint64_t>(3 * n) + axis;
        p[axis] = map.origin[axis] + 1e9 * (scenes::uniform(3, at) - 0.5);
      }
      world.push_back(p);
      const Quanta q = quanta_of(map, p);
      expected.emplace_back(q.begin(), q.end());
    }

    std::vector<Integers> found;
    for (const Node& node : this->nodes_of(map, world)) {
      found.emplace_back(node.x, node.x + 3);
    }

    EXPECT_EQ(found, expected);
  }
}

/// A fused multiply-add would keep the low bit of one product, 2^-10 voxel; unfused they cancel.
TYPED_TEST(NodeQuantize, DoesNotFuseAProductThatCancels) {
  const double a = 0x1p25 * (1 + 0x1p-30);
  const IndexFromWorld map = {{{a, -a, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};

  EXPECT_EQ(this->node_of(map, {a, a, 0})[0], 0);
}

TYPED_TEST(NodeQuantize, IsWithinHalfAQuantumOfAnObliqueGridsOwnIndex) {
  const Grid grid = scenes::oblique_grid(40, 40, 40);
  const Point3 index = {12.25, -3.125, 39.5};

  const Integers node = this->node_of(index_from_world(grid), grid.world_of(index));

  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(node[axis], static_cast<std::int64_t>(index[axis] * quanta));
  }
}

TYPED_TEST(NodeQuantize, RefusesPositionsThatAreNotFiniteOrTooFar) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  const double past = std::nextafter(0x1p40, infinite);

  const std::vector<Node> nodes = this->nodes_of(
      unit_map, {{nan, 0, 0}, {0, nan, 0}, {0, 0, -infinite}, {past, 0, 0}, {0, 0, -past}});

  for (const Node& node : nodes) EXPECT_EQ(node.x[0], bad_node);
}

TYPED_TEST(NodeQuantize, TakesTheFarthestPosition) {
  EXPECT_EQ(this->node_of(unit_map, {0x1p40, -0x1p40, 0}),
            (Integers{std::int64_t{1} << 60, -(std::int64_t{1} << 60), 0}));
}
}  // namespace
}  // namespace tetwarp::test
