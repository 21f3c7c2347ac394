/// @file test_contact_linear.cpp
/// Conjugate gradients on a coupled system: how exact they are when they say so.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "host/contact_exec_cpu.hpp"
#include "host/contact_linear.hpp"
#include "tests/contact_samples.hpp"
#include "tests/contact_stages.hpp"

namespace tetwarp::test {
namespace {

using Eigen::VectorXd;

/// Coupled bodies of six dofs, their places in the order of the problem.
struct LinearCase {
  explicit LinearCase(double coupling) : random(141) {
    const ContactProblem problem = samples::random_global(random, 30, 6, coupling, 0.3);
    stages = std::make_unique<ContactStages>(problem);
    matrix.setZero(180, 180);
    const ContactStructure& s = stages->structure;
    for (Eigen::Index column = 0; column < 180; ++column) {
      std::vector<double> unit(180, 0.0), image(180);
      unit[static_cast<std::size_t>(column)] = 1;
      for (std::int64_t b = 0; b < 30; ++b) {
        multiply_block_row(s.system(view_of(std::as_const(stages->system.system))), b, unit.data(),
                           image.data() + s.dof_start[static_cast<std::size_t>(b)]);
      }
      matrix.col(column) = samples::vector_of(image);
    }
    goal = samples::random_vector(random, 180);
  }

  std::mt19937 random;
  std::unique_ptr<ContactStages> stages;
  Eigen::MatrixXd matrix;
  VectorXd goal;
};

TEST(CoupledLinear, LeavesTheShareOfTheErrorAskedFor) {
  const LinearCase c(0.4);
  const VectorXd exact = c.matrix.llt().solve(c.goal);
  CpuContactExec exec(1);
  CoupledLinear<CpuContactExec> linear(exec, c.stages->structure, c.stages->system,
                                       c.stages->island());
  for (const double share : {1e-1, 1e-4, 1e-8}) {
    std::vector<double> x(180, 0.0), rest = samples::list_of(c.goal);

    const double moved = linear.solve({.share = share}, x, rest);

    const VectorXd error = samples::vector_of(x) - exact;
    const double size = std::sqrt(exact.dot(c.matrix * exact));
    EXPECT_LE(std::sqrt(error.dot(c.matrix * error)), 2 * share * size) << share;
    EXPECT_NEAR(moved, size, share * size);
    EXPECT_LE((c.goal - c.matrix * samples::vector_of(x) - samples::vector_of(rest)).norm(),
              1e-12 * c.goal.norm());
  }
}

TEST(CoupledLinear, GivesUpBeyondTheDistanceAllowed) {
  const LinearCase c(0.4);
  const VectorXd exact = c.matrix.llt().solve(c.goal);
  const double limit = 0.1 * std::sqrt(exact.dot(c.goal));
  CpuContactExec exec(1);
  CoupledLinear<CpuContactExec> linear(exec, c.stages->structure, c.stages->system,
                                       c.stages->island());
  std::vector<double> x(180, 0.0), rest = samples::list_of(c.goal);

  EXPECT_GT(linear.solve({.share = 1e-8, .too_far = limit}, x, rest), limit);
  EXPECT_GT((samples::vector_of(x) - exact).norm(), 1e-3 * exact.norm());
}

/// Couplings twice as strong as the blocks they join: these stay positive, the whole does not.
TEST(CoupledLinear, RefusesASystemThatIsNotPositiveDefinite) {
  const LinearCase c(2);
  CpuContactExec exec(1);
  CoupledLinear<CpuContactExec> linear(exec, c.stages->structure, c.stages->system,
                                       c.stages->island());
  std::vector<double> x(180, 0.0), rest = samples::list_of(c.goal);

  EXPECT_LT(c.matrix.selfadjointView<Eigen::Lower>().eigenvalues()(0), 0);
  EXPECT_THROW(linear.solve({.share = 1e-12}, x, rest), ContactProblemError);
}

}  // namespace
}  // namespace tetwarp::test
