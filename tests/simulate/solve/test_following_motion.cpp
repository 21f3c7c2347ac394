/// What the sweeps of the two-level iteration add up: rows of responses, and velocities that follow
/// accelerated impulses.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "host/exec/exec_cpu.hpp"
#include "host/simulate/solve/problem/following_motion.hpp"
#include "tests/simulate/usable_stages.hpp"

namespace tetwarp::test {
namespace {

TEST(AddRows, AllInstructionSetsGiveTheBitsOfSingleNumbers) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  constexpr std::int64_t size = 72, stride = 80;
  std::vector<float> rows(3 * stride);
  for (float& number : rows) number = static_cast<float>(normal(random));
  const double change[3] = {normal(random), 1e-9 * normal(random), 1e6 * normal(random)};
  std::vector<double> start(stride);
  for (double& number : start) number = normal(random);
  std::vector<double> expected = start;
  for (std::size_t k = 0; k < size; ++k) {
    for (std::size_t a = 0; a < 3; ++a) {
      expected[k] += static_cast<double>(rows[a * stride + k]) * change[a];
    }
  }
  for (const VectorStages* stages : usable_stages()) {
    std::vector<double> sum = start;
    stages->add_rows(rows.data(), stride, change, size, sum.data());
    EXPECT_EQ(std::memcmp(sum.data(), expected.data(), stride * sizeof(double)), 0) << stages->name;
  }
}

/// x -> tanh(M x) + 1, steep enough for restarts.
class Iteration {
 public:
  static constexpr std::size_t size = 12, motions = 30;

  Iteration() {
    std::normal_distribution<double> normal;
    for (double& number : matrix_) number = 0.5 * normal(random_);
    for (double& number : moved_) number = normal(random_);
  }
  std::vector<double> image_of(const std::vector<double>& x) const {
    std::vector<double> image = product(matrix_, size, x);
    for (double& number : image) number = std::tanh(number) + 1;
    return image;
  }
  /// The motion by x, in every other of twice as many places.
  std::vector<double> motion_of(const std::vector<double>& x) const {
    const std::vector<double> own = product(moved_, motions, x);
    std::vector<double> spread(2 * motions, -1.0);
    for (std::size_t k = 0; k < motions; ++k) spread[2 * k + 1] = own[k];
    return spread;
  }

 private:
  static std::vector<double> product(const std::vector<double>& rows,
                                     std::size_t count,
                                     const std::vector<double>& x) {
    std::vector<double> result(count);
    for (std::size_t i = 0; i < count; ++i) {
      result[i] = std::inner_product(x.begin(), x.end(),
                                     rows.begin() + static_cast<std::ptrdiff_t>(i * size), 0.0);
    }
    return result;
  }

  std::mt19937 random_{3};
  std::vector<double> matrix_ = std::vector<double>(size * size);
  std::vector<double> moved_ = std::vector<double>(motions * size);
};

TEST(FollowingMotion, IsTheMotionByTheAcceleratedVector) {
  using Direction = ConjugateDirection<CpuExec, double>;
  const Iteration iteration;
  constexpr std::size_t size = Iteration::size;
  CpuExec exec(1);
  const std::vector<double> weights(size, 2.0);
  std::vector<double> work(Direction::columns * size), x(size, 0.3);
  Direction direction(exec, {weights.data(), size}, {work.data(), Direction::columns * size});
  std::vector<std::int64_t> places;
  for (std::size_t k = 0; k < Iteration::motions; ++k) {
    places.push_back(static_cast<std::int64_t>(2 * k + 1));
  }
  FollowingMotion motion;
  motion.start(places);
  int longer = 0, restarts = 0;
  for (int step = 0; step < 60; ++step) {
    std::vector<double> image = iteration.image_of(x);
    motion.keep(iteration.motion_of(x).data());
    std::vector<double> moved = iteration.motion_of(image);
    direction.observe({x.data(), size}, {image.data(), size});
    direction.advance({x.data(), size}, {image.data(), size});
    motion.advance(direction.state()->is_restart, direction.state()->ratio, moved.data());
    ++(direction.state()->is_restart ? restarts : longer);
    const std::vector<double> expected = iteration.motion_of(image);
    for (std::size_t k = 0; k < moved.size(); ++k) {
      ASSERT_NEAR(moved[k], expected[k], 1e-9) << "place " << k << ", step " << step;
    }
    x = image;
  }
  EXPECT_GT(longer, 10);
  EXPECT_GT(restarts, 1);
}

}  // namespace
}  // namespace tetwarp::test
