/// @file test_tet_moved.cpp
/// Tetrahedra with a node that differs by a quantum or more have moved, and only they are set up.
#include <cstdint>
#include <cstring>
#include <vector>

#include "kernels/warp/tet_moved.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
template <class Exec>
class TetMoved : public EachExec<Exec> {
 protected:
  /// Results of the stage for two sets of nodes.
  struct Found {
    std::vector<std::uint8_t> moved;
    std::vector<std::int64_t> counts;
    std::vector<std::int64_t> classes;
  };
  Found run(const Stages<Exec>& before, const StageInput& now) {
    const std::int64_t tets = before.setups.size;
    const auto node_count = static_cast<std::int64_t>(now.deformed.size());
    const auto moved = this->template zeros<std::uint8_t>(tets);
    const auto counts = this->template zeros<std::int64_t>(tets + 1);
    tet_moved(this->exec(), View<const std::int32_t>(before.tets), View<const Node>(before.nodes),
              View<const Node>(this->upload(now.deformed)), View<const TetSetup>(before.setups),
              this->template zeros<std::uint8_t>(node_count), moved, counts, before.classes);
    return {this->download(moved), this->download(counts), this->download(before.classes)};
  }
};
TYPED_TEST_SUITE(TetMoved, Execs, ExecNames);

StageInput waved_input() {
  return input_of(scenes::adversarial_scene("waved", 24));
}

bool has_node(const StageInput& input, std::size_t t, std::int32_t node) {
  for (std::size_t a = 0; a < 4; ++a) {
    if (input.tets[4 * t + a] == node) return true;
  }
  return false;
}

TYPED_TEST(TetMoved, MarksTheTetrahedraOfANodeThatMovesByOneQuantumOnAnyAxis) {
  const StageInput input = waved_input();
  for (int axis = 0; axis < 3; ++axis) {
    const Stages<TypeParam> before(this->arrays(), input);
    StageInput now = input;
    const std::int32_t node = 17 + axis;
    now.deformed[static_cast<std::size_t>(node)].x[axis] += 1;

    const auto found = this->run(before, now);

    std::int64_t marked = 0;
    for (std::size_t t = 0; t < found.moved.size(); ++t) {
      EXPECT_EQ(found.moved[t], has_node(input, t, node)) << t;
      EXPECT_EQ(found.counts[t], found.moved[t]) << t;
      marked += found.moved[t];
    }
    EXPECT_GT(marked, 0);
  }
}

TYPED_TEST(TetMoved, MarksNothingWhereNothingMoves) {
  const StageInput input = waved_input();
  const Stages<TypeParam> before(this->arrays(), input);

  const auto found = this->run(before, input);

  for (const std::uint8_t moved : found.moved) EXPECT_EQ(moved, 0);
}

/// Flat and inverted tetrahedra are counted once, however often they move.
TYPED_TEST(TetMoved, TakesMovedTetrahedraOutOfTheClassCounts) {
  const StageInput input = input_of(scenes::adversarial_scene("flat", 24));
  const Stages<TypeParam> before(this->arrays(), input);
  const auto classes = this->download(before.classes);
  StageInput now = input;
  for (Node& node : now.deformed) node.x[0] += 1;

  const auto found = this->run(before, now);

  EXPECT_GT(classes[static_cast<std::size_t>(TetClass::flat)], 0);
  EXPECT_EQ(found.classes, std::vector<std::int64_t>(tet_class_count, 0));
}

/// Entries of tetrahedra that have not moved are not written.
TYPED_TEST(TetMoved, SetsUpMovedTetrahedraAndNoOthers) {
  const StageInput input = waved_input();
  StageInput now = input;
  for (std::size_t n = 0; n < now.deformed.size(); n += 9) now.deformed[n].x[1] += 300000;
  const Stages<TypeParam> before(this->arrays(), input), after(this->arrays(), now);
  const auto found = this->run(before, now);
  std::vector<std::int64_t> sums = {0};
  for (const std::uint8_t moved : found.moved) sums.push_back(sums.back() + moved);
  const auto tets = static_cast<std::int64_t>(found.moved.size());
  const auto pairs = this->template zeros<std::int64_t>(tets + 1);

  moved_tet_setup(
      this->exec(), View<const std::int64_t>(this->upload(sums)), sums.back(),
      {before.tets, this->upload(now.deformed), this->upload(input.rest),
       this->upload(input.rest_orientation), input.frame, before.setups, pairs, before.classes});

  const auto setups = this->download(before.setups), expected = this->download(after.setups);
  const auto pair_offsets = this->download(after.pair_offsets), counts = this->download(pairs);
  EXPECT_GT(sums.back(), 0);
  EXPECT_LT(sums.back(), tets);
  for (std::size_t t = 0; t < setups.size(); ++t) {
    EXPECT_EQ(std::memcmp(&setups[t], &expected[t], sizeof(TetSetup)), 0) << t;
    EXPECT_EQ(counts[t], found.moved[t] != 0 ? pair_offsets[t + 1] - pair_offsets[t] : 0) << t;
  }
  EXPECT_EQ(this->download(before.classes), this->download(after.classes));
}
}  // namespace
}  // namespace tetwarp::test
