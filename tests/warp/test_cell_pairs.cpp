/// @file test_cell_pairs.cpp
/// Pairs are sorted by cell, then tetrahedron, and end at the first accepted one of the cell.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
/// Results of the stage.
struct SortedPairs {
  std::vector<CellPair> pairs;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;
  std::int64_t accepted = 0;

  bool operator==(const SortedPairs&) const = default;
};

/// The same by definition.
SortedPairs sorted_by_definition(std::vector<CellPair> pairs, std::int64_t cell_count) {
  std::erase(pairs, rejected_pair);
  std::ranges::stable_sort(pairs, {}, cell_of);
  SortedPairs result;
  std::uint32_t p = 0;
  for (std::int64_t cell = 0; cell < cell_count; ++cell) {
    std::uint32_t begin = p, end = p;
    bool settled = false;
    for (; p < pairs.size() && cell_of(pairs[p]) == cell; ++p) {
      if (!settled) end = p + 1;
      settled = settled || is_accepted(pairs[p]);
      result.accepted += is_accepted(pairs[p]);
    }
    result.ranges.emplace_back(begin, end);
  }
  result.pairs = std::move(pairs);
  return result;
}

template <class Exec>
class CellPairs : public EachExec<Exec> {
 protected:
  SortedPairs sorted(const std::vector<CellPair>& candidates, const OutputFrame& frame) {
    const auto size = static_cast<std::int64_t>(candidates.size());
    const auto pairs = this->template zeros<CellPair>(size);
    const auto pair_count = this->template zeros<std::int64_t>(1);
    const auto ranges = this->template zeros<CellRange>(frame.cell_count());
    const auto accepted = this->template zeros<std::int64_t>(1);
    cell_pairs(this->exec(), View<const CellPair>(this->upload(candidates)),
               View<const std::int64_t>(this->upload(std::vector<std::int64_t>{size})), frame,
               pairs, pair_count, ranges, accepted);
    SortedPairs result;
    const std::int64_t kept = this->download(pair_count).front();
    result.pairs = this->download(View<CellPair>{pairs.data, kept});
    for (const CellRange& range : this->download(ranges)) {
      result.ranges.emplace_back(range.begin, range.end);
    }
    result.accepted = this->download(accepted).front();
    return result;
  }
};
TYPED_TEST_SUITE(CellPairs, HostExecs, ExecNames);

/// Candidates as cell_cull gives them: by tetrahedron, then cell.
std::vector<CellPair> candidates_of(std::int64_t count, std::int64_t cells, double accepted) {
  std::vector<CellPair> pairs;
  for (std::int64_t p = 0; p < count; ++p) {
    const auto at = static_cast<std::uint64_t>(3 * p);
    const auto cell =
        static_cast<std::int64_t>(scenes::uniform(41, at) * static_cast<double>(cells));
    const bool rejected = scenes::uniform(41, at + 1) < 0.4;
    const bool settles = scenes::uniform(41, at + 2) < accepted;
    pairs.push_back(rejected ? rejected_pair : make_pair(cell, p, settles));
  }
  return pairs;
}

TYPED_TEST(CellPairs, KeepATetrahedronACellAndAVerdictInOneWord) {
  const CellPair pair = make_pair(0xfffffffe, 0x7fffffff, true);

  EXPECT_EQ(cell_of(pair), 0xfffffffe);
  EXPECT_EQ(tet_of(pair), 0x7fffffff);
  EXPECT_TRUE(is_accepted(pair));
  EXPECT_FALSE(is_accepted(make_pair(0xfffffffe, 0x7fffffff, false)));
}

/// Cell 2 holds tetrahedra 0, 1, 3 and 4; 1 and 4 are accepted, so 3 and 4 are dropped.
TYPED_TEST(CellPairs, EndACellBehindItsFirstAcceptedTetrahedron) {
  const std::vector<CellPair> candidates = {
      make_pair(2, 0, false), make_pair(5, 0, false), make_pair(2, 1, true), rejected_pair,
      make_pair(2, 3, false), make_pair(0, 4, true),  make_pair(2, 4, true)};

  const SortedPairs found = this->sorted(candidates, frame_of(16, 16, 16));

  EXPECT_EQ(found.pairs, (std::vector<CellPair>{make_pair(0, 4, true), make_pair(2, 0, false),
                                                make_pair(2, 1, true), make_pair(2, 3, false),
                                                make_pair(2, 4, true), make_pair(5, 0, false)}));
  using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  EXPECT_EQ(found.ranges, (Ranges{{0, 1}, {1, 1}, {1, 3}, {5, 5}, {5, 5}, {5, 6}, {6, 6}, {6, 6}}));
  EXPECT_EQ(found.accepted, 3);
}

TYPED_TEST(CellPairs, AreSortedWithTheirRangesForAnySize) {
  for (const std::int64_t size : tricky_sizes) {
    for (const double accepted : {0.0, 0.1, 1.0}) {
      const OutputFrame frame = frame_of(40, 24, 33);
      const auto candidates = candidates_of(size, frame.cell_count(), accepted);
      EXPECT_EQ(this->sorted(candidates, frame),
                sorted_by_definition(candidates, frame.cell_count()));
    }
  }
}

TYPED_TEST(CellPairs, HoldThousandsInOneCell) {
  const OutputFrame frame = frame_of(8, 8, 8);
  const auto candidates = candidates_of(5000, 1, 0.001);

  EXPECT_EQ(this->sorted(candidates, frame), sorted_by_definition(candidates, 1));
}

TYPED_TEST(CellPairs, LeaveEveryCellEmptyWhenAllAreRejected) {
  const SortedPairs found =
      this->sorted(std::vector<CellPair>(33, rejected_pair), frame_of(16, 8, 8));

  EXPECT_TRUE(found.pairs.empty());
  for (const auto& [begin, end] : found.ranges) EXPECT_EQ(begin, end);
  EXPECT_EQ(found.accepted, 0);
}
}  // namespace
}  // namespace tetwarp::test
