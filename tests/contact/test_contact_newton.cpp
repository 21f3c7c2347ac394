/// @file test_contact_newton.cpp
/// Where sweeps stall far from a solution, semismooth Newton goes on to 1e-12.
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include <tetwarp/contact.hpp>

#include "tests/scenes/contact_scenes.hpp"

namespace tetwarp::test {
namespace {

/// 3000 plain sweeps leave more than `stall`, method automatic less than 1e-12.
void expect_polish(const ContactProblem& problem, double stall, FrictionLaw law) {
  ContactOptions options{
      .law = law, .method = ContactMethod::gauss_seidel, .tolerance = 1e-12, .max_sweeps = 3000};
  EXPECT_GT(solve_contacts(problem, options).report.residual.eta, stall);

  options.method = ContactMethod::automatic;
  const ContactSolution solution = solve_contacts(problem, options);

  EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
  EXPECT_GT(solution.report.newton_iterations, 0);
  EXPECT_LE(solution.report.sweeps, 3000);
  const ContactResidual residual =
      residual_of(problem, solution.impulse, solution.body_velocity, options);
  EXPECT_LE(residual.eta, 1.1e-12);
  EXPECT_LE(residual.balance, 1e-12);
}

/// Ten boxes on four corners each, the highest heavier than the lowest.
TEST(ContactNewton, SolvesStacksUnderHeavyBoxes) {
  for (const double ratio : {1e2, 1e4, 1e6}) {
    for (const double friction : {0.1, 0.5, 0.9}) {
      SCOPED_TRACE(testing::Message() << "mass ratio " << ratio << ", friction " << friction);
      expect_polish(scenes::box_stack({.mass_ratio = ratio, .friction = friction}), 1e-5,
                    FrictionLaw::cone);
    }
  }
}

/// Spheres that touch all their neighbors, nine contacts each: the contacts say more than the
/// bodies can follow, and friction resists whichever way.
TEST(ContactNewton, SolvesDensePackings) {
  const ContactProblem small = scenes::sphere_packing({.edge = 3, .friction = 0.5, .gaps = 0});
  const ContactProblem large = scenes::sphere_packing({.edge = 4, .friction = 0.3, .gaps = 0});
  expect_polish(small, 1e-6, FrictionLaw::cone);
  expect_polish(large, 1e-6, FrictionLaw::cone);
}

/// More than half of all jams that neither sweeps nor proximal points alone solve slide nowhere,
/// and in others little does: there the associated problem shows the way.
TEST(ContactNewton, SolvesJams) {
  for (const auto& [seed, friction] : {std::pair{12u, 1.0}, {13u, 2.0}, {17u, 2.0}, {58u, 1.0}}) {
    const ContactProblem problem = scenes::jam({.seed = seed, .friction = friction});
    for (const FrictionLaw law : {FrictionLaw::cone, FrictionLaw::pyramid}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", friction " << friction << ", law "
                                      << static_cast<int>(law));
      expect_polish(problem, 1e-5, law);
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
