/// @file test_block_lu.cpp
/// Sparse factors of 3x3 blocks, against products and against dense factors.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/simulate/step/cpu/block_lu.hpp"

namespace tetwarp::test {
namespace {
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// A matrix with a symmetric pattern and other values on both sides of the diagonal.
class Problem {
 public:
  Problem(int count, int neighbors, unsigned seed) : count_(count), random_(seed) {
    for (std::int32_t i = 0; i < count; ++i) {
      for (int k = 0; k < neighbors; ++k) {
        const std::int32_t j = std::uniform_int_distribution<std::int32_t>(0, count - 1)(random_);
        if (i == j) continue;
        entries_.push_back({i, j});
        entries_.push_back({j, i});
      }
    }
    std::ranges::sort(entries_);
    entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
  }

  /// Fills both matrices with random blocks, each in two parts.
  Eigen::MatrixXd fill(BlockLu& lu) {
    lu.set_pattern(count_, entries_);
    lu.clear();
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * count_, 3 * count_);
    const auto add = [&](std::int32_t i, std::int32_t j, double shift) {
      RowMajor block;
      for (double& value : block.reshaped()) value = normal_(random_);
      block += shift * RowMajor::Identity();
      lu.add(i, j, block.data());
      dense.block<3, 3>(3 * i, 3 * j) += block;
    };
    for (int part = 0; part < 2; ++part) {
      for (std::int32_t i = 0; i < count_; ++i) add(i, i, 40);
      for (const auto& [i, j] : entries_) add(i, j, 0);
    }
    return dense;
  }
  Eigen::VectorXd vector() {
    Eigen::VectorXd x(3 * count_);
    for (double& value : x) value = normal_(random_);
    return x;
  }

 private:
  int count_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::vector<BlockLu::Entry> entries_;
};

TEST(BlockLu, SolutionsSatisfyTheEquations) {
  for (const int count : {1, 2, 31, 32, 33, 200}) {
    Problem problem(count, 3, static_cast<unsigned>(count));
    BlockLu lu;
    for (int repeat = 0; repeat < 2; ++repeat) {  // the second time with the same pattern
      const Eigen::MatrixXd dense = problem.fill(lu);
      const Eigen::VectorXd right = problem.vector();
      Eigen::VectorXd x = right;

      ASSERT_TRUE(lu.factor());
      lu.solve({x.data(), static_cast<std::size_t>(x.size())});

      EXPECT_LT((dense * x - right).norm(), 1e-11 * right.norm()) << count;
    }
  }
}

/// Law: three vectors at once have the bits of each alone, sparse and zero ones, too.
TEST(BlockLu, ThreeVectorsAtOnceAreThreeVectors) {
  for (const int count : {1, 2, 31, 32, 33, 200}) {
    Problem problem(count, 3, static_cast<unsigned>(count));
    BlockLu lu;
    problem.fill(lu);
    ASSERT_TRUE(lu.factor());
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(3 * count, 3);
    x.col(0) = problem.vector();
    x(3 * (count / 2) + 1, 1) = 0.1;
    for (const bool has_third : {false, true}) {
      if (has_third) x.col(2) = problem.vector();
      Eigen::MatrixXd single = x, three = x;

      for (auto column : single.colwise()) lu.solve({column.data(), index_of(column.size())});
      lu.solve_three({three.data(), index_of(three.size())});

      EXPECT_EQ(three, single) << count;
    }
  }
}

TEST(BlockLu, AnotherPatternReplacesTheFirst) {
  BlockLu lu;
  Problem first(20, 4, 1), second(15, 2, 2);
  first.fill(lu);
  const Eigen::MatrixXd dense = second.fill(lu);
  const Eigen::VectorXd right = second.vector();
  Eigen::VectorXd x = right;

  ASSERT_TRUE(lu.factor());
  lu.solve({x.data(), static_cast<std::size_t>(x.size())});

  EXPECT_LT((x - dense.lu().solve(right)).norm(), 1e-11 * x.norm());
}

TEST(BlockLu, ASingularPivotIsReported) {
  BlockLu lu;
  lu.set_pattern(2, {});
  lu.clear();
  const double block[9] = {1, 0, 0, 0, 1, 0, 0, 0, 0}, regular[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  lu.add(0, 0, block);
  lu.add(1, 1, regular);

  EXPECT_FALSE(lu.factor());
}

/// A chain has no fill: its multiplications grow with its length.
TEST(BlockLu, AChainTakesAsManyOperationsAsItHasLinks) {
  const auto operations_of = [](std::int32_t count) {
    std::vector<BlockLu::Entry> entries;
    for (std::int32_t i = 0; i + 1 < count; ++i) {
      entries.push_back({i, i + 1});
      entries.push_back({i + 1, i});
    }
    std::ranges::sort(entries);
    BlockLu lu;
    lu.set_pattern(count, entries);
    return lu.operations();
  };
  EXPECT_EQ(operations_of(101), 2 * operations_of(51));
}

}  // namespace
}  // namespace tetwarp::test
