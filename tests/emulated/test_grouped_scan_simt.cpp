/// @file test_grouped_scan_simt.cpp
/// Sums of counts by one launch, for every order of threads.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "kernels/exec/grouped_scan.cuh"

namespace tetwarp::test {
namespace {
struct CountOp {
  View<const std::int64_t> counts;
  View<std::int64_t> totals;

  TETWARP_HD std::int64_t operator()(std::int64_t i) const { return counts[i]; }
  TETWARP_HD void finish(std::int64_t total, int k) const { totals[k] = total; }
};

/// Four lanes have the count in the one of that number.
struct FourLanesOp {
  static constexpr int lanes = 4;
  CountOp one;

  template <class Lanes>
  TETWARP_HD std::int64_t operator()(std::int64_t i, const Lanes& four) const {
    const std::int64_t own = four.lane == static_cast<int>(i % 4) ? one(i) : 0;
    const std::int64_t count = four.of(static_cast<int>(i % 4), own);
    return four.all(four.lane < 4) && four.lane == 0 ? count : -1;
  }
  TETWARP_HD void finish(std::int64_t total, int k) const { one.finish(total, k); }
};

/// The segment of every item.
struct SegmentOp {
  View<std::int64_t> segments;

  TETWARP_HD void operator()(std::int64_t segment, std::int64_t, std::int64_t item) const {
    segments[item] = segment;
  }
};

template <class Op>
void expect_sums_of(const std::vector<std::int64_t>& counts,
                    std::int64_t size,
                    int shift,
                    const Op& op,
                    const std::vector<std::int64_t>& totals) {
  const auto groups = static_cast<unsigned>(group_count(size, shift));
  std::vector<std::int64_t> within(counts.size() + 1), of_groups(groups + 1);
  unsigned ticket = 0;
  const GroupedSums sums{
      {within.data(), size + 1}, {of_groups.data(), groups + 1}, size + 1, shift};

  launch(nullptr, grouped_scan_kernel<Op>, groups, sum_group, 0, size, op, sums, &ticket);

  std::int64_t sum = 0;
  for (std::int64_t i = 0; i < size; ++i) {
    ASSERT_EQ(sums[i], sum) << i << " of " << size;
    sum += counts[static_cast<std::size_t>(i)];
  }
  EXPECT_EQ(sums[size], sum);
  EXPECT_EQ(sums.total(), sum);
  EXPECT_EQ(totals, std::vector<std::int64_t>(sum_group, sum));
  EXPECT_EQ(ticket, 0u);
}

TEST(GroupedScanSimt, SumsTheCountsBeforeEachInEveryOrder) {
  for (const std::int64_t size : {0, 1, 31, 255, 256, 257, 1025, 256 * 257}) {
    std::vector<std::int64_t> counts(static_cast<std::size_t>(size));
    for (std::size_t i = 0; i < counts.size(); ++i) {
      counts[i] = static_cast<std::int64_t>(i * i % 7) << (i % 5 == 0 ? 33 : 0);
    }
    std::vector<std::int64_t> totals(sum_group);
    const CountOp body{{counts.data(), size}, {totals.data(), sum_group}};
    simt::for_each_schedule([&](const simt::Schedule&) {
      expect_sums_of(counts, size, sum_shift, body, totals);
      expect_sums_of(counts, size, sum_shift - 2, FourLanesOp{body}, totals);
    });
  }
}

TEST(EachItemSimt, FindsTheSegmentOfEveryItem) {
  for (const std::int64_t size : {1, 2, 31, 33, 300, 5000}) {
    for (const std::int64_t most : {1, 5, 80}) {
      std::vector<std::int64_t> offsets{0}, want;
      for (std::int64_t s = 0; s < size; ++s) {
        const std::int64_t count = s % 97 > 40 ? 0 : (s * s + 1) % (most + 1);
        want.insert(want.end(), static_cast<std::size_t>(count), s);
        offsets.push_back(offsets.back() + count);
      }
      const auto items = std::ssize(want);
      const auto room = static_cast<std::int64_t>(items - items / 7);
      want.resize(static_cast<std::size_t>(room));
      std::vector<std::int64_t> found(want.size(), -1);
      const View<const std::int64_t> view{offsets.data(), size + 1};
      const auto blocks = static_cast<unsigned>((items + each_threads) / each_threads);

      launch(nullptr, each_item_kernel<View<const std::int64_t>, SegmentOp>, blocks, each_threads,
             0, view, room, SegmentOp{{found.data(), room}});

      EXPECT_EQ(found, want) << size << " segments";
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
