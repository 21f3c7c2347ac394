/// @file test_each_shape.cpp
/// How loops of a device are divided into blocks, and sums over lanes.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "host/exec/exec_cpu.hpp"
#include "kernels/base/plain_sums.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp::test {
namespace {

TEST(EachShape, HasABlockForEachMultiprocessorWhereTheCountAllows) {
  for (const std::int64_t multiprocessors : {1, 4, 132}) {
    for (const std::int64_t count : {1, 31, 32, 33, 300, 1025, 4224, 33792, 1000000}) {
      const EachShape shape = each_shape(count, multiprocessors);
      const std::int64_t blocks = shape.blocks, threads = shape.threads;
      EXPECT_GE(blocks * threads, count);
      EXPECT_LT((blocks - 1) * threads, count);
      EXPECT_TRUE(threads == 32 || threads == 64 || threads == 128 || threads == 256);
      EXPECT_TRUE(threads == 32 || blocks >= multiprocessors);
      EXPECT_TRUE(threads == each_threads || (count + 2 * threads - 1) / (2 * threads) <
                                                 multiprocessors);  // no larger ones would do
    }
  }
}

/// Numbers of which each lane takes some, so that the order of additions shows in the sum.
template <int lane_count>
struct ThirdsOp {
  using Sum = PlainSums<2>;
  static constexpr int lanes = lane_count;

  View<double> sums;

  TETWARP_HD Sum part(std::int64_t i, int lane) const {
    Sum sum;
    for (std::int64_t k = lane; k < 5 * i; k += lanes) {
      sum.value[0] += 1 / (3.0 + static_cast<double>(k));
      sum.value[1] += 1;
    }
    return sum;
  }
  TETWARP_HD void finish(std::int64_t i, const Sum& sum) const {
    sums[i] = sum.value[1] == static_cast<double>(5 * i) ? sum.value[0] : -1;
  }
};

template <int lanes>
void expect_equal_sums() {
  for (const std::int64_t count : {0, 1, 31, 32, 33, 1025}) {
    SCOPED_TRACE(count);
    std::vector<double> expected(static_cast<std::size_t>(count), -2), found = expected;
    CpuExec(1).for_each_by_lanes("", count, ThirdsOp<lanes>{{expected.data(), count}});
    CudaExec exec(0, StageClocks::off);
    simt::for_each_schedule([&](const simt::Schedule&) {
      exec.for_each_by_lanes("", count, ThirdsOp<lanes>{{found.data(), count}});
      exec.wait();
      EXPECT_EQ(found, expected);
    });
    for (std::int64_t i = 0; i < count; ++i) EXPECT_GE(expected[static_cast<std::size_t>(i)], 0);
  }
}

TEST(EachByLanes, SumsHaveTheBitsOfTheHost) {
  expect_equal_sums<4>();
  expect_equal_sums<32>();
}

/// Any number of terms has so few runs that one block sums them, and a sum never needs more memory
/// than one of more terms was promised.
TEST(GridSum, RunsAreAsManyAsMultiprocessorsButNotTooMany) {
  for (std::int64_t terms = 1; terms < std::int64_t{1} << 40; terms = terms * 3 / 2 + 1) {
    const std::int64_t runs = sum_runs_of(terms), run = sum_run_of(terms);
    EXPECT_GE(runs * run, terms);
    EXPECT_LE(runs, most_sum_runs);
    EXPECT_TRUE(run == sum_threads || 2 * runs >= most_sum_runs);
    EXPECT_LE(runs, most_sum_runs_of(terms));
    EXPECT_LE(most_sum_runs_of(terms), most_sum_runs_of(terms + 1));
  }
}

}  // namespace
}  // namespace tetwarp::test
