/// @file test_staging_ring_emulated.cpp
/// The ring on the emulated device, whose copies run as late as CUDA permits, or as early: all bits
/// arrive, nothing else is written, and an error leaves the ring usable.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <tetwarp/error.hpp>
#include <utility>
#include <vector>

#include "kernels/exec/exec_cuda.cuh"
#include "tests/emulated/device_calls.hpp"

namespace tetwarp::test {
namespace {
using Bytes = std::vector<std::byte>;

Bytes numbered(std::size_t size, std::size_t first = 0) {
  Bytes bytes(size);
  for (std::size_t b = 0; b < size; ++b) bytes[b] = static_cast<std::byte>((first + b) % 251);
  return bytes;
}

/// Adds one to every byte.
__global__ void next_kernel(std::byte* bytes, std::size_t size) {
  for (std::size_t b = 0; b < size; ++b) {
    bytes[b] = static_cast<std::byte>(static_cast<unsigned>(bytes[b]) + 1);
  }
}
/// As an access to memory that is not there.
__global__ void failing_kernel() {
  simt::Device::only().failure = cudaErrorIllegalAddress;
}

class EmulatedStaging : public ::testing::TestWithParam<int> {
 protected:
  EmulatedStaging() : ring(0, {.slot_bytes = 256, .slots = 3, .threads = GetParam()}) {
    device.reserve(static_cast<std::int64_t>(size));
  }
  void TearDown() override {
    simt::Device::only().eager_stream = simt::Device::none;
    simt::Device::only().failure = cudaSuccess;
    cudaGetLastError();
  }

  static constexpr std::size_t size = 20011;
  std::byte* memory() const { return device.view(0).data; }
  /// Sets the memory of the device.
  void put(const Bytes& bytes) {
    cudaMemcpyAsync(memory(), bytes.data(), bytes.size(), cudaMemcpyHostToDevice, stream);
  }

  DeviceStream stream;
  DeviceBuffer<std::byte> device;
  StagingRing ring;
};
INSTANTIATE_TEST_SUITE_P(Threads,
                         EmulatedStaging,
                         ::testing::Values(1, 2, 5),
                         [](const auto& info) { return std::to_string(info.param); });

TEST_P(EmulatedStaging, DownloadsThePartAndNothingElse) {
  const Bytes source = numbered(size);
  put(source);
  for (const SliceBytes& part :
       {SliceBytes{1, 1, 1, 1}, SliceBytes{size, 1, 1, 1}, SliceBytes{31, 5, 5, 33},
        SliceBytes{31, 5, 9, 33}, SliceBytes{7, 3, 11, 200}, SliceBytes{100, 6, 10, 20}}) {
    for (const int ahead : {simt::Device::none, 0}) {
      simt::Device::only().eager_stream = ahead;
      Bytes to(size, std::byte{0xee}), expected = to;
      for (std::size_t k = 0; k < part.slices; ++k) {
        const std::size_t at = k * part.row * part.pitch;
        std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(at), part.row * part.rows,
                    expected.begin() + static_cast<std::ptrdiff_t>(at));
      }

      ring.download(memory(), to.data(), part, stream);

      EXPECT_TRUE(to == expected) << part.row << " x " << part.rows << " x " << part.slices;
    }
  }
}

TEST_P(EmulatedStaging, DownloadsFollowTheWorkOfTheirStream) {
  put(numbered(size));
  Bytes to(size);
  for (std::size_t step = 1; step <= 3; ++step) {
    launch(stream, next_kernel, 1, 1, 0, memory(), size);

    ring.download(memory(), to.data(), {size, 1, 1, 1}, stream);

    Bytes expected = numbered(size);
    for (std::byte& b : expected) b = static_cast<std::byte>(static_cast<unsigned>(b) + step);
    EXPECT_TRUE(to == expected) << step;
  }
}

/// Uploads are still on their way when the next copy takes the ring.
TEST_P(EmulatedStaging, UploadsReadTheHostsMemoryBeforeTheyReturn) {
  DeviceStream other;
  DeviceBuffer<std::byte> second;
  second.reserve(static_cast<std::int64_t>(size));
  Bytes from = numbered(size, 3), to(size);
  ring.upload(from.data(), memory(), size, stream);
  from = numbered(size, 5);
  ring.upload(from.data(), second.view(0).data, size, other);
  from.assign(size, std::byte{0});

  ring.download(memory(), to.data(), {size, 1, 1, 1}, stream);
  EXPECT_TRUE(to == numbered(size, 3));
  ring.download(second.view(0).data, to.data(), {size, 1, 1, 1}, other);
  EXPECT_TRUE(to == numbered(size, 5));
}

TEST_P(EmulatedStaging, AnErrorOfTheDeviceIsThrownOnceAndLeavesTheRingUsable) {
  put(numbered(size));
  Bytes to(size);
  launch(stream, failing_kernel, 1, 1, 0);

  try {
    ring.download(memory(), to.data(), {size, 1, 1, 1}, stream);
    FAIL() << "no error";
  } catch (const CudaError& error) {
    EXPECT_NE(std::string(error.what()).find("illegal memory access"), std::string::npos);
  }
  EXPECT_THROW(ring.upload(to.data(), memory(), size, stream), CudaError);
  EXPECT_EQ(cudaPeekAtLastError(), cudaSuccess);

  simt::Device::only().failure = cudaSuccess;
  const Bytes from = numbered(size, 7);
  ring.upload(from.data(), memory(), size, stream);
  ring.download(memory(), to.data(), {size, 1, 1, 1}, stream);
  EXPECT_TRUE(to == from);
}

TEST(EmulatedExec, LargeArraysTakeTheRingUnlessTheyArePageLocked) {
  CudaExec exec(0);
  std::vector<float> values(std::size_t{3} << 19);  // 6 MiB: more than two pieces
  ASSERT_GE(values.size() * sizeof(float), StagingRing::least_bytes);
  std::iota(values.begin(), values.end(), 0.0f);
  const std::vector<float> expected = values;
  DeviceVector<float> far;
  const auto copies_of_round_trip = [&] {
    take_calls();
    exec.put(values, far);
    exec.wait();
    values.assign(values.size(), -1.0f);
    exec.get(std::as_const(far).view(), values.data());
    const DeviceCalls calls = take_calls();
    return std::pair(calls.count(DeviceCall::copy_to_device),
                     calls.count(DeviceCall::copy_to_host));
  };

  const auto [up, down] = copies_of_round_trip();
  EXPECT_GT(up, 2);
  EXPECT_GT(down, 2);
  EXPECT_TRUE(values == expected);

  ASSERT_EQ(cudaHostRegister(values.data(), values.size() * sizeof(float), 1), cudaSuccess);
  EXPECT_EQ(copies_of_round_trip(), std::pair(std::int64_t{1}, std::int64_t{1}));
  cudaHostUnregister(values.data());
}
}  // namespace
}  // namespace tetwarp::test
