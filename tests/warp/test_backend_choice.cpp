/// @file test_backend_choice.cpp
/// The estimate of a warp's time on the cpu, by which a back end is chosen.
#include <gtest/gtest.h>

#include <array>

#include "host/warp/backend_choice.hpp"

namespace tetwarp::test {
namespace {
TEST(CpuEstimate, IsProportionalToSamplesAndSharedByThreads) {
  for (const Filter filter : {Filter::nearest, Filter::linear, Filter::cubic, Filter::bspline,
                              Filter::lanczos, Filter::labels}) {
    const WarpOptions one{.filter = filter, .threads = 1}, four{.filter = filter, .threads = 4};
    const double seconds = estimated_cpu_seconds(one, 1e6, false);

    EXPECT_GT(seconds, 0.005);
    EXPECT_LT(seconds, 0.1);
    EXPECT_DOUBLE_EQ(estimated_cpu_seconds(one, 3e6, false), 3 * seconds);
    EXPECT_DOUBLE_EQ(estimated_cpu_seconds(four, 1e6, false), seconds / 4);
  }
}

/// The order of the benchmarks' rows.
TEST(CpuEstimate, GrowsWithWhatAVoxelCosts) {
  const std::array options = {
      WarpOptions{.filter = Filter::nearest}, WarpOptions{.filter = Filter::linear},
      WarpOptions{.filter = Filter::labels},  WarpOptions{.intensity = Intensity::density},
      WarpOptions{.filter = Filter::cubic},   WarpOptions{.antialias = true},
      WarpOptions{.filter = Filter::lanczos}, WarpOptions{.intensity = Intensity::conservative}};
  for (std::size_t i = 1; i < options.size(); ++i) {
    EXPECT_LT(estimated_cpu_seconds(options[i - 1], 1e6, false),
              estimated_cpu_seconds(options[i], 1e6, false))
        << i;
  }
  EXPECT_GT(estimated_cpu_seconds(options[1], 1e6, true),
            20 * estimated_cpu_seconds(options[1], 1e6, false));
}
}  // namespace
}  // namespace tetwarp::test
