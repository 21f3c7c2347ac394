/// @file test_cell_merge.cpp
/// Updated pairs are the pairs that a step from scratch makes.
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/warp/cell_merge.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Results of the stage.
struct Merged {
  std::vector<CellPair> pairs;
  Ranges ranges;
  std::vector<std::uint8_t> touched;
  std::int64_t touched_count = 0;
};

template <class Exec>
class CellMerge : public EachExec<Exec> {
 protected:
  PairList list_of(std::vector<CellPair> candidates, const OutputFrame& frame) {
    const auto size = static_cast<std::int64_t>(candidates.size());
    const auto pairs = this->template zeros<CellPair>(size);
    const auto ranges = this->template zeros<CellRange>(frame.cell_count() + 1);
    cell_pairs(this->exec(), View<const CellPair>(this->upload(std::move(candidates))),
               View<const std::int64_t>(this->upload(std::vector<std::int64_t>{size})), frame,
               pairs, this->template zeros<std::int64_t>(1), ranges,
               this->template zeros<std::int64_t>(1));
    return {pairs, ranges};
  }

  Merged merged(const PairList& before,
                const PairList& fresh,
                const std::vector<std::uint8_t>& moved,
                const OutputFrame& frame) {
    const std::int64_t cells = frame.cell_count();
    const auto pairs = this->template zeros<CellPair>(before.pairs.size + fresh.pairs.size);
    const auto pair_count = this->template zeros<std::int64_t>(1);
    const auto ranges = this->template zeros<CellRange>(cells + 1);
    const auto touched = this->template zeros<std::uint8_t>(cells);
    const auto touched_count = this->template zeros<std::int64_t>(1);
    cell_merge(this->exec(), before, fresh, View<const std::uint8_t>(this->upload(moved)), pairs,
               pair_count, this->template zeros<std::int64_t>(cells + 1), ranges, touched,
               touched_count);
    const std::int64_t count = this->download(pair_count).front();
    return {this->download(View<CellPair>{pairs.data, count}), ranges_of(ranges),
            this->download(touched), this->download(touched_count).front()};
  }

  template <class Range>
  Ranges ranges_of(View<Range> ranges) {
    Ranges result;
    for (const CellRange& range : this->download(ranges)) {
      result.emplace_back(range.begin, range.end);
    }
    return result;
  }
};
TYPED_TEST_SUITE(CellMerge, HostExecs, ExecNames);

/// Random pairs of the tetrahedra for which `belongs` holds, by tetrahedron, then cell.
template <class Belongs>
std::vector<CellPair> random_pairs(std::int64_t tets,
                                   std::int64_t cells,
                                   std::uint64_t seed,
                                   Belongs&& belongs) {
  std::vector<CellPair> pairs;
  for (std::int64_t t = 0; t < tets; ++t) {
    if (!belongs(static_cast<std::size_t>(t))) continue;
    for (std::int64_t cell = 0; cell < cells; ++cell) {
      const auto at = static_cast<std::uint64_t>(2 * (t * cells + cell));
      if (scenes::uniform(seed, at) < 0.1) {
        pairs.push_back(make_pair(cell, t, scenes::uniform(seed, at + 1) < 0.1));
      }
    }
  }
  return pairs;
}

/// Tetrahedra that do not move have the pairs of `seed` in both steps, the others different ones.
TYPED_TEST(CellMerge, GivesTheListOfAStepFromScratch) {
  const OutputFrame frame = frame_of(40, 24, 33);
  const std::int64_t cells = frame.cell_count();
  for (const std::int64_t tets : tricky_sizes) {
    for (const double share : {0.0, 0.03, 0.5, 1.0}) {
      std::vector<std::uint8_t> moved;
      for (std::int64_t t = 0; t < tets; ++t) {
        moved.push_back(scenes::uniform(71, static_cast<std::uint64_t>(t)) < share);
      }
      const auto stays = [&](std::size_t t) { return moved[t] == 0; };
      const auto moves = [&](std::size_t t) { return moved[t] != 0; };
      auto before = random_pairs(tets, cells, 5, [](std::size_t) { return true; });
      const auto fresh = random_pairs(tets, cells, 7, moves);
      auto now = random_pairs(tets, cells, 5, stays);
      now.insert(now.end(), fresh.begin(), fresh.end());
      std::ranges::stable_sort(now, {}, tet_of);

      const Merged result =
          this->merged(this->list_of(before, frame), this->list_of(fresh, frame), moved, frame);

      const PairList expected = this->list_of(now, frame);
      EXPECT_EQ(result.pairs, this->download(expected.pairs));
      EXPECT_EQ(result.ranges, this->ranges_of(expected.ranges));
      std::vector<std::uint8_t> touched(static_cast<std::size_t>(cells), 0);
      for (const auto& list : {before, fresh}) {
        for (const CellPair pair : list) {
          if (moves(static_cast<std::size_t>(tet_of(pair)))) {
            touched[static_cast<std::size_t>(cell_of(pair))] = 1;
          }
        }
      }
      EXPECT_EQ(result.touched, touched);
      EXPECT_EQ(result.touched_count, std::ranges::count(touched, 1));
    }
  }
}

/// Tetrahedron 2 moves from cell 0 to cell 3, where 1 and 4 stay; 4 covers all of cell 3.
TYPED_TEST(CellMerge, PutsAComingTetrahedronInItsPlace) {
  const OutputFrame frame = frame_of(16, 16, 8);
  const PairList before =
      this->list_of({make_pair(3, 1, false), make_pair(0, 2, true), make_pair(3, 4, true)}, frame);
  const PairList fresh = this->list_of({make_pair(3, 2, false)}, frame);

  const Merged result = this->merged(before, fresh, {0, 0, 1, 0, 0}, frame);

  EXPECT_EQ(result.pairs, (std::vector<CellPair>{make_pair(3, 1, false), make_pair(3, 2, false),
                                                 make_pair(3, 4, true)}));
  EXPECT_EQ(result.ranges, (Ranges{{0, 0}, {0, 0}, {0, 0}, {0, 3}, {3, 3}}));
  EXPECT_EQ(result.touched, (std::vector<std::uint8_t>{1, 0, 0, 1}));
  EXPECT_EQ(result.touched_count, 2);
}

TYPED_TEST(CellMerge, LeavesOutWhatHasNoRoom) {
  const OutputFrame frame = frame_of(16, 16, 8);
  const PairList before = this->list_of({make_pair(0, 2, false), make_pair(3, 1, false)}, frame);
  const PairList fresh = this->list_of({make_pair(1, 0, true), make_pair(3, 0, false)}, frame);
  const auto pairs = this->upload(std::vector<CellPair>(4, 77));
  const auto pair_count = this->template zeros<std::int64_t>(1);
  const auto ranges = this->template zeros<CellRange>(5);

  cell_merge(this->exec(), before, fresh,
             View<const std::uint8_t>(this->upload(std::vector<std::uint8_t>{1, 0, 0})),
             View<CellPair>{pairs.data, 3}, pair_count, this->template zeros<std::int64_t>(5),
             ranges, this->template zeros<std::uint8_t>(4), this->template zeros<std::int64_t>(1));

  EXPECT_EQ(this->download(pairs),
            (std::vector<CellPair>{make_pair(0, 2, false), make_pair(1, 0, true),
                                   make_pair(3, 0, false), 77}));
  EXPECT_EQ(this->download(pair_count).front(), 4);
  EXPECT_EQ(this->ranges_of(ranges), (Ranges{{0, 1}, {1, 2}, {2, 2}, {2, 3}, {3, 3}}));
}
}  // namespace
}  // namespace tetwarp::test
