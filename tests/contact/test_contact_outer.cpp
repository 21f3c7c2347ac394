/// @file test_contact_outer.cpp
/// The outer block-Jacobi iteration over bodies that A couples: solutions, options, reports, and
/// when it is used.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/contact/contact_stages.hpp"
#include "tests/support/elastic_block.hpp"

namespace tetwarp::test {
namespace {
/// Elastic nodes and bodies of six dofs that A couples and contacts link.
ContactProblem mixture() {
  ContactProblem soft = make_elastic_problem({.cells = 2});
  const ContactProblem rigid = global_problem(131, 4, 0.4);
  const std::int64_t rows = soft.jacobian.rows;
  soft.block_start.clear();
  for (std::int32_t dof = 0; dof <= soft.dof_count(); dof += 3) soft.block_start.push_back(dof);
  soft = joined(std::move(soft), rigid);
  soft.adhesion = {};
  // A contact between the lowest node and the first body makes them one island.
  for (std::int32_t a = 0; a < 3; ++a) {
    const std::size_t row = static_cast<std::size_t>(rows + a);
    const std::int64_t first = soft.jacobian.row_start[row];
    soft.jacobian.column.insert(soft.jacobian.column.begin() + first, a);
    soft.jacobian.value.insert(soft.jacobian.value.begin() + first, 0.5);
    for (std::size_t r = row + 1; r < soft.jacobian.row_start.size(); ++r) {
      ++soft.jacobian.row_start[r];
    }
  }
  return soft;
}

using Model = std::tuple<FrictionLaw, AdhesionRule>;
class EachModel : public ::testing::TestWithParam<Model> {};
std::string name_of_model(const ::testing::TestParamInfo<Model>& info) {
  const auto [law, rule] = info.param;
  return std::string(law == FrictionLaw::cone ? "cone" : "pyramid") +
         (rule == AdhesionRule::parallel ? "_parallel" : "_restrictive");
}
INSTANTIATE_TEST_SUITE_P(
    By,
    EachModel,
    ::testing::Combine(::testing::Values(FrictionLaw::cone, FrictionLaw::pyramid),
                       ::testing::Values(AdhesionRule::parallel, AdhesionRule::restrictive)),
    name_of_model);

/// Nodes, bodies and both, iterated and condensed, plain and accelerated.
TEST_P(EachModel, HasTheVelocitiesOfTheReference) {
  const auto [law, rule] = GetParam();
  const ContactProblem problems[] = {make_elastic_problem({}), global_problem(132, 6, 0.4),
                                     mixture()};
  for (std::size_t k = 0; k < std::size(problems); ++k) {
    ContactOptions options = {.law = law, .rule = rule, .tolerance = 1e-10, .max_sweeps = 100000};
    options.backend = Backend::reference;
    const ContactSolution reference = solve_contacts(problems[k], options);
    ASSERT_TRUE(reference.converged()) << "problem " << k;
    options.backend = Backend::cpu;
    for (const ContactMethod method :
         {ContactMethod::automatic, ContactMethod::gauss_seidel, ContactMethod::nonlinear_cg}) {
      for (const auto coupling : {ContactCoupling::iterated, ContactCoupling::condensed}) {
        options.method = method;
        options.expert.coupling = coupling;
        const std::string what = "problem " + std::to_string(k) + ", " + report_name_of(method);

        const ContactSolution solution = solve_contacts(problems[k], options);

        EXPECT_TRUE(solution.converged()) << what << ": " << solution.report.status_reason;
        EXPECT_LE(relative_distance(solution.body_velocity, reference.body_velocity), 1e-7) << what;
        const ContactResidual residual =
            residual_of(problems[k], solution.impulse, solution.body_velocity, options);
        EXPECT_LE(residual.eta, 1e-10) << what;
        EXPECT_LE(residual.balance, 1e-10) << what;
      }
    }
  }
}

/// If A couples no blocks, D = A, and the inner problem is the whole problem.
TEST(BlockJacobi, IsExactInOneStepWhereNothingIsCoupled) {
  const ContactProblem problem = global_problem(133, 6, 0);
  const ContactOptions options = {.tolerance = 1e-9,
                                  .expert = {.relaxation = 1, .inner_sweeps = 2000}};
  const ContactStages stages(problem, options);
  CpuExec exec(1);
  const CoupledTask task{options,
                         stages.island(),
                         view_of(stages.structure.color_start),
                         stages.system.numbers(stages.structure.indices()),
                         {},
                         1};
  BlockJacobiMemory<CpuExec> memory;
  ResidualEstimator<CpuExec> estimator(exec, task, memory.estimator);
  BlockJacobi<CpuExec> block_jacobi(exec, task, estimator, memory.iteration);
  const std::vector<double> no_impulse(problem.velocity_offset.size(), 0.0);
  const std::vector<double> no_velocity(problem.load.size(), 0.0);
  IslandOutcome outcome;
  estimator.start(outcome);

  block_jacobi.solve(view_of(no_impulse), view_of(no_velocity), outcome);

  EXPECT_EQ(outcome.reason, StopReason::converged);
  EXPECT_EQ(outcome.outer_iterations, 1);
}

TEST(BlockJacobi, AcceleratedNeedsAThirdOfThePlainSteps) {
  const ContactProblem problem = make_elastic_problem({.young = 1e6});
  ContactOptions plain = iterated(ContactMethod::gauss_seidel);
  plain.max_sweeps = 100000;

  const ContactReport slow = solve_contacts(problem, plain).report;
  const ContactReport fast = solve_contacts(problem, iterated()).report;

  EXPECT_EQ(slow.method, "outer_jacobi");
  EXPECT_EQ(fast.method, "outer_anderson");
  EXPECT_LT(3 * fast.outer_iterations, slow.outer_iterations);
}

/// With a smaller omega the number of iterations grows in proportion.
TEST(BlockJacobi, HalfTheRelaxationTakesTwiceTheSteps) {
  const ContactProblem problem = make_elastic_problem({});
  ContactOptions options = iterated(ContactMethod::gauss_seidel);
  const auto half = static_cast<double>(solve_contacts(problem, options).report.outer_iterations);
  options.expert.relaxation = 0.25;

  const auto quarter =
      static_cast<double>(solve_contacts(problem, options).report.outer_iterations);

  EXPECT_GT(quarter, 1.7 * half);
  EXPECT_LT(quarter, 2.3 * half);
}

/// Bodies with several contacts: better inner solutions save outer steps. Nodes with one contact
/// each are solved by one sweep for any inner_sweeps.
TEST(BlockJacobi, InnerSweepsSaveStepsWhereContactsShareBodies) {
  ContactOptions once = iterated(), often = iterated();
  once.expert.inner_sweeps = 1;
  often.expert.inner_sweeps = 20;
  const ContactProblem bodies = global_problem(134, 12, 0.4);
  const ContactProblem nodes = make_elastic_problem({});

  const ContactReport rough = solve_contacts(bodies, once).report;
  const ContactReport fine = solve_contacts(bodies, often).report;

  EXPECT_LT(2 * fine.outer_iterations, rough.outer_iterations);
  EXPECT_EQ(rough.sweeps, rough.outer_iterations);
  EXPECT_EQ(fine.sweeps, 20 * fine.outer_iterations);
  expect_same_bits(solve_contacts(nodes, once), solve_contacts(nodes, often), "nodes");
}

TEST(BlockJacobi, ReportsWhatItDid) {
  const ContactSolution solution =
      solve_contacts(scenes::elastic_slab({.cubes = {6, 5, 2}, .contacts = 30}), iterated());

  const ContactReport& report = solution.report;
  EXPECT_GT(report.outer_iterations, 10);
  EXPECT_EQ(report.contact_updates, 30 * report.sweeps);
  ASSERT_GE(report.residual_history.size(), 1U);
  EXPECT_NEAR(report.residual_history.back(), report.residual.eta, 1e-12 * report.residual.eta);
}

TEST(BlockJacobi, HasTheSameBitsForAnyNumberOfThreads) {
  const ContactProblem problem =
      scenes::elastic_slab({.cubes = {14, 12, 6}, .contacts = 100});  // 1365 nodes use threads
  ContactOptions options = iterated();
  options.threads = 1;
  const ContactSolution one = solve_contacts(problem, options);
  for (const int threads : {2, 3}) {
    options.threads = threads;

    expect_same_bits(solve_contacts(problem, options), one, std::to_string(threads) + " threads");
  }
}

TEST(BlockJacobi, StartsFromImpulsesGiven) {
  ContactProblem problem = make_elastic_problem({});
  const ContactSolution cold = solve_contacts(problem, iterated());
  problem.impulse_guess = cold.impulse;

  const ContactSolution warm = solve_contacts(problem, iterated());

  EXPECT_TRUE(warm.converged());
  EXPECT_LT(2 * warm.report.outer_iterations, cold.report.outer_iterations);
}

TEST(BlockJacobi, IsChosenForLargeIslandsOnly) {
  const ContactProblem small = make_elastic_problem({});
  const ContactProblem large = scenes::elastic_slab({.cubes = {14, 12, 6}, .contacts = 100});

  EXPECT_EQ(solve_contacts(small).report.outer_iterations, 0);
  EXPECT_EQ(solve_contacts(large, {.tolerance = 0.5}).report.method, "outer_anderson");
  const ContactOptions sweeps = {
      .method = ContactMethod::gauss_seidel, .tolerance = 0.5, .max_sweeps = 10};
  EXPECT_EQ(solve_contacts(large, sweeps).report.outer_iterations, 0);
}

/// 100 outer iterations do not converge; the condensed problem does.
TEST(BlockJacobi, IsFollowedByCondensingWhereItFails) {
  const ContactProblem problem = scenes::elastic_slab({.cubes = {14, 12, 6}, .contacts = 100});

  const ContactSolution solution = solve_contacts(problem, {.tolerance = 1e-8, .max_sweeps = 100});

  EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
  EXPECT_TRUE(solution.report.method.starts_with("outer_anderson, "));
  EXPECT_EQ(solution.report.outer_iterations, 100);
}
}  // namespace
}  // namespace tetwarp::test
