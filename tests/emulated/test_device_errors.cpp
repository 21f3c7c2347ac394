/// @file test_device_errors.cpp
/// Errors of the device, the caller's current device and default stream, and recorded sweeps.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/warp.hpp>

#include "kernels/exec/exec_stream.cuh"
#include "kernels/exec/part_graphs.cuh"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
simt::Device& device() {
  return simt::Device::only();
}

class DeviceErrors : public testing::Test {
 protected:
  void TearDown() override {
    device().failing_allocation = simt::Device::none;
    device().failure = cudaSuccess;
    cudaSetDevice(0);
    cudaGetLastError();
  }

  scenes::Scene scene_ = scenes::adversarial_scene("waved", 16);
  Volume source_ = scenes::wavy_volume(scene_.source_grid, PixelType::float32);
  ContactProblem problem_ = scenes::sphere_packing({.seed = 11, .edge = 3, .kept = 0.3});

  std::vector<std::byte> warped(Backend backend) const {
    WarpOptions options;
    options.backend = backend;
    options.output_grid = scene_.output_grid;
    return warp(source_, scene_.mesh, scene_.deformed, options).volume.data;
  }
  std::vector<double> impulses() const {
    return solve_contacts(problem_, {.backend = Backend::cuda}).impulse;
  }
};

/// Calls work() with each of its allocations failing in turn, the first of them, the second ...
template <class Work>
int fail_each_allocation(const Work& work) {
  for (int k = 0;; ++k) {
    device().failing_allocation = k;
    try {
      work();
      device().failing_allocation = simt::Device::none;
      return k;
    } catch (const CudaError& error) {
      EXPECT_NE(std::string(error.what()).find("out of memory"), std::string::npos) << error.what();
    }
    EXPECT_EQ(cudaPeekAtLastError(), cudaSuccess) << "left behind by allocation " << k;
    cudaGetLastError();
  }
}

TEST_F(DeviceErrors, AFailedAllocationEndsItsOwnCallOnly) {
  const std::vector<std::byte> wanted = warped(Backend::cpu);

  EXPECT_GT(fail_each_allocation([&] { warped(Backend::cuda); }), 10);
  EXPECT_GT(fail_each_allocation([&] { impulses(); }), 10);

  EXPECT_EQ(warped(Backend::cuda), wanted);
}

TEST_F(DeviceErrors, AFailedDeviceIsReportedByEveryCallAndObjectsCanBeDestroyed) {
  const std::vector<VolumeView> views = {source_};
  WarpOptions options;
  options.backend = Backend::cuda;
  options.output_grid = scene_.output_grid;
  std::vector<std::byte> output(source_.data.size());
  {
    Warper warper(views, scene_.mesh, options);
    ContactSolver solver({.backend = Backend::cuda});
    solver.solve(problem_);
    output.resize(static_cast<std::size_t>(warper.output_grid().voxel_count()) * sizeof(float));
    void* const pointer = output.data();
    device().failure = cudaErrorIllegalAddress;
    for (int step = 0; step < 2; ++step) {
      EXPECT_THROW(warper.step(scene_.deformed, {.volumes = {&pointer, 1}}), CudaError);
      EXPECT_THROW(solver.solve(problem_), CudaError);
    }
  }
  device().failure = cudaSuccess;
  EXPECT_EQ(warped(Backend::cuda), warped(Backend::cpu));
}

TEST_F(DeviceErrors, TheCallersCurrentDeviceStaysCurrent) {
  const std::vector<std::byte> wanted = warped(Backend::cpu);
  const std::vector<double> wanted_impulses = impulses();
  ASSERT_EQ(cudaSetDevice(1), cudaSuccess);

  EXPECT_EQ(warped(Backend::cuda), wanted);
  EXPECT_EQ(impulses(), wanted_impulses);

  int current = -1;
  cudaGetDevice(&current);
  EXPECT_EQ(current, 1);
}

/// Device memory that a copy on the default stream is still to fill when the step begins.
TEST_F(DeviceErrors, StepsWithoutAStreamWaitForTheDefaultStream) {
  const std::size_t node_bytes = scene_.deformed.size() * sizeof(Point3);
  double* positions = nullptr;
  void* source = nullptr;
  ASSERT_EQ(cudaMalloc(&positions, node_bytes), cudaSuccess);
  ASSERT_EQ(cudaMalloc(reinterpret_cast<std::byte**>(&source), source_.data.size()), cudaSuccess);
  WarpOptions options;
  options.backend = Backend::cuda;
  options.output_grid = scene_.output_grid;
  const VolumeView on_device(source_.grid, source_.type, 1, source, Memory::device);
  const auto put = [](void* to, const void* from, std::size_t size) {
    cudaMemcpyAsync(to, from, size, cudaMemcpyHostToDevice, nullptr);
  };
  for (const bool has_device_source : {false, true}) {
    const std::vector<VolumeView> views = {has_device_source ? on_device : VolumeView(source_)};
    Warper warper(views, scene_.mesh, options);
    std::vector<std::byte> output(static_cast<std::size_t>(warper.output_grid().voxel_count()) *
                                  sizeof(float));
    void* const pointer = output.data();
    put(positions, scene_.deformed.data(), node_bytes);
    put(source, source_.data.data(), source_.data.size());

    warper.step({positions, static_cast<std::int64_t>(scene_.deformed.size()), Memory::device},
                {.volumes = {&pointer, 1}});

    EXPECT_EQ(output, warped(Backend::cpu)) << has_device_source;
  }
  cudaFree(positions);
  cudaFree(source);
}

/// One index: adds a number to an entry.
struct AddOp {
  double* values;
  double amount;
  bool operator==(const AddOp&) const = default;
  TETWARP_HD void operator()(std::int64_t i) const { values[i] += amount; }
};

/// A recorded launch keeps the arguments of its recording.
TEST_F(DeviceErrors, ASweepIsRecordedAgainWhenAnyArgumentChanged) {
  DeviceStream stream;
  DeviceBuffer<double> values;
  values.reserve(3);
  cudaMemsetAsync(values.view(3).data, 0, 3 * sizeof(double), stream);
  const std::vector<std::int64_t> colors = {0, 2, 3};
  const View<const std::int64_t> color_start{colors.data(), 3};
  PartGraphs graphs;
  for (const double amount : {1.0, 10.0, 1.0}) {
    graphs.launch(stream, 132, color_start, AddOp{values.view(3).data, amount});
  }
  std::vector<double> sums(3);
  cudaMemcpyAsync(sums.data(), values.view(3).data, 3 * sizeof(double), cudaMemcpyDeviceToHost,
                  stream);

  EXPECT_EQ(sums, (std::vector<double>{12, 12, 12}));
}

template <int number>
__global__ void nothing_kernel() {}

TEST_F(DeviceErrors, CapturesLoadNoKernelAndAllocateNothing) {
  DeviceStream stream;
  {
    const StreamCapture capture(stream);
    EXPECT_THROW(launch(stream, nothing_kernel<0>, 1, 1, 0), simt::Fault);
    double* memory = nullptr;
    EXPECT_EQ(cudaMalloc(&memory, 8), cudaErrorStreamCaptureUnsupported);
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaErrorStreamCaptureUnsupported);
  }
  launch(stream, nothing_kernel<0>, 1, 1, 0);
  const StreamCapture capture(stream);
  EXPECT_NO_THROW(launch(stream, nothing_kernel<0>, 1, 1, 0));
}

TEST_F(DeviceErrors, StreamsBelongToADevice) {
  DeviceStream stream;
  const DeviceScope other(1);

  EXPECT_THROW(launch(stream, nothing_kernel<1>, 1, 1, 0), simt::Fault);
}
}  // namespace
}  // namespace tetwarp::test
