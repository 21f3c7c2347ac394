/// @file test_contact_grid_simt.cpp
/// The executor of the contact pipeline on the whole emulated device.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "host/contact/sweeps/run.hpp"
#include "tests/scenes/contact_scenes.hpp"
#include "tests/scenes/contact_stages.hpp"
#include "tests/scenes/contact_sweeps.hpp"

#include "kernels/contact/contact_grid.cuh"

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
  CpuContactExec cpu(1);
  cpu.for_each("", island.contact_count(),
               ContactVelocityBody<DelassusView<double>, double>{
                   scene.system.numbers(scene.structure.indices()).delassus, impulse.data(),
                   view_of(velocity)});
  const ContactResidualBody<double> body = {view_of(scene.system.constants),
                                            {},
                                            view_of(std::as_const(impulse)),
                                            view_of(std::as_const(velocity)),
                                            view_of(scene.system.free_velocity)};
  std::vector<double> first;
  simt::for_each_schedule([&](const simt::Schedule&) {
    CudaExec exec(0);
    GridContactExec grid(exec);
    const auto sums = grid.sum<ContactSums>("", 0, island.contact_count(), body);
    if (first.empty()) first = {sums.eta};
    EXPECT_EQ(sums.eta, first[0]);
    EXPECT_NEAR(sums.eta, host.sums.eta, 1e-12 * host.sums.eta);
    EXPECT_NEAR(sums.fclib, host.sums.fclib, 1e-12 * host.sums.fclib);
    EXPECT_EQ(sums.deepest, host.sums.deepest);
    EXPECT_EQ(sums.largest_contact, host.sums.largest_contact);
  });
}
}  // namespace
}  // namespace tetwarp::test
