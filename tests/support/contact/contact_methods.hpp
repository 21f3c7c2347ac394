/// @file contact_methods.hpp
/// Small problems and all methods, for tests of whole solves.
#pragma once
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/sweeps/method_names.hpp"
#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp::test {

inline constexpr ContactMethod methods[] = {ContactMethod::automatic, ContactMethod::gauss_seidel,
                                            ContactMethod::nonlinear_cg, ContactMethod::anderson,
                                            ContactMethod::newton};

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

/// Bodies that A couples, by the outer iteration.
inline ContactOptions iterated(ContactMethod method = ContactMethod::automatic) {
  return {.method = method, .tolerance = 1e-8, .expert = {.coupling = ContactCoupling::iterated}};
}

/// Two problems in global form, with block starts or without, joined without any coupling.
inline ContactProblem joined(ContactProblem a, const ContactProblem& b) {
  const std::int64_t dofs = a.dof_count();
  const auto append = [&](SparseMatrix& to, const SparseMatrix& from) {
    const std::int64_t entries = to.row_start.back();
    for (std::size_t row = 1; row < from.row_start.size(); ++row) {
      to.row_start.push_back(entries + from.row_start[row]);
    }
    for (const std::int32_t column : from.column) {
      to.column.push_back(static_cast<std::int32_t>(column + dofs));
    }
    to.value.insert(to.value.end(), from.value.begin(), from.value.end());
    to.rows += from.rows;
    to.columns += from.columns;
  };
  append(a.system, b.system);
  append(a.jacobian, b.jacobian);
  for (const auto part :
       {&ContactProblem::load, &ContactProblem::velocity_offset, &ContactProblem::friction}) {
    (a.*part).insert((a.*part).end(), (b.*part).begin(), (b.*part).end());
  }
  using State = AdhesionState;
  for (const auto part : {&State::area, &State::stiffness, &State::tangential_stiffness,
                          &State::intensity, &State::gap, &State::energy, &State::viscosity,
                          &State::bonding_rate, &State::saturation_pressure}) {
    std::vector<double>& values = a.adhesion.*part;
    values.insert(values.end(), (b.adhesion.*part).begin(), (b.adhesion.*part).end());
  }
  for (std::size_t k = 1; k < b.block_start.size(); ++k) {
    a.block_start.push_back(static_cast<std::int32_t>(dofs) + b.block_start[k]);
  }
  return a;
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
