/// @file test_island_team_simt.cpp
/// Conjugate gradients of an island in one launch, and what decides whether a block or a grid
/// solves it.
#include <gtest/gtest.h>

#include <vector>

#include "host/simulate/step/cuda/island_gradients_cuda.cuh"
#include "tests/emulated/gradient_rows.hpp"

namespace tetwarp::test {
namespace {

/// Row sums of what is not on the diagonal are below it: the residual bounds the error.
template <class T>
void expect_solved(GradientRows<T>& rows, const GradientEnd& end) {
  EXPECT_TRUE(end.is_converged);
  EXPECT_GT(end.iterations, 0);
  EXPECT_LE(end.residual, 1e-8);
  EXPECT_LE(rows.residual(), 1e-7);
}

template <class T>
void expect_all_teams_solve(std::int32_t count) {
  SCOPED_TRACE(count);
  GradientRows<T> rows(count);
  expect_solved(rows, rows.template by_block<128>(1e-8));
  const std::vector<double> narrow = rows.x;
  expect_solved(rows, rows.template by_block<512>(1e-8));
  const std::vector<double> wide = rows.x;
  expect_solved(rows, rows.by_grid(1e-8, 1));
  const std::vector<double> grid = rows.x;
  EXPECT_EQ(narrow == grid, count <= 128);  // the tree of one block
  for (const unsigned blocks : {2u, 5u}) {
    rows.by_grid(1e-8, blocks);
    EXPECT_EQ(rows.x, grid);
  }
  for (std::size_t i = 0; i < wide.size(); ++i) EXPECT_NEAR(wide[i], grid[i], 1e-7);
}

TEST(IslandTeam, BlocksAndGridsSolveIslandsOfAnySize) {
  for (const std::int32_t count : {1, 31, 32, 33, 600}) {
    expect_all_teams_solve<double>(count);
    expect_all_teams_solve<float>(count);
  }
}

TEST(IslandTeam, BitsDoNotDependOnTheOrderOfThreads) {
  GradientRows<double> rows(150);
  rows.by_block<512>(1e-8);
  const std::vector<double> block = rows.x;
  rows.by_grid(1e-8, 2);
  const std::vector<double> grid = rows.x;
  simt::for_each_schedule([&](const simt::Schedule&) {
    rows.by_block<512>(1e-8);
    EXPECT_EQ(rows.x, block);
    rows.by_grid(1e-8, 2);
    EXPECT_EQ(rows.x, grid);
  });
}

/// One island of a thousand rows is one for the whole device; a hundred of them are not.
TEST(IslandTeam, GridsSolveFewLargeIslands) {
  const auto by_grid = [](std::int64_t islands, std::int64_t rows) {
    return count_by_grid(
        std::vector<TeamTimes>(static_cast<std::size_t>(islands), iteration_times({0, rows})), 132);
  };
  EXPECT_EQ(by_grid(0, 0), 0U);
  EXPECT_EQ(by_grid(1, 128), 0U);
  EXPECT_EQ(by_grid(1, 1000), 1U);
  EXPECT_EQ(by_grid(100, 1000), 0U);
  EXPECT_EQ(by_grid(2, 100000), 2U);
  const std::vector<TeamTimes> mixed = {iteration_times({0, 50000}), iteration_times({0, 100})};
  EXPECT_EQ(count_by_grid(mixed, 132), 1U);
}

}  // namespace
}  // namespace tetwarp::test
