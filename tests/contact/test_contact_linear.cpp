/// @file test_contact_linear.cpp
/// Conjugate gradients on a coupled system: their error estimate bounds the error.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "host/contact/block_jacobi/coupled_system.hpp"
#include "host/exec/exec_cpu.hpp"
#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/contact/contact_stages.hpp"
#include "tests/support/elastic_block.hpp"

namespace tetwarp::test {
namespace {
using Eigen::VectorXd;

/// A of a problem with one island, its places in the order of the structure, and a load.
struct LinearCase {
  explicit LinearCase(const ContactProblem& problem) : stages(problem), random(141) {
    const ContactStructure& s = stages.structure;
    const auto dofs = static_cast<Eigen::Index>(problem.load.size());
    matrix.setZero(dofs, dofs);
    for (Eigen::Index column = 0; column < dofs; ++column) {
      std::vector<double> unit(problem.load.size(), 0.0), image(problem.load.size());
      unit[static_cast<std::size_t>(column)] = 1;
      for (std::int64_t b = 0; b < stages.island().block_end; ++b) {
        multiply_block_row(stages.numbers().system, b, unit.data(),
                           image.data() + s.dof_start[static_cast<std::size_t>(b)]);
      }
      matrix.col(column) = samples::vector_of(image);
    }
    goal = samples::random_vector(random, dofs);
  }

  double size_of(const VectorXd& x) const { return std::sqrt(x.dot(matrix * x)); }

  ContactStages stages;
  std::mt19937 random;
  Eigen::MatrixXd matrix;
  VectorXd goal;
  mutable CoupledSystemMemory<CpuExec> memory;  ///< of one solver at a time
};

/// Coupled bodies of six dofs.
LinearCase bodies(double coupling) {
  std::mt19937 random(142);
  return LinearCase(samples::random_global(random, 30, 6, coupling, 0.3));
}

using Linear = CoupledSystem<CpuExec>;

Linear make_linear(CpuExec& exec, const LinearCase& c) {
  return Linear(exec, c.stages.numbers(), c.stages.island(), c.memory);
}

TEST(CoupledSystem, ReducesTheErrorToTheRequestedShare) {
  const LinearCase c = bodies(0.4);
  const VectorXd exact = samples::solve_spd(c.matrix, c.goal);
  const double size = c.size_of(exact);
  CpuExec exec(1);
  Linear linear = make_linear(exec, c);
  for (const double share : {1e-1, 1e-4, 1e-8}) {
    std::vector<double> x(180, 0.0), rest = samples::list_of(c.goal);

    const LinearProgress progress =
        linear.solve(view_of(x), view_of(rest),
                     [&](const LinearProgress& now) { return now.left <= share * now.moved; });

    EXPECT_LE(c.size_of(samples::vector_of(x) - exact), share * size) << share;
    EXPECT_NEAR(progress.moved, size, share * size);
    EXPECT_LE((c.goal - c.matrix * samples::vector_of(x) - samples::vector_of(rest)).norm(),
              1e-12 * c.goal.norm());
  }
}

/// At every estimate, from well to badly conditioned; a previous rough solve has estimated the
/// smallest eigenvalue.
TEST(CoupledSystem, EstimatesItsErrorFromAboveAndTightly) {
  const LinearCase cases[] = {bodies(0.1), bodies(0.4), LinearCase(make_elastic_problem({})),
                              LinearCase(make_elastic_problem({.young = 1e7}))};
  for (const LinearCase& c : cases) {
    CpuExec exec(1);
    Linear linear = make_linear(exec, c);
    std::mt19937 random(143);
    const auto dofs = c.goal.size();
    std::vector<double> rough(static_cast<std::size_t>(dofs), 0.0);
    std::vector<double> first = samples::list_of(samples::random_vector(random, dofs));
    linear.solve(view_of(rough), view_of(first),
                 [](const LinearProgress& now) { return now.left <= 0.1 * now.moved; });
    const VectorXd exact = samples::solve_spd(c.matrix, c.goal);
    std::vector<double> x(rough.size(), 0.0), rest = samples::list_of(c.goal);
    int questions = 0;

    linear.solve(view_of(x), view_of(rest), [&](const LinearProgress& now) {
      const double error = c.size_of(samples::vector_of(x) - exact);
      ++questions;
      EXPECT_GE(now.left, error) << dofs << " dofs, question " << questions;
      EXPECT_LE(now.left, 100 * error) << dofs << " dofs, question " << questions;
      return error < 1e-8 * now.moved;
    });

    EXPECT_GE(questions, 2);
  }
}

TEST(CoupledSystem, StopsWhenTheCriterionHolds) {
  const LinearCase c = bodies(0.4);
  const VectorXd exact = samples::solve_spd(c.matrix, c.goal);
  CpuExec exec(1);
  Linear linear = make_linear(exec, c);
  std::vector<double> x(180, 0.0), rest = samples::list_of(c.goal);

  linear.solve(view_of(x), view_of(rest), [](const LinearProgress&) { return true; });

  EXPECT_GT(c.size_of(samples::vector_of(x) - exact), 1e-3 * c.size_of(exact));
}

TEST(CoupledSystem, AcceptsLoadsWhoseSquaresUnderflow) {
  LinearCase c = bodies(0.4);
  for (const double scale : {1e-150, 1e-155, 1e-160, 1e-165, 1e-300, 0.0}) {
    std::vector<double> x(180, 0.0), rest = samples::list_of(c.goal * scale);
    CpuExec exec(1);
    Linear linear = make_linear(exec, c);

    EXPECT_NO_THROW(linear.solve(view_of(x), view_of(rest), [](const LinearProgress&) {
      return false;
    })) << scale;

    for (const double entry : x) EXPECT_TRUE(std::isfinite(entry)) << scale;
  }
}

/// Couplings twice as strong as the blocks they join: the blocks stay positive definite, the matrix
/// does not.
TEST(CoupledSystem, RefusesASystemThatIsNotPositiveDefinite) {
  const LinearCase c = bodies(2);
  CpuExec exec(1);
  Linear linear = make_linear(exec, c);
  std::vector<double> x(180, 0.0), rest = samples::list_of(c.goal);

  EXPECT_LT(samples::smallest_eigenvalue(c.matrix), 0);
  EXPECT_THROW(linear.solve(view_of(x), view_of(rest), [](const LinearProgress&) { return false; }),
               ContactProblemError);
}
}  // namespace
}  // namespace tetwarp::test
