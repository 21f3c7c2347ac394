/// @file test_contact_truth.cpp
/// "Converged" is said of solutions only: problems with and without solutions, numbers that
/// overflow, impulses in the null space of the Delassus matrix, rows that are rounding.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include <tetwarp/contact.hpp>

#include "host/reference/contact/dense.hpp"
#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/solvability.hpp"
#include "tests/support/truth.hpp"

namespace tetwarp::test {
using samples::Solvability;

TEST(ContactTruth, ProblemsOfKnownSolvability) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    for (const Solvability kind :
         {Solvability::solvable, Solvability::infeasible, Solvability::jammed}) {
      const FrictionLaw law = seed % 2 == 0 ? FrictionLaw::cone : FrictionLaw::pyramid;
      const ContactProblem problem = samples::make_solvability(kind, seed, 2 + seed % 7, 1, law);
      const std::string name =
          "kind " + std::to_string(static_cast<int>(kind)) + ", seed " + std::to_string(seed);
      expect_truth(problem, kind, {.law = law, .max_sweeps = 2000}, name);
    }
  }
}

/// In these problems impulses in the friction cones cancel while the contacts approach against
/// them, yet they have a solution, with contacts that slide. Methods from a single start miss it.
TEST(ContactTruth, DirectionsOfGrowthDoNotHideSolutions) {
  struct Hidden {
    unsigned seed;
    Eigen::Index contacts;
    FrictionLaw law;
    double tolerance;
  };
  constexpr FrictionLaw cone = FrictionLaw::cone, pyramid = FrictionLaw::pyramid;
  for (const Hidden& hidden : {Hidden{5123, 14, pyramid, 1e-8},
                               {10156, 12, cone, 1e-8},
                               {10749, 16, pyramid, 1e-6},
                               {11443, 7, pyramid, 1e-4},
                               {13481, 12, pyramid, 1e-8},
                               {15849, 5, pyramid, 1e-6},
                               {10808, 18, cone, 1e-6},
                               {11711, 9, pyramid, 1e-8},
                               {11727, 6, pyramid, 1e-6},
                               {11733, 12, pyramid, 1e-6},
                               {12061, 17, pyramid, 1e-4},
                               {12321, 11, pyramid, 1e-6},
                               {13493, 5, pyramid, 1e-8},
                               {13859, 10, pyramid, 1e-8},
                               {14277, 10, pyramid, 1e-6}}) {
    const ContactProblem problem =
        samples::make_solvability(Solvability::solvable, hidden.seed, hidden.contacts);
    const ContactOptions options{.law = hidden.law, .tolerance = hidden.tolerance};
    const ContactSolution solution = solve_contacts(problem, options);

    EXPECT_TRUE(solution.converged()) << hidden.seed << ": " << solution.report.status_reason;
    EXPECT_LE(reference_eta(problem, solution, options), 2 * hidden.tolerance) << hidden.seed;
  }
}

/// Law: the last resorts, pivoting and starts from random impulses, solve problems that no single
/// method does. The latter count as Newton's method in the report.
TEST(ContactTruth, OtherStartsSolveWhatNoSingleMethodDoes) {
  struct Only {
    unsigned seed;
    Eigen::Index contacts;
    ContactOptions options;
    const char* by;  ///< the last method
  };
  constexpr FrictionLaw cone = FrictionLaw::cone, pyramid = FrictionLaw::pyramid;
  for (Only only : {Only{15849, 5, {.law = pyramid, .tolerance = 1e-6}, "pivoting"},
                    {11443, 7, {.law = pyramid, .tolerance = 1e-4}, "pivoting"},
                    {10808, 18, {.law = cone, .tolerance = 1e-6}, "newton"}}) {
    const ContactProblem problem =
        samples::make_solvability(Solvability::solvable, only.seed, only.contacts);

    const ContactReport report = solve_contacts(problem, only.options).report;

    EXPECT_EQ(report.status, ContactStatus::converged) << only.seed;
    EXPECT_TRUE(report.method.ends_with(only.by)) << only.seed << ": " << report.method;
    only.options.max_sweeps = 20000;
    only.options.max_newton = 400;
    for (const ContactMethod method : methods) {
      if (method == ContactMethod::automatic) continue;
      only.options.method = method;
      EXPECT_FALSE(solve_contacts(problem, only.options).converged())
          << only.seed << ", method " << static_cast<int>(method);
    }
  }
}

/// Impulses along a direction d with W d = 0 up to rounding enlarge r . W r by rounding errors; the
/// measure must not become small by them.
TEST(ContactTruth, NullSpaceImpulsesDoNotInflateTheScale) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(9, 3);
  jacobian.row(0) << 0.3, 0.7, 0.1;
  jacobian.row(3) << -0.2, 0.4, 0.5;
  jacobian.row(6) = -jacobian.row(0) - jacobian.row(3);
  ContactProblem problem;
  problem.delassus = samples::sparse_of(jacobian * jacobian.transpose());
  problem.free_velocity = {-0.1, 0, 0, 0.2, 0, 0, -0.3, 0, 0};
  problem.friction = {0, 0, 0};
  const reference::DenseContacts dense = reference::make_dense(problem);
  for (double size = 1; size < 1e15; size *= 10) {
    Eigen::VectorXd impulse = Eigen::VectorXd::Zero(9);
    for (const Eigen::Index normal : {0, 3, 6}) impulse(normal) = size;
    const double eta = residual_of(problem, samples::list_of(impulse), {}).eta;
    const double expected = reference::eta_of(dense, impulse, {});

    EXPECT_NEAR(eta, expected, 1e-6 * expected) << size;
    EXPECT_GT(eta, 1e-2) << size;
  }
  EXPECT_EQ(solve_contacts(problem).report.status, ContactStatus::infeasible);
}

/// Also ends: sweeps stop at once where numbers are not finite.
TEST(ContactTruth, NumbersThatOverflowDoNotConverge) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    for (const double factor : {1e155, 1e160, 1e300}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", times " << factor);
      ContactProblem problem = samples::make_solvability(Solvability::solvable, seed, 4);
      for (double& q : problem.free_velocity) q *= factor;
      for (const ContactMeasure measure : {ContactMeasure::eta, ContactMeasure::fclib}) {
        const ContactSolution solution = solve_contacts(problem, {.measure = measure});

        if (solution.converged()) {
          EXPECT_LE(reference_eta(problem, solution, {}), 2e-6);
        } else {
          EXPECT_EQ(solution.report.status, ContactStatus::not_converged);
          EXPECT_NE(solution.report.status_reason, "");
          EXPECT_GT(solution.report.residual.eta, 1e-6);
        }
        const ContactResidual residual = residual_of(problem, solution.impulse, {});
        EXPECT_FALSE(std::isnan(residual.eta) || std::isnan(residual.fclib));
      }
    }
  }
}

/// A Delassus matrix of 1e200 per kilogram makes impulses whose squares underflow.
TEST(ContactTruth, ImpulsesWhoseSquaresUnderflowAreMeasured) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const ContactProblem problem = samples::make_solvability(Solvability::solvable, seed, 4, 1e200);
    const ContactSolution solution = solve_contacts(problem, {.max_sweeps = 2000});
    const double expected = reference_eta(problem, solution, {});

    EXPECT_NEAR(residual_of(problem, solution.impulse, {}).eta, expected, 1e-9 + 1e-6 * expected);
    EXPECT_EQ(solution.converged(), expected <= 1e-6) << seed << " " << expected;
  }
}

TEST(ContactTruth, ResidualOfNumbersThatAreNotFiniteIsInfinite) {
  const ContactProblem problem = samples::make_solvability(Solvability::solvable, 3, 2);
  for (const double bad : {double{NAN}, double{INFINITY}}) {
    std::vector<double> impulse(6, 0.0);
    impulse[4] = bad;
    const ContactResidual residual = residual_of(problem, impulse, {});
    EXPECT_EQ(residual.eta, INFINITY);
    EXPECT_EQ(residual.fclib, INFINITY);
  }
}

/// Sweeps need some million to show that a chain of this length does not fit.
TEST(ContactTruth, LongChainsInAViceAreInfeasible) {
  for (const std::int64_t bodies : {10, 100, 1000}) {
    const ContactSolution solution = solve_contacts(samples::chain_in_a_vice(bodies, 0));

    EXPECT_EQ(solution.report.status, ContactStatus::infeasible)
        << bodies << ": " << solution.report.status_reason;
    for (const double r : solution.impulse) EXPECT_LE(std::abs(r), 1e3) << bodies;
  }
  const ContactSolution fits = solve_contacts(samples::chain_in_a_vice(100, 0, 0.01));
  EXPECT_TRUE(fits.converged()) << fits.report.status_reason;
}

/// One contact whose normal row is rounding, beside one with a normal row of 1.
TEST(ContactTruth, RowsThatAreRoundingAreRefused) {
  ContactProblem problem = samples::chain_in_a_vice(1, 0.5, 1);
  problem.velocity_offset = {-1, 0, 0, 1, 0, 0};
  for (const std::size_t entry : {0u, 1u}) {
    ContactProblem bad = problem;
    bad.jacobian.value[entry] = 1e-17;
    if (entry == 1) bad.jacobian.value[2] = 1e-17;
    try {
      check_problem(bad);
      ADD_FAILURE() << entry;
    } catch (const ContactProblemError& error) {
      EXPECT_NE(std::string(error.what()).find("contact 0"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("rounding"), std::string::npos) << error.what();
    }
  }
  EXPECT_NO_THROW(check_problem(problem));
}

}  // namespace tetwarp::test
