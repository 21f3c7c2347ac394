/// @file test_contact_sweep.cpp
/// A sweep over colors is a sweep over contacts in sequence, in either form.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "host/contact/sweeps/run.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/reference/contact/dense.hpp"
#include "kernels/contact/contact_sweep.hpp"
#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/contact/contact_stages.hpp"

namespace tetwarp::test {
namespace {
using Eigen::Index;

const ContactOptions option_variants[] = {
    {},
    {.rule = AdhesionRule::restrictive},
    {.law = FrictionLaw::pyramid},
    {.law = FrictionLaw::pyramid, .rule = AdhesionRule::restrictive}};

/// Bodies in a row, some contacts of which adhere; with `is_local`, its local form.
ContactProblem row_of_bodies(std::uint32_t seed, Index bodies, bool is_local) {
  std::mt19937 random(seed);
  ContactProblem problem = samples::random_global(random, bodies, 6, 0, 0.4);
  problem.adhesion =
      samples::adhesion_of(random, samples::random_kappa(random, problem.contact_count()));
  if (!is_local) return problem;
  const reference::DenseContacts dense = reference::make_dense(problem);
  ContactProblem local;
  // Contacts that share no body are not coupled: leave rounding errors of A^-1 out.
  local.delassus = samples::sparse_of(
      dense.delassus.unaryExpr([](double w) { return std::abs(w) < 1e-12 ? 0 : w; }));
  local.free_velocity = samples::list_of(dense.free_velocity);
  local.friction = problem.friction;
  local.adhesion = problem.adhesion;
  return local;
}

/// Impulses and, in global form, velocities of bodies.
struct Swept {
  std::vector<double> impulse, body_velocity;
  bool operator==(const Swept&) const = default;
};

template <class Exec>
Swept sweep(const Exec& exec,
            const ContactStages& stages,
            const ContactOptions& options,
            View<const std::int64_t> colors,
            int sweeps,
            const FrozenContacts<double>& frozen = {}) {
  const ContactSystem<double>& system = stages.system;
  Swept swept = {std::vector<double>(system.free_velocity.size()), system.body_free};
  for (int s = 0; s < sweeps; ++s) {
    if (stages.structure.is_local) {
      contact_sweep(exec, colors,
                    DelassusSweepOp<double>{stages.numbers().delassus, view_of(system.constants),
                                            switches_of(options), frozen, view_of(swept.impulse)});
    } else {
      contact_sweep(exec, colors,
                    BodySweepOp<double>{stages.numbers().bodies, view_of(system.constants),
                                        switches_of(options), frozen, view_of(swept.impulse),
                                        view_of(swept.body_velocity)});
    }
  }
  return swept;
}

class ContactSweep : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Of, ContactSweep, ::testing::Bool(), [](const auto& info) {
  return info.param ? std::string("Delassus") : std::string("Bodies");
});

/// For any order within a color the bits equal those of a serial pass sorted by (color, index).
TEST_P(ContactSweep, HasTheBitsOfTheSequence) {
  const ContactStages stages(row_of_bodies(61, 12, GetParam()));
  const std::vector<std::int64_t> one_run = {
      0, static_cast<std::int64_t>(stages.system.constants.size())};
  ASSERT_LT(stages.colors().size, 6);
  for (const ContactOptions& options : option_variants) {
    const Swept sequence = sweep(CpuExec(1), stages, options, view_of(one_run), 5);

    EXPECT_EQ(sweep(CpuExec(1), stages, options, stages.colors(), 5), sequence);
    EXPECT_EQ(sweep(ReversedExec{}, stages, options, stages.colors(), 5), sequence);
    EXPECT_NE(sweep(ReversedExec{}, stages, options, view_of(one_run), 5), sequence);
  }
}

/// Comparison with a dense matrix whose velocities are recomputed for every contact.
TEST_P(ContactSweep, FollowsTheDenseDelassusMatrix) {
  for (const Index bodies : {1, 2, 9}) {
    const ContactProblem problem = row_of_bodies(62, bodies, GetParam());
    const ContactStages stages(problem);
    const reference::DenseContacts dense = reference::make_dense(problem);
    for (const ContactOptions& options : option_variants) {
      Eigen::VectorXd impulse = Eigen::VectorXd::Zero(dense.free_velocity.size());
      for (int s = 0; s < 4; ++s) {
        for (std::size_t slot = 0; slot < stages.system.constants.size(); ++slot) {
          const Index row = 3 * Index{stages.structure.contact_of_slot[slot]};
          Eigen::Vector3d u = dense.velocity(impulse).segment<3>(row);
          solve_contact(stages.system.constants[slot], switches_of(options), u.data(),
                        impulse.data() + row);
        }
      }

      const Swept swept = sweep(CpuExec(1), stages, options, stages.colors(), 4);

      const std::vector<double> expected =
          placed(samples::list_of(impulse), stages.structure.contact_of_slot, 3);
      EXPECT_LE(relative_distance(swept.impulse, expected), 1e-11) << bodies << " bodies";
    }
  }
}

/// Colors of many and of few contacts; 1025 are enough to use threads.
TEST_P(ContactSweep, HasTheSameBitsForAnyNumberOfThreads) {
  for (const std::int64_t size : {1, 31, 32, 33, 1025}) {
    std::mt19937 random(63);
    const Index rows = 3 * static_cast<Index>(size);
    ContactProblem problem;
    SparseMatrix diagonal = {rows, rows, {0}, {}, {}};
    for (std::int32_t row = 0; row < rows; ++row) {
      diagonal.column.push_back(row);
      diagonal.value.push_back(1 + 0.001 * row);
      diagonal.row_start.push_back(row + 1);
    }
    const std::vector<double> free = samples::list_of(samples::random_vector(random, rows));
    if (GetParam()) {
      problem.delassus = diagonal;
      problem.free_velocity = free;
    } else {
      problem.system = problem.jacobian = diagonal;
      problem.load.assign(free.size(), 0.0);
      problem.velocity_offset = free;
    }
    problem.friction.assign(static_cast<std::size_t>(size), 0.5);
    const ContactStages stages(problem);
    const Swept one = sweep(CpuExec(1), stages, {}, stages.colors(), 2);

    EXPECT_EQ(sweep(CpuExec(2), stages, {}, stages.colors(), 2), one) << size;
    EXPECT_EQ(sweep(CpuExec(3), stages, {}, stages.colors(), 2), one) << size;
    EXPECT_NE(one.impulse, std::vector<double>(free.size()));
  }
}

TEST_P(ContactSweep, WithoutColorsOrWithAnEmptyOneDoesNothing) {
  const ContactStages stages(row_of_bodies(65, 2, GetParam()));
  const std::vector<std::int64_t> none = {}, empty = {1, 1};

  for (const View<const std::int64_t> colors : {view_of(none), view_of(empty)}) {
    const Swept swept = sweep(CpuExec(1), stages, {}, colors, 1);
    EXPECT_EQ(swept.impulse, std::vector<double>(9));
    EXPECT_EQ(swept.body_velocity, stages.system.body_free);
  }
}

TEST_P(ContactSweep, SkipsFrozenContactsAndCountsThem) {
  const ContactStages stages(row_of_bodies(64, 4, GetParam()));
  std::vector<std::uint8_t> unchanged_visits(7, 0);
  std::vector<std::int32_t> skipped_visits(7, 0);
  unchanged_visits[2] = unchanged_visits[5] = FrozenContacts<double>::visits_to_freeze;
  const FrozenContacts<double> frozen = {view_of(unchanged_visits), view_of(skipped_visits), false,
                                         0};

  const Swept swept = sweep(CpuExec(1), stages, {}, stages.colors(), 3, frozen);

  EXPECT_EQ(skipped_visits, (std::vector<std::int32_t>{0, 0, 3, 0, 0, 3, 0}));
  for (const std::size_t slot : {2U, 5U}) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(swept.impulse[3 * slot + a], 0);
  }
  EXPECT_GT(relative_distance(swept.impulse, std::vector<double>(21, 1e-300)), 1);
}
}  // namespace
}  // namespace tetwarp::test
