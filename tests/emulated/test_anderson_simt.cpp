/// @file test_anderson_simt.cpp
/// The decisions of Anderson's method by one warp against those by one thread.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "kernels/contact/cuda/anderson_lanes.cuh"

namespace tetwarp::test {
namespace {
__global__ void decide_kernel(View<AndersonState> states) {
  decide_by_lanes(states[blockIdx.x], static_cast<int>(threadIdx.x));
}

TEST(AndersonSimt, AWarpDecidesWithTheBitsOfOneThread) {
  std::mt19937 random(13);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    AndersonState one, lanes;
    for (int step = 0; step < 20; ++step) {
      const bool is_bad = trial % 4 == 3 && step % 7 == 5;  // not positive definite
      for (double& sum : one.sums.value) sum = normal(random);
      one.sums.value[16] = std::exp(-0.1 * step) * (trial % 5 == 4 && step == 9 ? 100 : 1);
      if (one.newest >= 0) {
        one.sums.value[one.newest] = is_bad ? -1 : 10 * std::exp(normal(random));
      }
      std::memcpy(lanes.sums.value, one.sums.value, sizeof(one.sums.value));
      one.decide();
      simt::launch(decide_kernel, dim3(1), dim3(32), 0, View<AndersonState>{&lanes, 1});
      ASSERT_EQ(one.action, lanes.action) << trial << " " << step;
      ASSERT_EQ(one.depth, lanes.depth);
      ASSERT_EQ(one.newest, lanes.newest);
      if (one.action == AndersonState::Action::combine) {
        ASSERT_EQ(std::memcmp(one.factor, lanes.factor, sizeof(one.factor)), 0);
      }
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
