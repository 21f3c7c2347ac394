/// @file test_body_relax.cpp
/// Velocities of bodies from impulses, the defect of A v = b + J^T r, and the step that lowers it.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/body_relax.hpp"
#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/contact/contact_stages.hpp"

namespace tetwarp::test {
namespace {
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Numbers = std::vector<double>;

MatrixXd dense_of(const SparseMatrix& matrix) {
  MatrixXd dense = MatrixXd::Zero(matrix.rows, matrix.columns);
  for (Index row = 0; row < matrix.rows; ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (std::int64_t e = matrix.row_start[r]; e < matrix.row_start[r + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      dense(row, matrix.column[entry]) += matrix.value[entry];
    }
  }
  return dense;
}

/// A problem with arbitrary impulses and velocities, in both orders.
struct Relaxation {
  Relaxation(std::uint32_t seed, Index bodies, Index dofs, double coupling)
      : random(seed),
        problem(samples::random_global(random, bodies, dofs, coupling, 0.3)),
        stages(problem),
        system(dense_of(problem.system)),
        jacobian(dense_of(problem.jacobian)),
        load(samples::vector_of(problem.load)),
        impulse(samples::random_vector(random, jacobian.rows())),
        velocity(samples::random_vector(random, jacobian.cols())) {}

  Numbers by_slot(const VectorXd& rows) const {
    return placed(samples::list_of(rows), stages.structure.contact_of_slot, 3);
  }
  Numbers by_place(const VectorXd& dofs) const {
    return placed(samples::list_of(dofs), stages.structure.dof_of_place, 1);
  }
  std::int64_t block_count() const {
    return static_cast<std::int64_t>(stages.structure.dof_start.size()) - 1;
  }

  template <class Exec>
  Numbers defect(const Exec& exec, const Numbers& body_velocity) const {
    const Numbers r = by_slot(impulse);
    Numbers result(body_velocity.size());
    const ContactSystem<double>& s = stages.system;
    body_relax(exec, 0, block_count(),
               BodyDefectOp<double>{stages.numbers().system, stages.numbers().block_contacts,
                                    view_of(s.jacobian), view_of(s.load), view_of(r),
                                    view_of(body_velocity), view_of(result)});
    return result;
  }
  template <class Exec>
  Numbers relaxed(const Exec& exec,
                  std::int64_t first,
                  std::int64_t last,
                  double relaxation,
                  const Numbers& defect,
                  Numbers body_velocity) const {
    body_relax(
        exec, first, last,
        BodyRelaxOp<double>{view_of(stages.structure.dof_start),
                            view_of(stages.structure.inverse_start), view_of(stages.system.inverse),
                            relaxation, view_of(defect), view_of(body_velocity)});
    return body_velocity;
  }
  template <class Exec>
  Numbers velocity_from_impulse(const Exec& exec) const {
    const Numbers r = by_slot(impulse);
    Numbers result(stages.system.load.size());
    body_relax(
        exec, 0, block_count(),
        BodyVelocityOp<double>{stages.numbers().block_contacts, view_of(stages.structure.dof_start),
                               view_of(stages.system.response), view_of(r),
                               view_of(stages.system.body_free), view_of(result)});
    return result;
  }

  std::mt19937 random;
  ContactProblem problem;
  ContactStages stages;
  MatrixXd system, jacobian;
  VectorXd load, impulse, velocity;
};

const CpuExec exec(1);

/// Problems whose blocks are all nodes use separate code.
TEST(BodyRelax, ProductsAreTheSameWhetherOnlyNodesAreKnownOrNot) {
  const Relaxation c(96, 40, 3, 0.5);
  SystemView<double> known = c.stages.numbers().system;
  SystemView<double> looked_up = known;
  EXPECT_TRUE(known.has_only_nodes);
  looked_up.has_only_nodes = false;
  const Numbers x = c.by_place(c.velocity);
  for (std::int64_t b = 0; b < c.block_count(); ++b) {
    double a[3], d[3];

    multiply_block_row(known, b, x.data(), a);

    multiply_block_row(looked_up, b, x.data(), d);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(a[i], d[i]) << b;
  }
  EXPECT_FALSE(Relaxation(97, 4, 6, 0.5).stages.structure.has_only_nodes);
}

/// The stage equals the two stages that it combines, which have separate tests.
TEST(BodyRelax, AStepIsTheDefectAndItsRelaxation) {
  for (const Index dofs : {3, 6, 12}) {
    const Relaxation c(98, 7, dofs, 0.5);
    const Numbers r = c.by_slot(c.impulse), x = c.by_place(c.velocity);
    Numbers defect(x.size()), v(x.size(), -1.0);
    const ContactStructure& s = c.stages.structure;

    body_relax(exec, 0, c.block_count(),
               BodyStepOp<double>{{c.stages.numbers().system, c.stages.numbers().block_contacts,
                                   view_of(c.stages.system.jacobian), view_of(c.stages.system.load),
                                   view_of(r), view_of(x), view_of(defect)},
                                  view_of(s.inverse_start),
                                  view_of(c.stages.system.inverse),
                                  0.5,
                                  view_of(v)});

    EXPECT_EQ(v, c.relaxed(exec, 0, c.block_count(), 0.5, c.defect(exec, x), x));
  }
}

TEST(BodyRelax, DefectIsWhatTheEquationLeaves) {
  for (const Index dofs : {3, 6, 12}) {
    for (const double coupling : {0.0, 0.5}) {
      const Relaxation x(71, 5, dofs, coupling);
      const VectorXd expected = x.load + x.jacobian.transpose() * x.impulse - x.system * x.velocity;

      EXPECT_LE(relative_distance(x.defect(exec, x.by_place(x.velocity)), x.by_place(expected)),
                1e-13)
          << dofs << " dofs";
    }
  }
}

/// Without coupling one step with omega = 1 reaches the solution from any start.
TEST(BodyRelax, IsExactInOneStepForBodiesOfTheirOwn) {
  for (const Index dofs : {3, 6, 12}) {
    const Relaxation x(72, 7, dofs, 0);
    const VectorXd solution =
        samples::solve_spd(x.system, x.load + x.jacobian.transpose() * x.impulse);
    const Numbers start = x.by_place(x.velocity);

    const Numbers after = x.relaxed(exec, 0, x.block_count(), 1, x.defect(exec, start), start);

    EXPECT_LE(relative_distance(after, x.by_place(solution)), 1e-12);
    EXPECT_LE(relative_distance(x.velocity_from_impulse(exec), x.by_place(solution)), 1e-12);
  }
}

/// v + omega D^-1 d, D the diagonal blocks of A.
TEST(BodyRelax, StepsByTheInverseOfTheDiagonalBlocks) {
  constexpr double omega = 0.3;
  const Relaxation x(73, 6, 6, 0.4);
  VectorXd expected = x.velocity;
  for (Index b = 0; b < 6; ++b) {
    expected.segment<6>(6 * b) +=
        omega * samples::solve_spd(x.system.block<6, 6>(6 * b, 6 * b), x.load.segment<6>(6 * b));
  }

  const Numbers after = x.relaxed(exec, 0, 6, omega, x.by_place(x.load), x.by_place(x.velocity));

  EXPECT_LE(relative_distance(after, x.by_place(expected)), 1e-13);
}

TEST(BodyRelax, ConvergesToTheCoupledSolution) {
  const Relaxation x(74, 6, 6, 0.4);
  const VectorXd solution =
      samples::solve_spd(x.system, x.load + x.jacobian.transpose() * x.impulse);
  Numbers v = x.by_place(x.velocity);

  for (int step = 0; step < 400; ++step) v = x.relaxed(exec, 0, 6, 0.5, x.defect(exec, v), v);

  EXPECT_LE(relative_distance(v, x.by_place(solution)), 1e-10);
}

TEST(BodyRelax, ChangesTheSelectedBlocksOnly) {
  const Relaxation x(75, 6, 6, 0);
  const Numbers before = x.by_place(x.velocity);

  const Numbers after = x.relaxed(exec, 2, 4, 1, x.by_place(x.load), before);

  for (std::size_t dof = 0; dof < after.size(); ++dof) {
    EXPECT_EQ(after[dof] != before[dof], dof >= 12 && dof < 24) << dof;
  }
}

TEST(BodyRelax, EveryBlockGathersItsContactsInOrder) {
  const Relaxation x(76, 9, 6, 0);
  const ContactStructure& s = x.stages.structure;
  std::vector<int> touches(s.contact_of_slot.size(), 0);
  for (std::size_t b = 0; b + 1 < s.block_start.size(); ++b) {
    const auto first = s.block_contact.begin() + s.block_start[b];
    const auto last = s.block_contact.begin() + s.block_start[b + 1];
    EXPECT_TRUE(std::is_sorted(first, last)) << "block " << b;
    std::for_each(first, last, [&](std::int32_t c) { ++touches[static_cast<std::size_t>(c)]; });
  }
  for (std::size_t slot = 0; slot < touches.size(); ++slot) {
    EXPECT_EQ(touches[slot], s.contact_of_slot[slot] < 9 ? 1 : 2);  // the floor has no block
  }
}

/// 1100 points are enough for the executor to use threads.
TEST(BodyRelax, HasTheSameBitsInAnyOrderAndForAnyNumberOfThreads) {
  constexpr std::int32_t points = 1100;
  std::mt19937 random(77);
  ContactProblem problem;
  problem.system = {3 * points, 3 * points, {0}, {}, {}};
  for (std::int32_t row = 0; row < 3 * points; ++row) {
    problem.system.column.push_back(row);
    problem.system.value.push_back(1 + 0.37 * (row % 11));
    problem.system.row_start.push_back(row + 1);
  }
  problem.jacobian = problem.system;
  problem.load = samples::list_of(samples::random_vector(random, 3 * points));
  problem.velocity_offset.assign(problem.load.size(), 0.0);
  problem.friction.assign(points, 0.5);
  const ContactStages stages(problem);
  const Numbers start(problem.load.size(), 0.25);
  const auto step = [&](const auto& executor) {
    Numbers v = start;
    body_relax(executor, 0, points,
               BodyRelaxOp<double>{
                   view_of(stages.structure.dof_start), view_of(stages.structure.inverse_start),
                   view_of(stages.system.inverse), 0.7, view_of(stages.system.load), view_of(v)});
    return v;
  };

  const Numbers one = step(exec);

  EXPECT_NE(one, start);
  EXPECT_EQ(step(ReversedExec{}), one);
  EXPECT_EQ(step(CpuExec(2)), one);
  EXPECT_EQ(step(CpuExec(3)), one);
}
}  // namespace
}  // namespace tetwarp::test
