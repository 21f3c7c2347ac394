/// @file test_cell_cull.cpp
/// Rejected cells contain no voxel of the tetrahedron, accepted cells only its voxels.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/support/brute_force.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
template <class Exec>
class CellCull : public EachExec<Exec> {
 protected:
  Stages<Exec> run(const StageInput& input, CullSwitches switches = {}) {
    return {this->arrays(), input, switches};
  }
};
TYPED_TEST_SUITE(CellCull, Execs, ExecNames);

/// The candidates culled by planes, and those culled by masks.
template <class Exec>
std::vector<std::vector<CellPair>> both_ways(const Stages<Exec>& stages, ExecArrays<Exec>& arrays) {
  return {arrays.download(stages.candidates), arrays.download(stages.masked_candidates)};
}

/// Holds cell 0 of a frame of 3 x 3 x 3 cells and cuts, touches or misses the others.
StageInput wedge_tet() {
  const std::vector<Node> nodes = {node_at(-1, -1, -1), node_at(27.5, -1, -1),
                                   node_at(-1, 27.5, -1), node_at(-1, -1, 27.5)};
  return one_tet(nodes, nodes, frame_of(24, 24, 24));
}

/// Voxels of cell and frame, as a box.
struct Box {
  int begin[3];
  int end[3];
};
Box box_of(const OutputFrame& frame, std::int64_t cell) {
  const std::int64_t line = cell / frame.cells[0];
  const std::int64_t at[3] = {cell % frame.cells[0], line % frame.cells[1], line / frame.cells[1]};
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const int corner = static_cast<int>(at[axis]) * cell_edge;
    box.begin[axis] = std::max(corner, frame.begin[axis]);
    box.end[axis] = std::min(corner + cell_edge, frame.end[axis]);
  }
  return box;
}

/// Voxels of the box inside the tetrahedron.
std::int64_t inside_count(const TetQuanta& tet, const Box& box) {
  std::int64_t count = 0;
  for (int k = box.begin[2]; k < box.end[2]; ++k) {
    for (int j = box.begin[1]; j < box.end[1]; ++j) {
      for (int i = box.begin[0]; i < box.end[0]; ++i) {
        count += is_inside(tet, voxel_center(i, j, k));
      }
    }
  }
  return count;
}

std::int64_t voxel_count(const Box& box) {
  return std::int64_t{box.end[0] - box.begin[0]} * (box.end[1] - box.begin[1]) *
         (box.end[2] - box.begin[2]);
}

/// Cells of the tetrahedron's box in the order of its candidate pairs.
std::vector<std::int64_t> cells_of(const TetSetup& tet, const OutputFrame& frame) {
  std::vector<std::int64_t> cells;
  if (is_empty(tet)) return cells;
  for (int k = first_cell(tet, 2); k <= last_cell(tet, 2); ++k) {
    for (int j = first_cell(tet, 1); j <= last_cell(tet, 1); ++j) {
      for (int i = first_cell(tet, 0); i <= last_cell(tet, 0); ++i) {
        cells.push_back(frame.cell_index(i, j, k));
      }
    }
  }
  return cells;
}

/// The far corner of cell (0, 1, 1) is inside x + y + z <= 24.5 only by its near edge: partial;
/// cell (1, 1, 1) begins at x + y + z = 24: partial too.
TYPED_TEST(CellCull, AcceptsRejectsOrKeeps) {
  const std::vector<Node> nodes = {node_at(-1, -1, -1), node_at(23, -1, -1), node_at(-1, 23, -1),
                                   node_at(-1, -1, 23)};
  const StageInput wide = wedge_tet();
  const StageInput narrow = one_tet(nodes, nodes, frame_of(24, 24, 24));

  for (const auto& near : both_ways(this->run(wide), this->arrays())) {
    EXPECT_EQ(near.front(), make_pair(0, 0, true));
    EXPECT_EQ(near[1], make_pair(1, 0, false));
    EXPECT_EQ(near[13], make_pair(13, 0, false));
    EXPECT_EQ(near.back(), rejected_pair);
  }
  for (const auto& far : both_ways(this->run(narrow), this->arrays())) {
    EXPECT_EQ(far.front(), make_pair(0, 0, false));  // x + y + z <= 20 cuts its far corner
    EXPECT_EQ(far[13], rejected_pair);
  }
}

TYPED_TEST(CellCull, NeverChangesOwnersInAWholeOrACutGrid) {
  const auto scenes = scenes::adversarial_scenes(32);
  std::int64_t rejected = 0, accepted = 0;
  for (std::size_t s = 0; s < 2 * scenes.size(); ++s) {
    const scenes::Scene& scene = scenes[s / 2];
    const bool is_cut = s % 2 == 1;
    const auto& dims = scene.output_grid.dims;
    const Region inner{{3, 5, 2}, {dims[0] - 2, dims[1] - 1, dims[2] - 4}};
    const StageInput input = is_cut ? input_of(scene, inner) : input_of(scene);
    const Stages<TypeParam> stages = this->run(input);
    const auto setups = this->download(stages.setups);
    const auto offsets = this->download(stages.pair_offsets);
    const auto tets = tets_of(scene.output_grid, scene.mesh, scene.deformed);
    const auto ways = both_ways(stages, this->arrays());
    for (std::size_t t = 0; t < setups.size(); ++t) {
      const auto cells = cells_of(setups[t], input.frame);
      ASSERT_EQ(static_cast<std::int64_t>(cells.size()), offsets[t + 1] - offsets[t]);
      for (std::size_t c = 0; c < cells.size(); ++c) {
        const Box box = box_of(input.frame, cells[c]);
        for (const auto& pairs : ways) {
          const CellPair pair = pairs[static_cast<std::size_t>(offsets[t]) + c];
          if (pair == rejected_pair) {
            ++rejected;
            ASSERT_EQ(inside_count(tets[t], box), 0) << scene.name << ", tetrahedron " << t;
            continue;
          }
          ASSERT_EQ(cell_of(pair), cells[c]);
          ASSERT_EQ(tet_of(pair), static_cast<int>(t));
          if (!is_accepted(pair)) continue;
          ++accepted;
          ASSERT_EQ(inside_count(tets[t], box), voxel_count(box)) << scene.name;
        }
      }
    }
  }
  EXPECT_GT(rejected, 1000);
  EXPECT_GT(accepted, 0);
}

TYPED_TEST(CellCull, GivesOnlyVerdictsThatAreSwitchedOn) {
  const StageInput input = input_of(scenes::adversarial_scene("rotated", 40));
  const auto is_rejected = [](CellPair p) { return p == rejected_pair; };
  const auto is_sure = [](CellPair p) { return p != rejected_pair && is_accepted(p); };

  const auto with = both_ways(this->run(input), this->arrays());
  const auto without_reject = both_ways(this->run(input, {.reject = false}), this->arrays());
  const auto without_accept = both_ways(this->run(input, {.accept = false}), this->arrays());

  for (std::size_t way = 0; way < with.size(); ++way) {
    const auto &all = with[way], &no_reject = without_reject[way], &no_accept = without_accept[way];
    EXPECT_EQ(std::ranges::count_if(no_reject, is_rejected), 0);
    EXPECT_EQ(std::ranges::count_if(no_accept, is_sure), 0);
    for (std::size_t p = 0; p < all.size(); ++p) {
      EXPECT_EQ(is_sure(no_reject[p]), is_sure(all[p]));
      EXPECT_EQ(is_rejected(no_accept[p]), is_rejected(all[p]));
    }
  }
}

TYPED_TEST(CellCull, HasAPairPerCellForAnyNumberOfTetrahedra) {
  for (const std::int64_t size : tricky_sizes) {
    const scenes::Scene scene = scene_of_tets(size);
    const StageInput input = input_of(scene);
    const Stages<TypeParam> stages = this->run(input, {.reject = false, .accept = false});
    std::vector<CellPair> expected;
    std::int64_t t = 0;
    for (const TetSetup& tet : this->download(stages.setups)) {
      for (const std::int64_t cell : cells_of(tet, input.frame)) {
        expected.push_back(make_pair(cell, t, false));
      }
      ++t;
    }

    for (const auto& pairs : both_ways(stages, this->arrays())) EXPECT_EQ(pairs, expected);
  }
}

/// A tetrahedron in the first of eight cells' corner; its box touches all of them.
StageInput small_tet() {
  const std::vector<Node> nodes = {node_at(-1, -1, -1), node_at(11, -1, -1), node_at(-1, 11, -1),
                                   node_at(-1, -1, 11)};
  return one_tet(nodes, nodes, frame_of(16, 16, 16));
}

/// With eight cells no masks are made, and every pair is kept.
TYPED_TEST(CellCull, KeepsAllPairsOfSmallTetrahedraWithoutMasks) {
  const Stages<TypeParam> stages = this->run(small_tet());

  EXPECT_EQ(stages.masks.size, 0);
  const auto found = this->download(stages.masked_candidates);
  for (std::size_t c = 0; c < 8; ++c) {
    EXPECT_EQ(found[c], make_pair(static_cast<std::int64_t>(c), 0, false));
  }
}

/// Its far face is x + y + z = 9: the four cells that start beyond it are rejected.
TEST(CellVerdicts, RejectCellsThatASmallTetrahedronMisses) {
  CpuExec exec(1);
  ExecArrays<CpuExec> arrays(exec);

  const Stages<CpuExec> stages(arrays, small_tet());

  const auto found = arrays.download(stages.candidates);
  ASSERT_EQ(found.size(), 8u);
  for (std::size_t c = 0; c < 8; ++c) {
    const bool is_met = c == 0 || c == 1 || c == 2 || c == 4;
    EXPECT_EQ(found[c], is_met ? make_pair(static_cast<std::int64_t>(c), 0, false) : rejected_pair);
  }
}

/// Pairs without masks, because their buffer was too small, are kept; the step then runs again.
TYPED_TEST(CellCull, KeepsPairsWhoseMasksHadNoRoom) {
  const StageInput input = wedge_tet();
  const Stages<TypeParam> stages = this->run(input);
  const auto pairs = this->template zeros<CellPair>(27);

  cell_cull(this->exec(), View<const TetSetup>(stages.setups),
            stages.mask_verdict({stages.masks.data, 10}),
            View<const std::int64_t>(stages.pair_offsets), CullSwitches{}, input.frame, pairs);

  const auto found = this->download(pairs);
  for (std::size_t c = 0; c < 27; ++c) {
    EXPECT_EQ(found[c], make_pair(static_cast<std::int64_t>(c), 0, false));
  }
}
}  // namespace
}  // namespace tetwarp::test
