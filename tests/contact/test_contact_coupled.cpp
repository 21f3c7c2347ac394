/// @file test_contact_coupled.cpp
/// Coupled bodies that are reported as converged are within the tolerance, and bodies without
/// contacts move freely.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/matrix.hpp"
#include "host/contact/solve/condense.hpp"
#include "host/contact/structure/system.hpp"
#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {
namespace {
/// The Delassus matrix of a condensed island, stored by blocks, is used like one stored by rows.
TEST(DenseBlocks, HaveTheStructureAndNumbersOfTheSameMatrixByRows) {
  const ContactProblem dense =
      CondensedProblem(scenes::elastic_slab({.cubes = {3, 3, 2}, .contacts = 5})).local();
  ContactProblem by_rows = dense;
  by_rows.delassus = make_rows(dense.delassus);

  const ContactStructure own = make_dense_structure(dense.contact_count());
  const ContactStructure other = make_structure(by_rows, {});
  ContactSystem<double> system, other_system;
  ContactSavings savings;
  fill_system(dense, {}, own, system, savings);
  fill_system(by_rows, {}, other, other_system, savings);

  EXPECT_EQ(own.contact_of_slot, other.contact_of_slot);
  EXPECT_EQ(own.color_start, other.color_start);
  EXPECT_EQ(own.delassus_row, other.delassus_row);
  EXPECT_EQ(own.delassus_column, other.delassus_column);
  EXPECT_EQ(own.delassus_diagonal, other.delassus_diagonal);
  ASSERT_EQ(other.islands.size(), 1U);
  EXPECT_EQ(own.islands[0].slot_end, other.islands[0].slot_end);
  EXPECT_EQ(own.islands[0].color_end, other.islands[0].color_end);
  EXPECT_EQ(system.delassus, other_system.delassus);
}

/// The bound that stops the iteration holds for soft and stiff bodies, with and without adhesion.
TEST(ResidualEstimator, WhatIsCalledConvergedIsWithinTheTolerance) {
  for (const double young : {1e4, 1e5, 1e6, 1e7}) {
    for (const double glue : {0.0, 1e6, 4e7}) {
      const ContactProblem problem = scenes::elastic_slab(
          {.cubes = {6, 5, 2}, .contacts = 30, .young = young, .glue = {glue, 1}});
      ContactOptions options = iterated();
      options.max_sweeps = 100000;
      for (const double tolerance : {1e-4, 1e-8}) {
        options.tolerance = tolerance;

        const ContactSolution solution = solve_contacts(problem, options);

        EXPECT_TRUE(solution.converged()) << young << " " << glue << " " << tolerance;
        const ContactResidual residual =
            residual_of(problem, solution.impulse, solution.body_velocity);
        EXPECT_LE(residual.eta, tolerance) << young << " " << glue;
        EXPECT_LE(residual.balance, tolerance) << young << " " << glue;
      }
    }
  }
}

/// Impulses come from the velocity offsets alone.
ContactProblem slab_at_rest(const scenes::ElasticSlab& choice) {
  ContactProblem problem = scenes::elastic_slab(choice);
  std::fill(problem.load.begin(), problem.load.end(), 0.0);
  for (std::size_t row = 0; row < problem.velocity_offset.size(); row += 3) {
    problem.velocity_offset[row] -= 0.01;
    problem.adhesion.gap[row] = problem.adhesion.time_step * problem.velocity_offset[row];
  }
  return problem;
}

/// The velocities of bodies at rest give no information on A.
TEST(ResidualEstimator, BoundsTheErrorOfBodiesAtRest) {
  const ContactProblem problem = slab_at_rest(
      {.cubes = {6, 5, 2}, .contacts = 30, .young = 2e5, .friction = 1, .glue = {4e8, 1}});

  const ContactSolution solution = solve_contacts(problem, iterated());

  EXPECT_TRUE(solution.converged());
  EXPECT_LE(residual_of(problem, solution.impulse, solution.body_velocity).eta, 1e-8);
}

/// The first of two islands is at rest, the second moves.
TEST(ResidualEstimator, MeasuresAnIslandAsIfItWereAlone) {
  const ContactProblem still =
      slab_at_rest({.cubes = {9, 7, 4}, .contacts = 45, .young = 3e4, .glue = {1e8, 1}});
  const ContactProblem moving = scenes::elastic_slab({.cubes = {6, 5, 2}, .contacts = 30});

  ContactOptions options = iterated();
  options.tolerance = 1e-3;

  const ContactSolution alone = solve_contacts(still, options);
  const ContactSolution both = solve_contacts(joined(still, moving), options);

  EXPECT_EQ(both.report.islands, 2);
  for (std::size_t row = 0; row < alone.impulse.size(); ++row) {
    EXPECT_EQ(both.impulse[row], alone.impulse[row]) << row;
  }
  for (std::size_t dof = 0; dof < alone.body_velocity.size(); ++dof) {
    EXPECT_EQ(both.body_velocity[dof], alone.body_velocity[dof]) << dof;
  }
}

/// Contacts that are open, or closed without force: no iteration is needed.
TEST(ResidualEstimator, LetsBodiesGoThatNoContactHolds) {
  for (const double offset : {100.0, 0.0}) {
    ContactProblem problem = scenes::elastic_slab({.cubes = {6, 5, 2}, .contacts = 30, .glue = {}});
    for (std::size_t row = 0; row < problem.velocity_offset.size(); row += 3) {
      problem.velocity_offset[row] = offset;
    }
    if (offset == 0) std::fill(problem.load.begin(), problem.load.end(), 0.0);
    for (const bool is_guessed : {false, true}) {
      problem.impulse_guess.assign(is_guessed ? problem.velocity_offset.size() : 0, 1e-3);
      for (const auto measure : {ContactMeasure::eta, ContactMeasure::fclib}) {
        ContactOptions options = iterated();
        options.measure = measure;

        const ContactSolution solution = solve_contacts(problem, options);

        EXPECT_TRUE(solution.converged()) << offset;
        EXPECT_EQ(solution.report.outer_iterations, 0) << offset;
        EXPECT_EQ(solution.impulse, std::vector<double>(problem.velocity_offset.size(), 0.0));
        EXPECT_LE(residual_of(problem, solution.impulse, solution.body_velocity).balance, 1e-8);
      }
    }
  }
}

/// Springs much stiffer than their bodies react to errors that hardly change the energy.
TEST(ResidualEstimator, IsRightAboutStiffGlueOnSoftBodies) {
  for (const double young : {3e4, 2e5, 3e6}) {
    for (const double glue : {1e8, 1e9}) {
      const ContactProblem problem = scenes::elastic_slab(
          {.cubes = {9, 7, 4}, .contacts = 45, .young = young, .friction = 1, .glue = {glue, 1}});
      for (const double tolerance : {1e-3, 1e-6}) {
        ContactOptions options = iterated();
        options.tolerance = tolerance;
        options.max_sweeps = 100000;

        const ContactSolution solution = solve_contacts(problem, options);

        EXPECT_TRUE(solution.converged()) << young << " " << glue;
        EXPECT_LE(residual_of(problem, solution.impulse, solution.body_velocity).eta, tolerance)
            << young << " " << glue;
      }
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
