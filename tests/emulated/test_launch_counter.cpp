/// @file test_launch_counter.cpp
/// What the emulated device counts of kernels whose counts follow from a formula.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "kernels/exec/launch.hpp"
#include "tests/emulator/launch_counter.hpp"

namespace tetwarp {
namespace {
using simt::LaunchCounter, simt::LaunchCounts, simt::LaunchSample;

__global__ void strided_copy_kernel(const int* in, int* out, int stride) {
  const auto i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  out[i] = in[i * stride];
}

__global__ void twice_read_kernel(const int* in, int* out) {
  const auto i = static_cast<int>(threadIdx.x);
  out[i] = in[i] + in[31 - i];
}

/// Lane i takes turns[i] turns of a loop.
__global__ void turns_kernel(const int* turns, int* out) {
  const int lane = static_cast<int>(threadIdx.x);
  unsigned value = 1;
  for (int t = 0; t < turns[lane]; ++t) value = value * 3 + out[0];
  out[lane] = static_cast<int>(value);
}

__global__ void barriers_kernel(int* out, int count) {
  __shared__ int shared[64];
  for (int b = 0; b < count; ++b) {
    shared[threadIdx.x] = b;
    __syncthreads();
  }
  out[threadIdx.x] = shared[threadIdx.x];
}

/// Integers in memory of the emulated device, zeros.
class DeviceInts {
 public:
  explicit DeviceInts(std::size_t count) {
    cudaMalloc(&data, count * sizeof(int));
    std::fill_n(data, count, 0);
  }
  DeviceInts(const DeviceInts&) = delete;
  DeviceInts& operator=(const DeviceInts&) = delete;
  ~DeviceInts() { cudaFree(data); }

  int* data = nullptr;
};

class LaunchCounterTest : public ::testing::Test {
 protected:
  ~LaunchCounterTest() override { simt::LaunchObserver::current() = nullptr; }

  /// Counts of a launch, a basic block weighing 1.
  template <class Kernel, class... Args>
  LaunchCounts counts_of(Kernel* kernel, dim3 grid, dim3 block, const Args&... args) {
    return counts_of({}, kernel, grid, block, args...);
  }
  template <class Kernel, class... Args>
  LaunchCounts counts_of(
      LaunchSample sample, Kernel* kernel, dim3 grid, dim3 block, const Args&... args) {
    LaunchCounter counter(
        {}, [] { return simt::Device::only().ranges(); },
        [=](const std::string&, std::int64_t) { return sample; });
    simt::LaunchObserver::current() = &counter;
    launch(nullptr, kernel, grid, block, 0, args...);
    simt::LaunchObserver::current() = nullptr;
    return counter.take().at(0);
  }
};

TEST_F(LaunchCounterTest, SectorsOfStridesAreThoseThatHoldTheirBytes) {
  const DeviceInts in(32 * 32), out(32);
  for (const auto& [stride, sectors] :
       {std::pair{0, 1}, {1, 4}, {2, 8}, {4, 16}, {8, 32}, {32, 32}}) {
    const LaunchCounts counts = counts_of(strided_copy_kernel, 1, 32, in.data, out.data, stride);

    EXPECT_EQ(counts.requests, 2) << stride;
    EXPECT_EQ(counts.sectors, sectors + 4) << stride;
    EXPECT_EQ(counts.least_sectors, (stride == 0 ? 1 : 4) + 4) << stride;
    EXPECT_EQ(counts.bytes, 32 * (sectors + 4)) << stride;
  }
}

TEST_F(LaunchCounterTest, UnalignedRowsTakeOneSectorMore) {
  const DeviceInts in(40), out(32);

  const LaunchCounts counts = counts_of(strided_copy_kernel, 1, 32, in.data + 1, out.data, 1);

  EXPECT_EQ(counts.sectors, 5 + 4);
  EXPECT_EQ(counts.least_sectors, 4 + 4);
}

TEST_F(LaunchCounterTest, ABlockReadsASectorAgainFromItsCache) {
  const DeviceInts in(32), out(32);

  const LaunchCounts counts = counts_of(twice_read_kernel, 1, 32, in.data, out.data);

  EXPECT_EQ(counts.requests, 3);
  EXPECT_EQ(counts.sectors, 12);
  EXPECT_EQ(counts.block_bytes, 32 * 8);
}

TEST_F(LaunchCounterTest, BytesOfAnAllocationAreAtMostItsSize) {
  const DeviceInts in(32), out(10 * 32);

  const LaunchCounts counts = counts_of(strided_copy_kernel, 10, 32, in.data, out.data, 0);

  EXPECT_EQ(counts.block_bytes, 10 * (32 + 128));
  EXPECT_EQ(counts.bytes, 128 + 10 * 128);
}

TEST_F(LaunchCounterTest, LanesOfShorterLoopsWaitForTheLongest) {
  const DeviceInts turns(32), out(32);
  const auto counts_with = [&](int first, int others) {
    std::fill_n(turns.data, 32, others);
    turns.data[0] = first;
    return counts_of(turns_kernel, 1, 32, turns.data, out.data);
  };
  const LaunchCounts none = counts_with(1, 1), ten = counts_with(11, 11);
  const LaunchCounts one_lane = counts_with(11, 1), two = counts_with(21, 21);
  const double of_turns = ten.operations - none.operations;

  EXPECT_GE(of_turns, 10);
  EXPECT_EQ(two.operations - ten.operations, of_turns);
  EXPECT_EQ(one_lane.operations, ten.operations);
  EXPECT_EQ(ten.lane_operations - none.lane_operations, 32 * of_turns);
  EXPECT_EQ(one_lane.lane_operations - none.lane_operations, of_turns);
  EXPECT_EQ(one_lane.longest_warp, one_lane.operations);
}

TEST_F(LaunchCounterTest, BarriersCountOncePerBlock) {
  const DeviceInts out(64);
  for (const int count : {0, 1, 7}) {
    EXPECT_EQ(counts_of(barriers_kernel, 3, 64, out.data, count).barriers, 3 * count);
  }
}

TEST_F(LaunchCounterTest, ASampleOfEqualBlocksCountsAsAllOfThem) {
  const DeviceInts in(32 * 96), out(32 * 96);
  std::fill_n(in.data, 32 * 96, 1);
  const auto counts_with = [&](LaunchSample sample) {
    std::fill_n(out.data, 32 * 96, 0);
    return counts_of(sample, strided_copy_kernel, 96, 32, in.data, out.data, 1);
  };
  const LaunchCounts all = counts_with({});

  const LaunchCounts some = counts_with({8});
  EXPECT_TRUE(std::equal(in.data, in.data + 32 * 96, out.data));
  const LaunchCounts alone = counts_with({32, false});
  EXPECT_EQ(std::count(out.data, out.data + 32 * 96, 1), 3 * 32);
  const LaunchCounts twice = counts_with({1, true, 2});

  for (const LaunchCounts& counts : {some, alone}) {
    EXPECT_EQ(counts.sectors, all.sectors);
    EXPECT_EQ(counts.operations, all.operations);
    EXPECT_EQ(counts.bytes, all.bytes);
    EXPECT_EQ(counts.blocks, 96);
  }
  EXPECT_EQ(twice.operations, 2 * all.operations);
}

TEST_F(LaunchCounterTest, AWarpIsAsLongAsAllItsParts) {
  const DeviceInts out(64);
  const LaunchCounts counts = counts_of(barriers_kernel, 2, 64, out.data, 5);

  EXPECT_EQ(4 * counts.longest_warp, counts.operations);
}
}  // namespace
}  // namespace tetwarp
