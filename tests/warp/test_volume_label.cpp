/// @file test_volume_label.cpp
/// The filter for labels: largest weight, of equal weights the lowest label, no new labels.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "kernels/warp/sample/volume_label.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using Labels = std::array<std::int16_t, 8>;  // x changes first

std::int16_t winner(const Labels& labels, const std::array<double, 3>& fraction) {
  return heaviest_label(labels.data(), fraction.data());
}

/// At 0.4 the first corner has the largest weight of one, 0.216; the threes have 0.144 thrice.
TEST(VolumeLabel, SumsTheWeightsOfALabel) {
  EXPECT_EQ(winner({9, 3, 3, 5, 3, 6, 7, 8}, {0.4, 0.4, 0.4}), 3);
  EXPECT_EQ(winner({9, 3, 4, 5, 2, 6, 7, 8}, {0.4, 0.4, 0.4}), 9);
}

TEST(VolumeLabel, TiesGoToTheLowest) {
  EXPECT_EQ(winner({4, 2, 4, 2, 4, 2, 4, 2}, {0.5, 0.3, 0.7}), 2);
  EXPECT_EQ(winner({2, 4, 2, 4, 2, 4, 2, 4}, {0.5, 0.3, 0.7}), 2);
  EXPECT_EQ(winner({7, 7, -1, -1, 7, 7, -1, -1}, {0.123, 0.5, 0.9}), -1);
  EXPECT_EQ(winner({8, 7, 6, 5, 4, 3, 2, 1}, {0.5, 0.5, 0.5}), 1);
}

TEST(VolumeLabel, ALabelWithoutWeightNeverWins) {
  EXPECT_EQ(winner({5, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0}), 5);
  EXPECT_EQ(winner({0, 0, 0, 0, 0, 0, 0, 5}, {1, 1, 1}), 5);
  EXPECT_EQ(winner({-9, 5, -9, 6, -9, 5, -9, 6}, {1, 0.4, 0.4}), 5);
}

TEST(VolumeLabel, SeparatesLabelsThatFloat64Cannot) {
  const std::int64_t large = std::int64_t{1} << 60;
  const std::array<std::int64_t, 8> labels = {large, large + 1, large, large + 1,
                                              large, large + 1, large, large + 1};
  const double little[3] = {0.4, 0.5, 0.5}, much[3] = {0.6, 0.5, 0.5};

  EXPECT_EQ(heaviest_label(labels.data(), little), large);
  EXPECT_EQ(heaviest_label(labels.data(), much), large + 1);
}

/// Three to five labels at random corners, against sums in float64; the fraction's rounding moves a
/// sum by less than 2^-19.
TEST(VolumeLabel, IsTheLargestOfInterpolatedIndicators) {
  int close = 0;
  for (std::uint64_t n = 0; n < 20000; ++n) {
    Labels labels;
    std::array<double, 3> f;
    for (std::size_t axis = 0; axis < 3; ++axis) f[axis] = scenes::uniform(94, 11 * n + axis);
    std::map<int, double> share;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      labels[corner] = static_cast<std::int16_t>(static_cast<double>(3 + n % 3) *
                                                 scenes::uniform(94, 11 * n + 3 + corner));
      share[labels[corner]] += ((corner & 1) != 0 ? f[0] : 1 - f[0]) *
                               ((corner & 2) != 0 ? f[1] : 1 - f[1]) *
                               ((corner & 4) != 0 ? f[2] : 1 - f[2]);
    }
    std::vector<std::pair<double, int>> ranked;
    ranked.reserve(share.size());
    for (const auto& [label, weight] : share) ranked.emplace_back(-weight, label);
    std::sort(ranked.begin(), ranked.end());
    if (ranked.size() > 1 && ranked[1].first - ranked[0].first < 0x1p-18) {
      ++close;
      continue;
    }
    ASSERT_EQ(winner(labels, f), ranked.front().second) << n;
  }
  EXPECT_LT(close, 5);
}

/// Beyond the outermost centers there is one neighbor.
TEST(VolumeLabel, ClampsToTheRim) {
  const std::uint8_t row[] = {3, 1, 2};
  const SourceView<std::uint8_t> source = {row, {3, 1, 1}, 1};

  EXPECT_EQ(label_at(source, {{-1, 0, 0}, {0.5f, 0, 0}}), 3);
  EXPECT_EQ(label_at(source, {{2, 0, -1}, {0.5f, 0.25f, 0.75f}}), 2);
  EXPECT_EQ(label_at(source, {{0, 0, 0}, {0.5f, 0, 0}}), 1);
  EXPECT_EQ(label_at(source, {{0, -1, 0}, {0.25f, 0.9f, 0.1f}}), 3);
}
}  // namespace
}  // namespace tetwarp::test
