/// @file contact_methods.hpp
/// Small problems and all methods, for tests of whole solves.
#pragma once
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

#include <tetwarp/contact.hpp>

#include "tests/contact_samples.hpp"

namespace tetwarp::test {

inline constexpr ContactMethod methods[] = {
    ContactMethod::automatic, ContactMethod::gauss_seidel,   ContactMethod::nonlinear_cg,
    ContactMethod::anderson,  ContactMethod::mass_splitting, ContactMethod::newton};

inline ContactProblem local_problem(std::uint32_t seed, std::int64_t contacts) {
  std::mt19937 random(seed);
  return samples::random_local(random, contacts, 0.3, samples::random_kappa(random, contacts), 10);
}

/// Six-dof bodies in a row, on a floor and linked by contacts; coupled ones by A as well.
inline ContactProblem global_problem(std::uint32_t seed, Eigen::Index bodies, double coupling) {
  std::mt19937 random(seed);
  ContactProblem problem = samples::random_global(random, bodies, 6, coupling, 0.3);
  problem.adhesion =
      samples::adhesion_of(random, samples::random_kappa(random, problem.contact_count()));
  for (std::size_t c = 0; c < problem.friction.size(); ++c) {
    problem.adhesion.gap[3 * c] = 0.5 * problem.velocity_offset[3 * c];  // gap = dt w_n
  }
  return problem;
}

inline std::string name_of(ContactMethod method) {
  static constexpr const char* names[] = {"automatic", "gauss_seidel",   "nonlinear_cg",
                                          "anderson",  "mass_splitting", "newton"};
  return names[static_cast<int>(method)];
}

/// Everything a solve computes.
inline void expect_same_bits(const ContactSolution& a,
                             const ContactSolution& b,
                             const std::string& what) {
  EXPECT_EQ(a.impulse, b.impulse) << what;
  EXPECT_EQ(a.velocity, b.velocity) << what;
  EXPECT_EQ(a.body_velocity, b.body_velocity) << what;
  EXPECT_EQ(a.report.residual_history, b.report.residual_history) << what;
  EXPECT_EQ(a.report.sweeps, b.report.sweeps) << what;
}

}  // namespace tetwarp::test
