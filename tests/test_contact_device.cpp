/// @file test_contact_device.cpp
/// Contact sweeps on a device against those of the host; skipped where no device answers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/error.hpp>

#include "host/warp_backend.hpp"
#include "tests/contact_sweeps.hpp"

namespace tetwarp::test {
namespace {

class ContactDeviceCuda : public testing::Test {
 protected:
  void SetUp() override {
    const BackendStatus status = cuda_status(0);
    if (!status.usable) GTEST_SKIP() << status.reason;
    device_ = make_contact_device(0);
  }

  /// 19 sweeps of all islands, held against as many on the host. The device may fuse products and
  /// sums: a difference of rounding, which sweeps do not let grow.
  void expect_host_sweeps(const SweepScene& scene) {
    const SweepTask task =
        scene.task({true, 0, 19, std::numeric_limits<std::int64_t>::max()}, {}, 0);
    const std::vector<double> start(scene.system.free_velocity.size(), 0.001);
    std::vector<double> best = start, again = start;

    const auto progress = device_->sweep(task, scene.structure, scene.system, best);
    device_->sweep(task, scene.structure, scene.system, again);

    EXPECT_EQ(best, again);
    for (std::size_t k = 0; k < task.islands.size(); ++k) {
      const ContactIsland& island = scene.structure.islands[k];
      const HostSweeps<double> host =
          sweep_on_host(scene.structure, scene.system, island, {}, start, progress[k].best_sweep);
      const std::vector<double> part = part_of(best, island);
      double difference = 0, size = 0;
      for (std::size_t i = 0; i < part.size(); ++i) {
        difference += square_of(part[i] - host.impulse[i]);
        size += square_of(host.impulse[i]);
      }
      EXPECT_LE(std::sqrt(difference), 1e-10 * std::sqrt(size));
      EXPECT_GT(progress[k].best_sweep, 0);
    }
  }

  std::unique_ptr<ContactDevice> device_;
};

TEST_F(ContactDeviceCuda, SmallIslandsAreSweptAsOnTheHost) {
  expect_host_sweeps({scenes::random_local({.seed = 21, .contacts = 100}), true});
  expect_host_sweeps({scenes::sphere_packing({.seed = 22, .edge = 6, .kept = 0.2}), true});
}

/// Too large for a block: color by color on the whole device.
TEST_F(ContactDeviceCuda, LargeIslandsAreSweptAsOnTheHost) {
  for (const ContactProblem& problem : {scenes::random_local({.seed = 23, .contacts = 3000}),
                                        scenes::sphere_packing({.seed = 24, .edge = 10})}) {
    const SweepScene scene(problem, true);
    EXPECT_GT(scene.structure.islands[0].contact_count(), sweep_contacts);
    expect_host_sweeps(scene);
  }
}

TEST(ContactDevice, NamesTheReasonWhereNoDeviceAnswers) {
  try {
    make_contact_device(4096);
    FAIL();
  } catch (const CudaError& error) {
    EXPECT_GT(std::string(error.what()).size(), 10u);
  }
}

}  // namespace
}  // namespace tetwarp::test
