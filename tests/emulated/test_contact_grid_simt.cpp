/// @file test_contact_grid_simt.cpp
/// The executor of the contact pipeline on the whole emulated device, and arrays that it stages.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <vector>

#include "host/contact/sweeps/run.hpp"
#include "tests/emulated/device_calls.hpp"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/contact/contact_stages.hpp"
#include "tests/support/contact/contact_sweeps.hpp"

#include "kernels/contact/cuda/grid_island.cuh"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/exec/staged_arrays.cuh"

namespace tetwarp::test {
namespace {
/// The sums of a whole device: its own fixed tree, for any order of threads.
TEST(ContactGridSimt, LargeIslandsAreSummedInAFixedTree) {
  const SweepScene scene(scenes::random_local({.seed = 12, .contacts = 2500}), false);
  std::vector<double> impulse(scene.system.free_velocity.size(), 0.001);
  const ContactIsland& island = scene.structure.islands[0];
  const HostSweeps<double> host =
      sweep_on_host(scene.structure, scene.system, island, {}, impulse, 0);
  std::vector<double> velocity(impulse.size());
  CpuExec cpu(1);
  cpu.for_each("", island.contact_count(),
               ContactVelocityOp<DelassusView<double>, double>{
                   scene.system.numbers(scene.structure.indices()).delassus, impulse.data(),
                   view_of(velocity)});
  const ContactResidualOp<double> body = {view_of(scene.system.constants),
                                          {},
                                          view_of(std::as_const(impulse)),
                                          view_of(std::as_const(velocity)),
                                          view_of(scene.system.free_velocity)};
  std::vector<double> first;
  simt::for_each_schedule([&](const simt::Schedule&) {
    CudaExec exec(0, StageClocks::off);
    const auto sums = exec.sum<ContactSums>("", 0, island.contact_count(), body);
    if (first.empty()) first = {sums.eta};
    EXPECT_EQ(sums.eta, first[0]);
    EXPECT_NEAR(sums.eta, host.sums.eta, 1e-12 * host.sums.eta);
    EXPECT_NEAR(sums.fclib, host.sums.fclib, 1e-12 * host.sums.fclib);
    EXPECT_EQ(sums.deepest, host.sums.deepest);
    EXPECT_EQ(sums.largest_contact, host.sums.largest_contact);
  });
}

/// Packings are for a grid from some size on; a chain, whose colors are as many as its contacts,
/// and many packings side by side are not.
TEST(ContactGridSimt, GridsSolveFewLargeIslands) {
  const auto times = [](std::int64_t contacts, std::int64_t colors) {
    ContactIsland island;
    island.slot_end = contacts;
    island.color_end = colors + 1;
    return sweep_times(island, 850 * contacts);
  };
  const auto by_grid = [&](std::int64_t islands, std::int64_t contacts, std::int64_t colors) {
    return count_by_grid(
        std::vector<TeamTimes>(static_cast<std::size_t>(islands), times(contacts, colors)), 132);
  };
  EXPECT_EQ(by_grid(1, 40, 8), 0U);
  EXPECT_EQ(by_grid(1, 800, 10), 0U);
  EXPECT_EQ(by_grid(1, 2000, 10), 1U);
  EXPECT_EQ(by_grid(1, 2000, 2000), 0U);
  EXPECT_EQ(by_grid(100, 2000, 10), 0U);
  EXPECT_EQ(by_grid(1, 100000, 12), 1U);
}

struct Staged {
  std::uint8_t kind = 0;
  double value = 0;
  bool operator==(const Staged&) const = default;
};

template <class T>
std::vector<T> numbers(std::int64_t count, int first) {
  std::vector<T> values(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if constexpr (std::is_same_v<T, Staged>) {
      values[i] = {static_cast<std::uint8_t>(first), 0.5 * static_cast<double>(i)};
    } else {
      values[i] = static_cast<T>(first + static_cast<int>(i));
    }
  }
  return values;
}

/// Expects a view of memory of the device, aligned to 16 bytes, with what numbers() gave.
template <class T>
void expect_numbers(const CudaExec& exec,
                    const View<const T>& found,
                    std::int64_t count,
                    int first) {
  ASSERT_EQ(found.size, count);
  std::vector<T> values(static_cast<std::size_t>(count));
  exec.get(found, values.data());
  EXPECT_EQ(values, numbers<T>(count, first));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(found.data) % 16, 0u);
}

/// Sizes that grow and shrink, with empty arrays; sizes in bytes are mostly no multiples of 16.
TEST(StagedArraysSimt, WhatIsPutArrivesByOneCopy) {
  CudaExec exec(0, StageClocks::off);
  StagedArrays staged, other;
  const std::vector<std::int64_t> few = {1, 0, 3, 2};
  const std::vector<std::vector<std::int64_t>> sizes = {
      {0, 0, 0, 0}, {1, 2, 3, 5}, {0, 31, 0, 1}, {1025, 33, 32, 0}, {0, 0, 0, 0}, {7, 0, 1, 1025}};
  std::int64_t most = 0;
  for (const std::vector<std::int64_t>& size : sizes) {
    SCOPED_TRACE(testing::PrintToString(size));
    const auto put = [&](StagedArrays& to, const std::vector<std::int64_t>& of, int first) {
      auto bytes = numbers<std::uint8_t>(of[0], first);
      auto integers = numbers<std::int32_t>(of[1], first + 1);
      auto reals = numbers<double>(of[2], first + 2);
      auto structs = numbers<Staged>(of[3], first + 3);
      const auto views = to.put(exec, bytes, integers, reals, structs);
      bytes.assign(bytes.size(), 99);  // they are not read after the call
      integers.assign(integers.size(), 99);
      reals.assign(reals.size(), 99);
      return views;
    };
    take_calls();
    const auto views = put(staged, size, 1);
    const DeviceCalls calls = take_calls();
    const auto others = put(other, few, 50);
    expect_numbers(exec, std::get<0>(views), size[0], 1);
    expect_numbers(exec, std::get<1>(views), size[1], 2);
    expect_numbers(exec, std::get<2>(views), size[2], 3);
    expect_numbers(exec, std::get<3>(views), size[3], 4);
    expect_numbers(exec, std::get<2>(others), few[2], 52);
    const std::int64_t sum = size[0] + size[1] + size[2] + size[3];
    EXPECT_EQ(calls.count(DeviceCall::copy_to_device), sum > 0 ? 1 : 0);
    std::int64_t room = 0;
    const std::int64_t bytes[] = {size[0], 4 * size[1], 8 * size[2], 16 * size[3]};
    for (const std::int64_t own : bytes) room += (own + 15) / 16 * 16;
    EXPECT_EQ(calls.count(DeviceCall::allocate), room > most ? 1 : 0);
    most = std::max(most, room);
  }
}
}  // namespace
}  // namespace tetwarp::test
