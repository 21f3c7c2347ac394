/// The parts of CondensedSolver, on two tied blocks, against dense matrices.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Dense>

#include "host/simulate/solve/condensed/condensed_solver.hpp"
#include "host/simulate/solve/problem/step_rows.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/stack_scenes.hpp"

namespace tetwarp::test {
namespace {

/// A step of tied blocks: its system, J of all contacts, and both as dense matrices.
struct TiedSystem {
  explicit TiedSystem(double youngs = 1e6) : scene(tied_scene(youngs, 1e4)) {
    ContactTrackerOptions tracking;
    tracking.materials[0].friction = 0.4;
    ContactTracker tracker(tracking);
    stepper->solve(input_for(scene.model, stack_step, {3, 1, -9.81}));
    const auto contacts = scene.begin(tracker, scene.model.start, stack_step);
    system = stepper->system();
    step_rows.begin(scene.model.start, contacts);
    step_rows.set_all();
    islands.join(step_rows.sides());
    laws.friction.assign(contacts.size(), 0.4);
    share.clear(islands.count());
    share.islands.assign(share.islands.size(), 1);
    for (std::int32_t c = 0; c < std::ssize(contacts); ++c) share.contacts.push_back(c);
    places.set(system.rows, islands);
    for (std::int32_t i = 0; i < islands.count(); ++i) {
      coupling.emplace_back().set(places.of(i));
    }
    jacobian.set(rows(), share.contacts, places.row_of_block());
  }

  const ContactRows& rows() const { return step_rows.rows(); }
  Eigen::MatrixXd dense_system() const {
    const std::int32_t count = system.rows.unknown_count;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    for (std::int32_t row = 0; row < count; ++row) {
      for (std::int32_t k = system.rows.start[row]; k < system.rows.free_end[row]; ++k) {
        a.block<3, 3>(3 * row, 3 * system.rows.column[k]) =
            Eigen::Map<const Eigen::Matrix3d>(system.values.data + 9 * std::int64_t{k});
      }
    }
    return a;
  }
  Eigen::MatrixXd dense_jacobian() const {
    Eigen::MatrixXd j =
        Eigen::MatrixXd::Zero(3 * std::ssize(share.contacts), 3 * system.rows.unknown_count);
    for (std::size_t c = 0; c < share.contacts.size(); ++c) {
      for (std::int32_t e = rows().start[c]; e < rows().start[c + 1]; ++e) {
        const std::int32_t row = places.row_of_block()[at(rows().block[at(e)])];
        if (row < 0) continue;
        j.block<3, 3>(3 * static_cast<Eigen::Index>(c), 3 * row) =
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
                rows().value[at(e)].data());
      }
    }
    return j;
  }

  HandScene scene;
  std::unique_ptr<BodyStepper> stepper = make_cpu_stepper(scene.model, {.linear_tolerance = 1e-10});
  StepSystem system;
  StepRows step_rows{scene.surfaces, scene.model, 1};
  ContactIslands islands{scene.surfaces, scene.model};
  RestFactors factors{scene.model};
  ContactProblem laws;
  ContactShare share;
  SystemIslands places;
  std::vector<CondensedIsland> coupling;
  BlockJacobian jacobian;
};

Eigen::VectorXd numbers(std::int64_t count, double first) {
  return Eigen::VectorXd::NullaryExpr(
      count, [=](Eigen::Index i) { return first + std::sin(3.7 * static_cast<double>(i)); });
}

TEST(BlockJacobian, ProductsAreThoseOfTheMatrix) {
  const TiedSystem s;
  const Eigen::MatrixXd j = s.dense_jacobian();
  const Eigen::VectorXd v = numbers(j.cols(), 0.3), r = numbers(j.rows(), -0.1);
  const Eigen::VectorXd w = numbers(j.rows(), 1);
  Eigen::VectorXd u(j.rows()), force = numbers(j.cols(), 2);
  const Eigen::VectorXd pushed = force + j.transpose() * r;
  s.jacobian.velocities({v.data(), v.size()}, {w.data(), w.data() + w.size()}, 1,
                        {u.data(), u.size()});
  s.jacobian.add_pushes(r.data(), force.data());
  EXPECT_LE((u - w - j * v).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LE((force - pushed).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(SystemIslands, RowsAreListedOnceForASystem) {
  TiedSystem s;
  EXPECT_FALSE(s.places.set(s.system.rows, s.islands));
  for (std::int32_t row = 0; row < s.system.rows.unknown_count; ++row) {
    const std::int32_t block = s.system.rows.block_of[row], island = s.places.of_row(row);
    EXPECT_EQ(island, s.islands.of_block(block));
    EXPECT_EQ(s.places.row_of_block()[at(block)], row);
    EXPECT_GE(row, s.places.of(island).begin);
    EXPECT_LT(row, s.places.of(island).end);
  }
  Model other = stack_scene(1e5).model;
  const auto stepper = make_cpu_stepper(other, {});
  stepper->solve(input_for(other, stack_step));
  const HandScene scene = stack_scene(1e5);
  EXPECT_TRUE(s.places.set(stepper->system().rows, {scene.surfaces, scene.model}));
}

/// Columns are A^-1 J^T and W = J A^-1 J^T, exactly symmetric.
TEST(CondensedMatrix, IsThatOfTheContacts) {
  TiedSystem s;
  const Eigen::MatrixXd a = s.dense_system(), j = s.dense_jacobian();
  const Eigen::MatrixXd exact = j * a.llt().solve(Eigen::MatrixXd(j.transpose()));
  CondensedMatrix matrix;
  matrix.clear(s.share.contacts.size());
  EXPECT_FALSE(matrix.is_valid());  // of no island
  for (CondensedIsland& island : s.coupling) {
    ASSERT_TRUE(island.factor(s.system, nullptr));
    island.find_columns(s.jacobian, s.share.contacts);
    matrix.add(s.jacobian, island);
  }
  EXPECT_TRUE(matrix.is_valid());
  SparseMatrix w;
  matrix.copy(w);
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(w.rows, w.columns);
  for (std::int64_t row = 0; row < w.rows; ++row) {
    for (std::int64_t e = w.row_start[at(row)]; e < w.row_start[at(row + 1)]; ++e) {
      found(row, w.column[at(e)]) = w.value[at(e)];
    }
  }
  EXPECT_LE((found - exact).norm(), 1e-10 * exact.norm());
  EXPECT_TRUE(found == found.transpose());

  const std::vector<double> normal(s.share.contacts.size(), 2);
  std::vector<double> velocity(at(w.rows), 0);
  matrix.subtract(normal, velocity);
  for (std::int64_t row = 0; row < w.rows; ++row) {
    double sum = 0;
    for (std::int64_t c = 0; c < w.columns; c += 3) sum -= 2 * found(row, c);
    EXPECT_NEAR(velocity[at(row)], sum, 1e-12 * std::abs(sum));
  }
}

/// Columns stay where J and A do; others are new, and what no contact needs is given back.
TEST(CondensedIsland, KeepsTheColumnsOfTheSameContacts) {
  TiedSystem s, stiffer(1e7);
  CondensedIsland& island = s.coupling[0];
  ASSERT_TRUE(island.factor(s.system, nullptr));
  island.find_columns(s.jacobian, {0, 1, 2, 3});
  const std::vector<CondensedIsland::Contact> before = island.contacts();
  const std::vector<double> of_second = *before[1].columns;
  ASSERT_TRUE(island.factor(s.system, nullptr));
  island.find_columns(s.jacobian, {1, 3, 5});
  ASSERT_EQ(island.contacts().size(), 3u);
  EXPECT_EQ(island.contacts()[0].columns, before[1].columns);  // the same memory
  EXPECT_EQ(island.contacts()[1].columns, before[3].columns);
  EXPECT_EQ(*island.contacts()[0].columns, of_second);
  ASSERT_TRUE(island.factor(stiffer.system, nullptr));
  island.find_columns(s.jacobian, {1});
  EXPECT_NE(*island.contacts()[0].columns, of_second);
  island.forget_columns();
  EXPECT_TRUE(island.contacts().empty());
}

TEST(CondensedIsland, UsesTheFactorsOfTheLinearSolve) {
  TiedSystem s;
  CondensedIsland& island = s.coupling[0];
  RowRangeLu made;
  made.set(s.system.rows, island.range().begin, island.range().end);
  ASSERT_TRUE(made.factor(s.system.rows, s.system.values));
  std::vector<double> x(3 * at(s.system.rows.unknown_count), 1.0), y = x;
  ASSERT_TRUE(island.factor(s.system, &made));
  island.solve(x);
  const Eigen::VectorXd exact =
      s.dense_system().llt().solve(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(y.size())));
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(x[i], exact(static_cast<Eigen::Index>(i)), 1e-9 * exact.cwiseAbs().maxCoeff());
  }
}

/// Multiplications of the factors, of three solves per contact and of half of W, one by one.
TEST(CondensedChoice, CountsFactorsSolvesAndMatrix) {
  TiedSystem s;
  const auto contacts = std::ssize(s.share.contacts);
  const RowRangeLu& lu = s.coupling[0].pattern(s.system.rows);
  std::int64_t products = 0;
  for (std::size_t row = 0; row < s.share.contacts.size(); ++row) {
    s.jacobian.for_blocks(row, [&](std::size_t) { products += 27 * (contacts + 1); });
  }
  const std::int64_t all = lu.operations() + 3 * contacts * lu.solve_operations() + products / 2;
  CondensedChoice choice(s.islands, s.factors);
  const auto takes = [&](const CondensedChoice::Limits& limits) {
    choice.find(limits, s.system.rows, s.places, s.coupling, s.rows(), s.laws, s.share);
    return choice.takes(0);
  };
  EXPECT_TRUE(takes({contacts, all}));
  EXPECT_FALSE(takes({contacts, all - 1}));
  EXPECT_FALSE(takes({contacts - 1, all}));
  s.laws.friction.assign(s.laws.friction.size(), 0);
  EXPECT_TRUE(takes({contacts, all}));  // elastic bodies
}

}  // namespace
}  // namespace tetwarp::test
