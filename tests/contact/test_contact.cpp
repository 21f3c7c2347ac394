/// @file test_contact.cpp
/// Whole solves: every method against the reference, and changes that must not affect a result.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include <tetwarp/contact.hpp>

#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_stages.hpp"
#include "tests/support/contact/contact_transforms.hpp"

namespace tetwarp::test {
namespace {
using Numbers = std::vector<double>;

// ---- comparison with the reference

using Variant = std::tuple<ContactMethod, FrictionLaw, AdhesionRule>;

class ContactSolve : public ::testing::TestWithParam<Variant> {
 protected:
  ContactOptions options() const {
    const auto [method, law, rule] = GetParam();
    return {.law = law, .rule = rule, .method = method, .tolerance = 1e-10, .max_sweeps = 100000};
  }
  void expect_reference(const ContactProblem& problem, const std::string& what) const {
    ContactOptions choice = options();
    const ContactSolution solution = solve_contacts(problem, choice);
    choice.backend = Backend::reference;
    const ContactSolution reference = solve_contacts(problem, choice);

    ASSERT_TRUE(reference.converged()) << what;
    EXPECT_TRUE(solution.converged()) << what << ": " << solution.report.status_reason;
    const ContactResidual residual =
        residual_of(problem, solution.impulse, solution.body_velocity, options());
    EXPECT_LE(residual.eta, 2e-10) << what;
    EXPECT_LE(residual.balance, 1e-12) << what;
    EXPECT_NEAR(solution.report.residual.eta, residual.eta, 1e-12) << what;
    EXPECT_LE(relative_distance(solution.velocity, reference.velocity), 1e-7) << what;
    if (problem.is_local()) return;
    EXPECT_LE(relative_distance(solution.body_velocity, reference.body_velocity), 1e-7) << what;
  }
};

std::string name_of_variant(const ::testing::TestParamInfo<Variant>& info) {
  const auto [method, law, rule] = info.param;
  return std::string(report_name_of(method)) + (law == FrictionLaw::cone ? "_cone" : "_pyramid") +
         (rule == AdhesionRule::parallel ? "_parallel" : "_restrictive");
}
INSTANTIATE_TEST_SUITE_P(
    By,
    ContactSolve,
    ::testing::Combine(::testing::ValuesIn(methods),
                       ::testing::Values(FrictionLaw::cone, FrictionLaw::pyramid),
                       ::testing::Values(AdhesionRule::parallel, AdhesionRule::restrictive)),
    name_of_variant);

TEST_P(ContactSolve, HasTheVelocitiesOfTheReferenceInLocalForm) {
  for (const std::int64_t contacts : {1, 2, 3, 5, 9, 17, 30}) {
    expect_reference(local_problem(81, contacts), std::to_string(contacts) + " contacts");
  }
}

TEST_P(ContactSolve, HasTheVelocitiesOfTheReferenceInGlobalForm) {
  for (const double coupling : {0.0, 0.4}) {
    for (const Eigen::Index bodies : {1, 2, 5, 12}) {
      expect_reference(global_problem(82, bodies, coupling),
                       std::to_string(bodies) + " bodies, coupling " + std::to_string(coupling));
    }
  }
}

// ---- one method

class EachMethod : public ::testing::TestWithParam<ContactMethod> {};
INSTANTIATE_TEST_SUITE_P(By, EachMethod, ::testing::ValuesIn(methods), [](const auto& info) {
  return report_name_of(info.param);
});

/// Springs up to 1 kg; the impulses of stiffer ones are small differences of rounded velocities.
TEST_P(EachMethod, ReachesTenThousandthsInFloat32) {
  for (ContactProblem problem : {local_problem(83, 20), global_problem(83, 10, 0)}) {
    AdhesionState& adhesion = problem.adhesion;
    for (double& stiffness : adhesion.stiffness) stiffness = std::min(stiffness, 1.0);
    adhesion.tangential_stiffness = adhesion.stiffness;
    const ContactOptions options{
        .method = GetParam(), .tolerance = 1e-4, .precision = ContactPrecision::float32};

    const ContactSolution solution = solve_contacts(problem, options);

    EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
    EXPECT_LE(residual_of(problem, solution.impulse, solution.body_velocity).eta, 1e-4);
  }
}

TEST_P(EachMethod, ReturnsTheBestIterateWhereSweepsRunOut) {
  const bool may_polish =
      GetParam() == ContactMethod::automatic || GetParam() == ContactMethod::newton;
  for (const std::int64_t budget : {1, 7}) {
    const ContactProblem problem = local_problem(84, 25);

    const ContactSolution solution =
        solve_contacts(problem, {.method = GetParam(), .tolerance = 1e-14, .max_sweeps = budget});

    const Numbers& history = solution.report.residual_history;
    ASSERT_FALSE(history.empty());
    EXPECT_LE(solution.report.sweeps, budget);
    EXPECT_LT(solution.report.residual.eta, 1);
    EXPECT_LE(solution.report.residual.eta,
              *std::min_element(history.begin(), history.end()) * (1 + 1e-6));
    if (may_polish) continue;
    EXPECT_EQ(solution.report.status, ContactStatus::not_converged);
    EXPECT_NE(solution.report.status_reason, "");
  }
}

TEST_P(EachMethod, AWarmStartTakesFewerSweeps) {
  ContactProblem problem = local_problem(85, 25);
  const ContactOptions options{.method = GetParam(), .tolerance = 1e-8};
  const ContactSolution cold = solve_contacts(problem, options);
  problem.impulse_guess = cold.impulse;
  const ContactSolution same = solve_contacts(problem, options);
  for (double& value : problem.free_velocity) value *= 1.0001;
  const ContactSolution near = solve_contacts(problem, options);

  EXPECT_EQ(same.report.sweeps, 0);
  EXPECT_EQ(same.impulse, cold.impulse);
  EXPECT_TRUE(near.converged());
  EXPECT_LT(near.report.sweeps, cold.report.sweeps);
}

TEST_P(EachMethod, HasTheSameBitsForAnyNumberOfThreads) {
  for (const ContactProblem& problem :
       {local_problem(86, 30), global_problem(86, 15, 0), global_problem(86, 8, 0.4)}) {
    ContactOptions options{.method = GetParam(), .tolerance = 1e-9, .threads = 1};
    const ContactSolution one = solve_contacts(problem, options);
    for (options.threads = 2; options.threads <= 3; ++options.threads) {
      expect_same_bits(solve_contacts(problem, options), one, std::to_string(options.threads));
    }
  }
}

TEST_P(EachMethod, TheOrderOfContactsAndBodiesDoesNotMatter) {
  for (const double coupling : {0.0, 0.4}) {
    const ContactProblem problem = global_problem(87, 10, coupling);
    const ContactOptions options{.method = GetParam(), .tolerance = 1e-10, .max_sweeps = 100000};
    const ContactSolution original = solve_contacts(problem, options);
    const ContactCase other = permuted({problem, original.impulse, original.body_velocity}, 88);

    const ContactSolution solution = solve_contacts(other.problem, options);

    EXPECT_NE(other.problem.friction.size(), 0U);
    EXPECT_NE(solution.body_velocity, original.body_velocity);
    EXPECT_LE(relative_distance(solution.body_velocity, other.body_velocity), 1e-7);
  }
}
}  // namespace
}  // namespace tetwarp::test
