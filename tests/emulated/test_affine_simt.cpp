/// @file test_affine_simt.cpp
/// The benchmark's sampling kernel, emulated, samples at the positions of its map in every layout.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "bench/measure/affine_device.cuh"

namespace tetwarp::bench {
namespace {
constexpr int dims[3] = {19, 13, 11};
constexpr double turn[3][4] = {{0.8, -0.6, 0.02, 6}, {0.6, 0.8, 0, -3}, {0, -0.1, 0.9, 0.3}};

/// An affine function of the position, which linear interpolation reproduces.
double ramp(double i, double j, double k) {
  return 3 * i - 2 * j + 5 * k + 100;
}

/// The floor in tiles of a width: 8 or 32.
template <class Source>
std::vector<float> sampled(const Source& source, bool blends, int width) {
  std::vector<float> output(21 * 18 * 15, -1.0f);
  AffineDeviceJob<float, Source> job{
      source, {dims[0], dims[1], dims[2]}, {21, 18, 15}, {}, output.data()};
  for (int row = 0; row < 3; ++row) std::copy_n(turn[row], 4, job.rows[row]);
  const auto run = [&]<class Tile>(Tile) {
    launch(nullptr,
           blends ? affine_kernel<Tile, true, float, Source>
                  : affine_kernel<Tile, false, float, Source>,
           tiles_of<Tile>(job), dim3(floor_threads), 0, job);
  };
  width == 8 ? run(Tile<8, 8>{}) : run(Tile<32, 4>{});
  return output;
}

/// Samples of the ramp, on request in bricks.
struct Ramp {
  std::vector<float> samples = std::vector<float>(19 * 13 * 11);
  LinearSource<float> linear{samples.data(), {dims[0], dims[1], dims[2]}};
  BrickedSource<float> bricked{nullptr, {3, 4, 3}};
  std::vector<float> bricks = std::vector<float>(static_cast<std::size_t>(bricked.count()));

  Ramp() {
    for (int k = 0; k < dims[2]; ++k) {
      for (int j = 0; j < dims[1]; ++j) {
        for (int i = 0; i < dims[0]; ++i) {
          const auto value = static_cast<float>(ramp(i, j, k));
          samples[static_cast<std::size_t>((k * dims[1] + j) * dims[0] + i)] = value;
          bricks[static_cast<std::size_t>(bricked.place(i, j, k))] = value;
        }
      }
    }
    bricked.data = bricks.data();
  }
};

class AffineSimt : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Tiles, AffineSimt, ::testing::Values(8, 32));

TEST_P(AffineSimt, LinearSamplesOfARampAreTheRampWithinTheSource) {
  const Ramp source;
  const std::vector<float> output = sampled(source.linear, true, GetParam());
  int inside = 0, outside = 0;
  std::size_t v = 0;
  for (int k = 0; k < 15; ++k) {
    for (int j = 0; j < 18; ++j) {
      for (int i = 0; i < 21; ++i, ++v) {
        double x[3];
        bool is_far = false, is_within = true;
        for (int row = 0; row < 3; ++row) {
          x[row] = turn[row][0] * i + turn[row][1] * j + turn[row][2] * k + turn[row][3];
          is_far = is_far || x[row] < -0.501 || x[row] > dims[row] - 0.499;
          is_within = is_within && x[row] >= 0 && x[row] <= dims[row] - 1;
        }
        if (is_far) {
          EXPECT_EQ(output[v], 0);
        }
        if (is_within) {
          EXPECT_NEAR(output[v], ramp(x[0], x[1], x[2]), 1e-4);
        }
        outside += is_far;
        inside += is_within;
      }
    }
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(outside, 500);
}

TEST_P(AffineSimt, LayoutsHaveTheSameBitsAndEveryVoxelIsWritten) {
  const Ramp source;
  for (const bool blends : {true, false}) {
    const std::vector<float> output = sampled(source.linear, blends, GetParam());

    EXPECT_EQ(sampled(source.bricked, blends, GetParam()), output);
    EXPECT_EQ(std::count(output.begin(), output.end(), -1.0f), 0);
  }
}
}  // namespace
}  // namespace tetwarp::bench
