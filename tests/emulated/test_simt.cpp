/// @file test_simt.cpp
/// The emulation of CUDA: correct kernels give the results of plain loops in every order of
/// threads; broken ones give other results in some order, or are reported.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "kernels/exec/launch.hpp"
#include "tests/emulated/simt_kernels.cuh"

namespace tetwarp {
namespace {
std::vector<int> numbers(int count) {
  std::vector<int> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) values[static_cast<std::size_t>(i)] = i * 7919 % 1009;
  return values;
}

template <bool has_barrier>
int sum_of(const std::vector<int>& values) {
  int sum = 0;
  const int count = static_cast<int>(values.size());
  const unsigned blocks = static_cast<unsigned>(count + 127) / 128;
  launch(nullptr, sum_kernel<has_barrier>, blocks, 128, 0, values.data(), count, &sum);
  return sum;
}

/// The text of the fault that `run` ends with, empty when it ends well.
std::string fault_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const simt::Fault& fault) {
    return fault.what();
  }
  return {};
}

TEST(Simt, SumsByShuffleLikeALoop) {
  const std::vector<int> values = numbers(10001);
  const int expected = std::accumulate(values.begin(), values.end(), 0);

  simt::for_each_schedule(
      [&](const simt::Schedule&) { EXPECT_EQ(sum_of<true>(values), expected); });
}

TEST(Simt, StencilsFromASharedTileLikeALoop) {
  const int nx = 37, ny = 21;
  const std::vector<int> in = numbers(nx * ny);
  const auto at = [&](int x, int y) {
    const int voxel = std::clamp(y, 0, ny - 1) * nx + std::clamp(x, 0, nx - 1);
    return in[static_cast<std::size_t>(voxel)];
  };
  std::vector<int> expected;
  for (int y = 0; y < ny; ++y) {
    for (int x = 0; x < nx; ++x) {
      expected.push_back(at(x - 1, y) + at(x + 1, y) + at(x, y - 1) + at(x, y + 1));
    }
  }

  simt::for_each_schedule([&](const simt::Schedule&) {
    std::vector<int> out(in.size(), -1);
    launch(nullptr, stencil_kernel, dim3(3, 3), dim3(16, 8), 0, in.data(), out.data(), nx, ny);
    EXPECT_EQ(out, expected);
  });
}

TEST(Simt, CompactsInOrderLikeALoop) {
  const std::vector<int> in = numbers(1000);
  std::vector<int> expected;
  std::copy_if(in.begin(), in.end(), std::back_inserter(expected), [](int v) { return v % 2; });

  simt::for_each_schedule([&](const simt::Schedule&) {
    std::vector<int> out(expected.size(), -1);
    int kept = 0;
    launch(nullptr, compact_kernel, 1, 96, 3 * sizeof(int), in.data(), 1000, out.data(), &kept);
    EXPECT_EQ(kept, static_cast<int>(expected.size()));
    EXPECT_EQ(out, expected);
  });
}

TEST(Simt, ShufflesStayInTheirSegment) {
  std::vector<int> broadcast(32), up(32), down(32), crossed(32);

  launch(nullptr, shuffle_kernel, 1, 32, 0, broadcast.data(), up.data(), down.data(),
         crossed.data());

  for (int lane = 0; lane < 32; ++lane) {
    const auto l = static_cast<std::size_t>(lane);
    EXPECT_EQ(broadcast[l], lane / 8 * 8 + 3);
    EXPECT_EQ(up[l], lane % 8 < 2 ? lane : lane - 2);
    EXPECT_EQ(down[l], lane % 8 > 5 ? lane : lane + 2);
    EXPECT_EQ(crossed[l], lane ^ 5);
  }
}

TEST(Simt, HalfWarpsMayExchangeAmongThemselves) {
  simt::for_each_schedule([](const simt::Schedule&) {
    std::vector<int> out(32);
    launch(nullptr, half_warp_kernel, 1, 32, 0, out.data());
    for (int lane = 0; lane < 32; ++lane) {
      EXPECT_EQ(out[static_cast<std::size_t>(lane)], lane < 16 ? lane + 16 : (lane - 16) ^ 1);
    }
  });
}

TEST(Simt, AtomicsKeepExtremes) {
  const std::vector<int> values = numbers(64);
  int low = 1 << 20, high = -1;

  launch(nullptr, extremes_kernel, 1, 64, 0, values.data(), &low, &high);

  EXPECT_EQ(low, *std::min_element(values.begin(), values.end()));
  EXPECT_EQ(high, *std::max_element(values.begin(), values.end()));
}

TEST(Simt, MissingBlockBarrierIsWrongInSomeOrder) {
  const std::vector<int> values = numbers(10001);
  const int expected = std::accumulate(values.begin(), values.end(), 0);
  int wrong = 0;

  simt::for_each_schedule(
      [&](const simt::Schedule&) { wrong += sum_of<false>(values) != expected; });

  EXPECT_GT(wrong, 0);
}

TEST(Simt, MissingWarpBarrierIsWrongInSomeOrder) {
  std::vector<unsigned> expected(32);
  for (unsigned i = 0; i < 32; ++i) expected[i] = (i + 1) % 32;
  int wrong = 0;

  simt::for_each_schedule([&](const simt::Schedule&) {
    std::vector<unsigned> out(32);
    launch(nullptr, neighbor_kernel<true>, 1, 32, 0, out.data());
    EXPECT_EQ(out, expected);
    launch(nullptr, neighbor_kernel<false>, 1, 32, 0, out.data());
    wrong += out != expected;
  });

  EXPECT_GT(wrong, 0);
}

TEST(Simt, ReportsABarrierThatSomeThreadsLeaveOut) {
  const auto run = [] { launch(nullptr, early_exit_kernel, 1, 64, 0); };

  EXPECT_NE(fault_of(run).find("thread 40 has left the kernel"), std::string::npos);
}

TEST(Simt, ReportsThreadsAtDifferentBarriers) {
  const auto run = [] { launch(nullptr, two_barriers_kernel, 1, 32, 0); };

  EXPECT_NE(fault_of(run).find("barrier not reached by all threads"), std::string::npos);
}

TEST(Simt, ReportsALaneOutsideItsMask) {
  const auto run = [] { launch(nullptr, outside_mask_kernel, 1, 32, 0); };

  EXPECT_NE(fault_of(run).find("lane 16 is outside its own mask"), std::string::npos);
}

TEST(Simt, ReportsALaneThatNeverComes) {
  const auto run = [] { launch(nullptr, missing_lane_kernel, 1, 32, 0); };

  EXPECT_NE(fault_of(run).find("for lane 7: thread 7 has left the kernel"), std::string::npos);
}

TEST(Simt, ReportsAReadFromALaneOutsideTheMask) {
  int out = 0;
  const auto run = [&] { launch(nullptr, absent_source_kernel, 1, 4, 0, &out); };

  EXPECT_NE(fault_of(run).find("reads lane 9, which takes no part"), std::string::npos);
}

TEST(Simt, ReportsLaunchesThatNoGpuTakes) {
  EXPECT_FALSE(fault_of([] { launch(nullptr, early_exit_kernel, 1, 2048, 0); }).empty());
  EXPECT_FALSE(fault_of([] { launch(nullptr, early_exit_kernel, 0, 32, 0); }).empty());
  EXPECT_FALSE(fault_of([] { launch(nullptr, early_exit_kernel, 1, 32, 1 << 20); }).empty());
}

#if defined(__SANITIZE_ADDRESS__)
TEST(Simt, SanitizersDetectTheEndOfSharedMemory) {
  std::vector<int> out(32);

  EXPECT_DEATH(launch(nullptr, overrun_kernel, 1, 32, 0, out.data()),
               "global-buffer-overflow|out of bounds");
}
#endif

TEST(Simt, RunsAgainAfterAFault) {
  fault_of([] { launch(nullptr, two_barriers_kernel, 4, 64, 0); });

  EXPECT_EQ(sum_of<true>({1, 2, 3}), 6);
}
}  // namespace
}  // namespace tetwarp
