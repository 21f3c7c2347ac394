/// @file test_contact_stress_truth.cpp
/// Statuses of thousands of problems with and without solutions, with every law and method.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/truth.hpp"

namespace tetwarp::test {
using samples::Solvability;

TEST(ContactStress, StatusesOfProblemsOfKnownSolvabilityAreTrue) {
  for (unsigned seed = 1000; seed < 2000; ++seed) {
    for (const Solvability kind :
         {Solvability::solvable, Solvability::infeasible, Solvability::jammed}) {
      const std::string name =
          "kind " + std::to_string(static_cast<int>(kind)) + ", seed " + std::to_string(seed);
      const FrictionLaw law = seed % 2 == 0 ? FrictionLaw::cone : FrictionLaw::pyramid;
      const ContactProblem problem = samples::make_solvability(kind, seed, 2 + seed % 19, 1, law);
      expect_truth(problem, kind, {.law = law, .tolerance = 1e-8, .max_sweeps = 2000}, name);
      if (seed % 10 != 0) continue;
      for (const ContactMethod method : methods) {
        expect_truth(problem, kind, {.law = law, .method = method, .max_sweeps = 5000}, name);
      }
    }
  }
}

}  // namespace tetwarp::test
