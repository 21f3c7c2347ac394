/// @file test_cell_list_emulated.cpp
/// The sorted pairs that a device makes by counting, culled by planes or by masks, are those of the
/// stages by masks, selection and sort.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <vector>

#include "kernels/exec/exec_cuda.cuh"
#include "kernels/warp/cell_list.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
/// One index = one tetrahedron: the number of its candidate pairs, if it has moved.
struct CandidateOp {
  View<const std::int64_t> offsets;
  View<const std::uint8_t> moved;  ///< size 0: all have

  TETWARP_HD std::int64_t operator()(std::int64_t t) const {
    return moved.size == 0 || moved[t] != 0 ? offsets[t + 1] - offsets[t] : 0;
  }
  TETWARP_HD void finish(std::int64_t, int) const {}
};

/// Exclusive sums with their memory.
struct Sums {
  std::vector<std::int64_t> within, groups;
  std::int64_t size;

  explicit Sums(std::int64_t count)
      : within(static_cast<std::size_t>(count + 1)),
        groups(static_cast<std::size_t>(group_count(count) + 1)),
        size(count + 1) {}
  GroupedSums view() {
    return {{within.data(), size}, {groups.data(), group_count(size - 1) + 1}, size};
  }
};

template <class T>
View<T> whole_view(std::vector<T>& values) {
  return {values.data(), std::ssize(values)};
}

struct Made {
  std::vector<CellPair> pairs;
  std::vector<CellRange> ranges;
  std::int64_t size = 0, fresh = 0, accepted = 0, touched = 0;
};

/// The list on the emulated device.
/// @param capacity  of the list
template <class Verdict>
Made make_list(const Stages<CpuExec>& stages,
               const Verdict& verdict,
               const OutputFrame& frame,
               std::int64_t capacity,
               View<const std::uint8_t> moved = {},
               const PairList& before = {}) {
  const std::int64_t tets = stages.setups.size, cells = frame.cell_count();
  CudaExec exec(0);
  Sums candidate_sums(tets), cell_sums(cells);
  exec.grouped_scan("test", tets, CandidateOp{stages.pair_offsets, moved}, candidate_sums.view());
  const auto places = static_cast<std::size_t>(capacity);
  const auto count = static_cast<std::size_t>(cells);
  std::vector<CellPair> candidates(places), placed(places);
  std::vector<std::uint32_t> numbers(places), counts(count), stay(count);
  std::vector<std::uint8_t> touched(count);
  std::vector<std::int64_t> fresh(4), accepted(4), touched_count(4), size(1);
  Made made{std::vector<CellPair>(places), std::vector<CellRange>(count + 1)};
  cell_list(exec, candidate_sums.view(), CellCullOp<Verdict>{stages.setups, verdict, {}, frame, {}},
            {whole_view(candidates), whole_view(numbers), whole_view(counts), cell_sums.view(),
             whole_view(placed)},
            {before, moved, whole_view(stay)},
            {whole_view(made.pairs), whole_view(made.ranges), whole_view(touched),
             whole_view(fresh), whole_view(accepted), whole_view(touched_count)},
            whole_view(size));
  exec.drain();
  const auto sum = [](const std::vector<std::int64_t>& values) {
    return std::accumulate(values.begin(), values.end(), std::int64_t{0});
  };
  made.size = size[0];
  made.fresh = sum(fresh);
  made.accepted = sum(accepted);
  made.touched = sum(touched_count);
  return made;
}

/// The list of the stages by masks.
struct Expected {
  std::vector<CellPair> pairs;
  std::vector<CellRange> ranges;
  std::int64_t size = 0, accepted = 0;

  Expected(CpuExec& exec, const Stages<CpuExec>& stages, const OutputFrame& frame)
      : pairs(static_cast<std::size_t>(stages.candidates.size)),
        ranges(static_cast<std::size_t>(frame.cell_count() + 1)) {
    const std::int64_t last = stages.pair_offsets.size - 1;
    cell_pairs(exec, View<const CellPair>(stages.masked_candidates),
               {stages.pair_offsets.data + last, 1}, frame, whole_view(pairs), {&size, 1},
               whole_view(ranges), {&accepted, 1});
  }
  PairList list() const {
    return {{pairs.data(), std::ssize(pairs)}, {ranges.data(), std::ssize(ranges)}};
  }
};

void expect_same(const Made& made, const Expected& expected) {
  ASSERT_EQ(made.size, expected.size);
  EXPECT_TRUE(
      std::equal(made.pairs.begin(), made.pairs.begin() + made.size, expected.pairs.begin()));
  for (std::size_t c = 0; c < expected.ranges.size(); ++c) {
    EXPECT_EQ(made.ranges[c].begin, expected.ranges[c].begin) << "cell " << c;
    EXPECT_EQ(made.ranges[c].end, expected.ranges[c].end) << "cell " << c;
  }
}

TEST(CellListEmulated, IsThatOfMasksSelectionAndSort) {
  for (const std::int64_t voxels : {24, 70}) {
    for (const scenes::Scene& scene : scenes::adversarial_scenes(voxels)) {
      CpuExec cpu(1);
      ExecArrays<CpuExec> arrays(cpu);
      const StageInput input = input_of(scene);
      const Stages<CpuExec> stages(arrays, input);
      const Expected expected(cpu, stages, input.frame);

      const std::int64_t room = stages.candidates.size + 100;
      for (const Made& made :
           {make_list(stages, PlaneVerdict{}, input.frame, room),
            make_list(stages, stages.mask_verdict(stages.masks), input.frame, room)}) {
        SCOPED_TRACE(scene.name);
        expect_same(made, expected);
        EXPECT_EQ(made.fresh, expected.size);
        EXPECT_EQ(made.accepted, expected.accepted);
      }
    }
  }
}

/// Tetrahedra that count as moved but did not: the update gives the list that it started from.
TEST(CellListEmulated, UpdatesKeepThePairsThatStay) {
  std::int64_t all_accepted = 0;
  for (const scenes::Scene& scene : scenes::adversarial_scenes(70)) {
    SCOPED_TRACE(scene.name);
    CpuExec cpu(1);
    ExecArrays<CpuExec> arrays(cpu);
    const StageInput input = input_of(scene);
    const Stages<CpuExec> stages(arrays, input);
    const Expected expected(cpu, stages, input.frame);
    std::vector<std::uint8_t> moved(static_cast<std::size_t>(stages.setups.size));
    std::int64_t fresh = 0, accepted = 0, touched = 0;
    for (std::size_t t = 0; t < moved.size(); ++t) moved[t] = t % 3 == 0;
    for (std::int64_t c = 0; c + 1 < std::ssize(expected.ranges); ++c) {
      const std::int64_t before = fresh;
      for (std::int64_t p = expected.list().ranges[c].begin; p < end_of_cell(expected.list(), c);
           ++p) {
        const CellPair pair = expected.pairs[static_cast<std::size_t>(p)];
        fresh += tet_of(pair) % 3 == 0;
        accepted += tet_of(pair) % 3 == 0 && is_accepted(pair);
      }
      touched += fresh > before;
    }

    const Made made = make_list(stages, PlaneVerdict{}, input.frame, stages.candidates.size + 100,
                                View<const std::uint8_t>(whole_view(moved)), expected.list());

    expect_same(made, expected);
    EXPECT_EQ(made.fresh, fresh);
    EXPECT_EQ(made.accepted, accepted);
    EXPECT_EQ(made.touched, touched);
    all_accepted += accepted;
  }
  EXPECT_GT(all_accepted, 0);
}

/// The step runs again then, but no stage may read or write beyond the list.
TEST(CellListEmulated, ReportsItsSizeWhereThereIsNoRoom) {
  CpuExec cpu(1);
  ExecArrays<CpuExec> arrays(cpu);
  const StageInput input = input_of(scenes::adversarial_scene("waved", 24));
  const Stages<CpuExec> stages(arrays, input);

  const Made made = make_list(stages, PlaneVerdict{}, input.frame, 40);

  EXPECT_GT(made.size, 0);
  for (const CellRange& range : made.ranges) {
    EXPECT_LE(range.begin, range.end);
    EXPECT_LE(range.end, 40u);
  }
}
}  // namespace
}  // namespace tetwarp::test
