/// @file test_contact_cuda.cpp
/// Back end cuda of the contact solver through the public calls: solutions and reports against back
/// end cpu and by their residual. Runs on a device, where there is one, and on the emulated one.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/base/warp_backend.hpp"
#include "host/contact/cuda/device.hpp"
#include "host/contact/structure/structure.hpp"
#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_rows.hpp"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/contact/contact_stages.hpp"
#include "tests/support/elastic_block.hpp"

namespace tetwarp::test {
namespace {
constexpr std::int64_t block_contacts = 2048;  ///< of kernels/contact/cuda/contact_block.cuh

ContactOptions on_device(ContactOptions options) {
  options.backend = Backend::cuda;
  return options;
}

/// Solves on the device and computes the residual on the host.
ContactSolution expect_solved(const ContactProblem& problem,
                              const ContactOptions& options,
                              const std::string& what) {
  ContactSolution solution = solve_contacts(problem, on_device(options));
  EXPECT_TRUE(solution.converged()) << what << ": " << solution.report.status_reason;
  const ContactResidual residual = residual_of(problem, solution, options);
  EXPECT_LE(options.measure == ContactMeasure::eta ? residual.eta : residual.fclib,
            1.001 * options.tolerance)
      << what;
  EXPECT_EQ(solution.report.backend, Backend::cuda);
  EXPECT_EQ(solution.report.device, cuda_status(0).device);
  return solution;
}

void skip_without_device() {
  const BackendStatus status = cuda_status(0);
  if (!status.usable) GTEST_SKIP() << status.reason;
}

class ContactCuda : public testing::Test {
 protected:
  void SetUp() override { skip_without_device(); }
};
class ContactCudaMethods : public testing::TestWithParam<ContactMethod> {
 protected:
  void SetUp() override { skip_without_device(); }
};
INSTANTIATE_TEST_SUITE_P(Each,
                         ContactCudaMethods,
                         testing::ValuesIn(methods),
                         [](const auto& info) { return report_name_of(info.param); });

TEST_P(ContactCudaMethods, SolvesBothFormsUnderEveryLawAndRule) {
  for (const FrictionLaw law : {FrictionLaw::cone, FrictionLaw::pyramid}) {
    for (const AdhesionRule rule : {AdhesionRule::parallel, AdhesionRule::restrictive}) {
      const ContactOptions options = {
          .law = law, .rule = rule, .method = GetParam(), .tolerance = 1e-7};
      expect_solved(local_problem(301, 12), options, "local");
      expect_solved(global_problem(302, 6, 0), options, "global");
    }
  }
}

TEST_P(ContactCudaMethods, HasTheVelocitiesOfTheHost) {
  for (const ContactProblem& problem :
       {scenes::sphere_packing({.seed = 303, .edge = 4, .kept = 0.3}),
        scenes::random_local({.seed = 304, .contacts = 60, .neighbors = 2})}) {
    const ContactOptions options = {.method = GetParam(), .tolerance = 1e-10};
    const ContactSolution there = expect_solved(problem, options, "device");
    const ContactSolution here = solve_contacts(problem, options);

    EXPECT_LE(relative_distance(there.velocity, here.velocity), 1e-6);
    EXPECT_EQ(there.report.islands, here.report.islands);
    EXPECT_EQ(there.report.colors, here.report.colors);
    EXPECT_EQ(there.report.method, here.report.method);
    EXPECT_GT(there.report.sweeps, 0);
    EXPECT_FALSE(there.report.residual_history.empty());
  }
}

/// Too large for one block: solved stage by stage by the whole device.
TEST_P(ContactCudaMethods, SolvesAnIslandLargerThanABlockTakes) {
  const ContactProblem problem =
      scenes::random_local({.seed = 305, .contacts = block_contacts + 100, .neighbors = 2});
  EXPECT_GT(make_structure(problem, {.converged_islands = false}).islands[0].contact_count(),
            block_contacts);
  ContactOptions options = {.method = GetParam(), .tolerance = 1e-4};
  options.expert.skip.converged_islands = false;

  const ContactSolution there = expect_solved(problem, options, "large");
  const ContactSolution here = solve_contacts(problem, options);

  EXPECT_NEAR(static_cast<double>(there.report.sweeps), static_cast<double>(here.report.sweeps),
              0.2 * static_cast<double>(here.report.sweeps) + 4);
}

TEST_P(ContactCudaMethods, Float32EndsWithinWhatItCanReach) {
  const ContactOptions options = {
      .method = GetParam(), .tolerance = 1e-3, .precision = ContactPrecision::float32};

  expect_solved(scenes::sphere_packing({.seed = 306, .edge = 4}), options, "spheres");
}

TEST_P(ContactCudaMethods, SolvesElasticBodiesByTheOuterIteration) {
  ContactOptions options = iterated(GetParam());
  options.tolerance = 1e-7;
  options.max_sweeps = 100000;
  const ContactProblem problem = make_elastic_problem({});
  const ContactSolution there = expect_solved(problem, options, "elastic");
  const ContactSolution here = solve_contacts(problem, options);

  EXPECT_LE(relative_distance(there.body_velocity, here.body_velocity), 1e-5);
  EXPECT_EQ(there.report.method, here.report.method);
  EXPECT_EQ(there.report.outer_iterations > 0, here.report.outer_iterations > 0);
}

TEST_F(ContactCuda, Float32IteratesElasticBodiesToo) {
  ContactOptions options = iterated();
  options.precision = ContactPrecision::float32;
  options.tolerance = 1e-6;

  const ContactSolution solution =
      expect_solved(make_elastic_problem({}), options, "elastic in float32");

  EXPECT_GT(solution.report.outer_iterations, 0);
}

TEST_F(ContactCuda, BodiesOfSixDofsThatAreCoupledAreIterated) {
  ContactOptions options = iterated();
  options.tolerance = 1e-8;

  expect_solved(global_problem(307, 8, 0.4), options, "bodies");
}

/// A solve of contacts alone replaces the problem on the device; the next solve must copy it again.
TEST_F(ContactCuda, CoupledAndUncoupledIslandsCanBeMixed) {
  ContactProblem elastic = make_elastic_problem({});
  elastic.block_start.clear();
  for (std::int32_t dof = 0; dof <= elastic.dof_count(); dof += 3) {
    elastic.block_start.push_back(dof);
  }
  ContactProblem mixed = joined(joined(elastic, global_problem(308, 5, 0)), elastic);
  mixed.adhesion = {};
  for (const ContactCoupling coupling :
       {ContactCoupling::automatic, ContactCoupling::condensed, ContactCoupling::iterated}) {
    expect_solved(mixed, {.tolerance = 1e-8, .expert = {.coupling = coupling}}, "mixed");
  }
}

/// Friction ellipses, joints and rolling friction, by methods that have all of them.
TEST_F(ContactCuda, RowsBeyondContactsHaveTheVelocitiesOfTheHost) {
  for (const double coupling : {0.0, 0.3}) {
    for (const ContactMethod method :
         {ContactMethod::automatic, ContactMethod::gauss_seidel, ContactMethod::nonlinear_cg}) {
      ContactProblem problem = global_problem(313, 6, coupling);
      add_ellipses(problem);
      add_bilateral_rows(problem, 314);
      add_rolling_friction(problem, 315);
      const ContactOptions options = {.method = method, .tolerance = 1e-9};
      const ContactSolution there = expect_solved(problem, options, "rows");
      const ContactSolution here = solve_contacts(problem, options);

      EXPECT_LE(relative_distance(there.body_velocity, here.body_velocity), 1e-6);
      EXPECT_EQ(there.report.colors, here.report.colors);
    }
  }
  ContactProblem jointed = global_problem(316, 6, 0);
  add_bilateral_rows(jointed, 317);
  expect_solved(jointed, {.precision = ContactPrecision::float32}, "float32");
}

TEST_F(ContactCuda, FrozenContactsAreLeftOut) {
  ContactOptions options = {.method = ContactMethod::gauss_seidel, .tolerance = 1e-9};
  const ContactProblem problem = scenes::sphere_packing({.seed = 309, .edge = 4});
  const ContactSolution with = expect_solved(problem, options, "frozen");
  options.expert.skip.frozen_contacts = false;
  const ContactSolution without = expect_solved(problem, options, "all active");

  EXPECT_GT(with.report.updates_skipped, 0);
  EXPECT_EQ(without.report.updates_skipped, 0);
  EXPECT_LE(relative_distance(with.velocity, without.velocity), 1e-6);
}

TEST_F(ContactCuda, StartsFromImpulsesGiven) {
  ContactProblem problem = scenes::sphere_packing({.seed = 310, .edge = 4});
  const ContactSolution cold = expect_solved(problem, {}, "cold");
  problem.impulse_guess = cold.impulse;

  EXPECT_LT(2 * expect_solved(problem, {}, "warm").report.sweeps, cold.report.sweeps);
}

TEST_F(ContactCuda, HasTheSameBitsEveryTime) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 311, .edge = 4, .kept = 0.4});
  ContactSolver solver(on_device({}));
  const ContactSolution first = solver.solve(problem);

  expect_same_bits(solver.solve(problem), first, "again");
}

TEST_F(ContactCuda, ResidualHistoryEndsAtTheResidual) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 312, .edge = 4, .kept = 0.4});
  ContactOptions options = {.method = ContactMethod::gauss_seidel, .tolerance = 1e-10};
  options.expert.skip.frozen_contacts = false;
  const ContactReport report = expect_solved(problem, options, "history").report;

  ASSERT_GT(report.residual_history.size(), 5U);
  EXPECT_LE(report.residual_history.size(), 400U);
  EXPECT_NEAR(report.residual_history.back(), report.residual.eta, 0.01 * report.residual.eta);
}

TEST_F(ContactCuda, ContradictionsAreFoundAndClamped) {
  // Two plates press one body of mass 1 from both sides.
  ContactProblem pressed;
  pressed.system = {1, 1, {0, 1}, {0}, {1.0}};
  pressed.load = {0};
  pressed.jacobian = {6, 1, {0, 1, 1, 1, 2, 2, 2}, {0, 0}, {1.0, -1.0}};
  pressed.velocity_offset = {-1, 0, 0, -1, 0, 0};
  pressed.friction = {0, 0};

  const ContactSolution solution = solve_contacts(pressed, on_device({}));

  EXPECT_EQ(solution.report.status, ContactStatus::infeasible);
}

/// Islands and colors are found on the device as well.
TEST_F(ContactCuda, HasTheStructureOfTheHost) {
  const std::unique_ptr<ContactDevice> device = make_contact_device(0);
  for (const ContactProblem& problem :
       {scenes::sphere_packing({.seed = 314, .edge = 6, .kept = 0.3}),
        scenes::random_local({.seed = 315, .contacts = 700, .neighbors = 2}),
        make_elastic_problem({}), ContactProblem(global_problem(316, 9, 0.4))}) {
    const ContactStructure here = make_structure(problem, {});
    const ContactStructure there = make_structure(problem, {}, *device);

    EXPECT_EQ(there.contact_of_slot, here.contact_of_slot);
    EXPECT_EQ(there.color_start, here.color_start);
    EXPECT_EQ(there.islands.size(), here.islands.size());
    EXPECT_EQ(there.dof_of_place, here.dof_of_place);
  }
}

/// The device may fuse products and sums.
TEST_F(ContactCuda, EvolvesAdhesionAsTheHostDoes) {
  const ContactProblem problem = global_problem(317, 8, 0);
  ContactSolver solver(on_device({}));
  const ContactSolution solution = solver.solve(problem);
  for (const AdhesionIntegrator integrator :
       {AdhesionIntegrator::exact, AdhesionIntegrator::explicit_euler}) {
    const AdhesionStep here = evolve_adhesion(problem, solution, {.integrator = integrator});
    const AdhesionStep there = solver.evolve(problem, solution, {.integrator = integrator});

    EXPECT_LE(relative_distance(there.intensity, here.intensity), 1e-14);
    EXPECT_LE(relative_distance(there.gap, here.gap), 1e-14);
    EXPECT_EQ(there.debonded, here.debonded);
  }
}
}  // namespace
}  // namespace tetwarp::test
