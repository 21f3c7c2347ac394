/// @file test_grouped_scan_simt.cpp
/// Sums of counts by one launch, for every order of threads.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "kernels/exec/grouped_scan.cuh"

namespace tetwarp::test {
namespace {
struct CountBody {
  View<const std::int64_t> counts;
  View<std::int64_t> totals;

  TETWARP_HD std::int64_t operator()(std::int64_t i) const { return counts[i]; }
  TETWARP_HD void finish(std::int64_t total, int k) const { totals[k] = total; }
};

TEST(GroupedScanSimt, SumsTheCountsBeforeEachInEveryOrder) {
  for (const std::int64_t size : {0, 1, 31, 255, 256, 257, 1025, 256 * 257}) {
    std::vector<std::int64_t> counts(static_cast<std::size_t>(size));
    for (std::size_t i = 0; i < counts.size(); ++i) {
      counts[i] = static_cast<std::int64_t>(i * i % 7) << (i % 5 == 0 ? 33 : 0);
    }
    const auto groups = static_cast<unsigned>(group_count(size));
    simt::for_each_schedule([&](const simt::Schedule&) {
      std::vector<std::int64_t> within(counts.size() + 1), of_groups(groups + 1), totals(sum_group);
      unsigned ticket = 0;
      const GroupedSums sums{{within.data(), size + 1}, {of_groups.data(), groups + 1}, size + 1};

      launch(nullptr, grouped_scan_kernel<CountBody>, groups, sum_group, 0, size,
             CountBody{{counts.data(), size}, {totals.data(), sum_group}}, sums, &ticket);

      std::int64_t sum = 0;
      for (std::int64_t i = 0; i < size; ++i) {
        ASSERT_EQ(sums[i], sum) << i << " of " << size;
        sum += counts[static_cast<std::size_t>(i)];
      }
      EXPECT_EQ(sums[size], sum);
      EXPECT_EQ(sums.total(), sum);
      EXPECT_EQ(totals, std::vector<std::int64_t>(sum_group, sum));
      EXPECT_EQ(ticket, 0u);
    });
  }
}
}  // namespace
}  // namespace tetwarp::test
