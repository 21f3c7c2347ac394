/// @file test_contact_newton.cpp
/// Problems on which sweeps converge slowly: semismooth Newton continues to 1e-12.
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/newton/newton.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {
namespace {
/// Method automatic reaches 1e-12 within 3000 sweeps.
void expect_solved(const ContactProblem& problem, FrictionLaw law) {
  const ContactOptions options{.law = law, .tolerance = 1e-12, .max_sweeps = 3000};

  const ContactSolution solution = solve_contacts(problem, options);

  EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
  EXPECT_LE(solution.report.sweeps, 3000);
  const ContactResidual residual =
      residual_of(problem, solution.impulse, solution.body_velocity, options);
  EXPECT_LE(residual.eta, 1.1e-12);
  EXPECT_LE(residual.balance, 1e-12);
}

/// Ten sweeps leave most of the error, which Newton's method removes.
TEST(ContactNewton, ConvergesFromTenSweeps) {
  const ContactProblem problem = scenes::box_stack({.mass_ratio = 1e2, .friction = 0.5});
  ContactOptions options{
      .method = ContactMethod::gauss_seidel, .tolerance = 1e-12, .max_sweeps = 10};
  EXPECT_FALSE(solve_contacts(problem, options).converged());

  options.method = ContactMethod::newton;
  const ContactSolution solution = solve_contacts(problem, options);

  EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
  EXPECT_GT(solution.report.newton_iterations, 0);
  EXPECT_LE(solution.report.sweeps, 10);
}

/// Ten boxes on four corners each, the highest heavier than the lowest.
TEST(ContactNewton, SolvesStacksUnderHeavyBoxes) {
  for (const double ratio : {1e2, 1e4, 1e6}) {
    for (const double friction : {0.1, 0.5, 0.9}) {
      SCOPED_TRACE(testing::Message() << "mass ratio " << ratio << ", friction " << friction);
      expect_solved(scenes::box_stack({.mass_ratio = ratio, .friction = friction}),
                    FrictionLaw::cone);
    }
  }
}

/// Spheres that touch all their neighbors, nine contacts each: more contact rows than degrees of
/// freedom, so that impulses are not unique.
TEST(ContactNewton, SolvesDensePackings) {
  const ContactProblem small = scenes::sphere_packing({.edge = 3, .friction = 0.5, .gaps = 0});
  const ContactProblem large = scenes::sphere_packing({.edge = 4, .friction = 0.3, .gaps = 0});
  expect_solved(small, FrictionLaw::cone);
  expect_solved(large, FrictionLaw::cone);
}

/// Law: of jams that 200 sweeps leave, proximal points from these impulses solve few, those from
/// the solutions of convex problems all.
TEST(ContactNewton, ConvexProblemsGiveStartsThatSweepsDoNot) {
  int left = 0, near = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const ContactProblem problem = scenes::jam({.seed = seed});
    const ContactOptions options{
        .method = ContactMethod::anderson, .tolerance = 1e-8, .max_sweeps = 200};
    const ContactSolution swept = solve_contacts(problem, options);
    if (swept.converged()) continue;
    ++left;
    const auto is_solved = [&](NewtonPhases phases) {
      std::vector<double> impulse = swept.impulse, velocity;
      return newton_polish(problem, options, impulse, velocity, nullptr,
                           {.total = 60, .phases = phases})
          .converged;
    };
    near += is_solved(NewtonPhases::near) ? 1 : 0;
    EXPECT_TRUE(is_solved(NewtonPhases::far)) << seed;
  }
  EXPECT_GE(left, 8);
  EXPECT_LE(near, left / 4);
}

/// In more than half of the jams that neither sweeps nor proximal points solve no contact slides,
/// in the others few do: the associated problem gives Newton its starting point.
TEST(ContactNewton, SolvesJams) {
  for (const auto& [seed, friction] : {std::pair{12u, 1.0}, {13u, 2.0}, {17u, 2.0}, {58u, 1.0}}) {
    const ContactProblem problem = scenes::jam({.seed = seed, .friction = friction});
    for (const FrictionLaw law : {FrictionLaw::cone, FrictionLaw::pyramid}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", friction " << friction << ", law "
                                      << static_cast<int>(law));
      expect_solved(problem, law);
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
