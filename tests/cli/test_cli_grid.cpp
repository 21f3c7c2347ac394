/// @file test_cli_grid.cpp
/// Output grids of which single parts are given.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;
using Dims = std::array<std::int64_t, 3>;

/// The ramp fills the box from (4, -4, 99) to (28, 16, 115).
class CliGrid : public testing::Test {
 protected:
  Volume warped(Names options) const {
    options.insert(options.begin(), {"-o", "out.vtkhdf", "--outputs", "mask"});
    const CommandResult result = scene.warp(options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_volume(scene / "out.vtkhdf", "tetwarp_mask");
  }

  void expect_grid(const Names& options,
                   const Dims& dims,
                   const Point3& origin,
                   const Point3& spacing) const {
    const Grid grid = warped(options).grid;
    EXPECT_EQ(grid.dims, dims);
    EXPECT_EQ(grid.origin, origin);
    EXPECT_EQ(grid.spacing, spacing);
  }

  Scene scene;
};

TEST_F(CliGrid, KeepsItsBoxUnderAnotherSpacing) {
  expect_grid({"--steps", "0", "--spacing", "1,4,4"}, {24, 5, 4}, {4.5, -2, 101}, {1, 4, 4});
  expect_grid({"--steps", "0", "--spacing", "5,5,5"}, {5, 4, 4}, {6, -1.5, 99.5}, {5, 5, 5});
}

TEST_F(CliGrid, KeepsItsBoxUnderAnotherNumberOfVoxels) {
  expect_grid({"--steps", "0", "--dims", "6,5,4"}, {6, 5, 4}, {6, -2, 101}, {4, 4, 4});
}

TEST_F(CliGrid, TakesBothSpacingAndDimsOrAnOriginAsGiven) {
  expect_grid({"--steps", "0", "--dims", "3,5,4", "--spacing", "4,4,4"}, {3, 5, 4}, {5, -3, 100},
              {4, 4, 4});
  expect_grid({"--steps", "0", "--spacing", "4,4,4", "--origin", "0,1,2"}, {6, 5, 4}, {0, 1, 2},
              {4, 4, 4});
}

/// At step 3 the mesh fills the box from (10, -4, 99) to (34, 16, 115), on the lattice of the
/// source voxels 2 to 15, -1 to 10 and -1 to 8.
TEST_F(CliGrid, CoversTheBoundsOfTheMeshWithAnyNumberOfVoxels) {
  const Names options{"--steps", "3", "--grid", "bounds", "--dims", "4,4,4"};
  expect_grid(options, {4, 4, 4}, {11.5, -3, 99.5}, {7, 6, 5});
  const Volume mask = warped(options);
  const auto samples = mask.samples<std::uint8_t>();
  EXPECT_EQ(std::ranges::count(samples, 1), 64);
}
}  // namespace
}  // namespace tetwarp::test
