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

/// Whatever is asked for beside a filter takes time: of each kind of job the estimate is larger.
TEST(CpuEstimate, GrowsWithWhateverIsAddedToAJob) {
  const auto seconds = [](const WarpOptions& options, bool has_hexahedra = false) {
    return estimated_cpu_seconds(options, 1e6, has_hexahedra);
  };
  for (const Filter filter : {Filter::nearest, Filter::linear, Filter::cubic, Filter::bspline,
                              Filter::lanczos, Filter::labels}) {
    const WarpOptions plain{.filter = filter, .threads = 2};
    WarpOptions averaged = plain, density = plain, sums = plain;
    averaged.antialias = true;
    density.intensity = Intensity::density;
    sums.intensity = Intensity::conservative;
    for (const WarpOptions& more : {averaged, density, sums}) {
      EXPECT_GT(seconds(more), seconds(plain)) << name_of(filter);
    }
    EXPECT_GT(seconds(plain, true), seconds(plain)) << name_of(filter);
  }
  const WarpOptions labels{.filter = Filter::labels, .threads = 2};
  WarpOptions volume = labels, gaussian = labels;
  volume.label_rule = LabelRule::volume;
  gaussian.label_rule = LabelRule::gaussian;
  EXPECT_GT(seconds(volume), seconds(labels));
  double last = seconds(labels);
  for (const double cutoff : {1.0, 2.0, 4.0}) {
    for (const double sigma : {1.0, 1.5}) {
      gaussian.label_gaussian = {sigma, cutoff};
      EXPECT_GT(seconds(gaussian), last) << sigma << ' ' << cutoff;
      last = seconds(gaussian);
    }
  }
}

/// The estimate is for the work that is measured: within a factor of three of 167 and 9,458 ns.
TEST(CpuEstimate, KnowsHowManyLabelsAGaussianReads) {
  WarpOptions gaussian{.filter = Filter::labels, .label_rule = LabelRule::gaussian, .threads = 1};
  EXPECT_NEAR(estimated_cpu_seconds(gaussian, 1e6, false), 0.167, 0.1);
  gaussian.label_gaussian = {2, 3};
  EXPECT_NEAR(estimated_cpu_seconds(gaussian, 1e6, false), 9.458, 5);
}
}  // namespace
}  // namespace tetwarp::test
