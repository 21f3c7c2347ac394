/// @file test_contact_associated.cpp
/// Associated friction: the interior point method finds impulses in their cones and velocities in
/// the dual cones, orthogonal to each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/contact/newton/associated.hpp"
#include "host/contact/problem/matrix.hpp"
#include "host/contact/solve/condense.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {
namespace {
using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

std::vector<MeasuredContact> contacts_of(const ContactProblem& problem, const Delassus& delassus) {
  std::vector<MeasuredContact> contacts = measured_contacts(problem);
  const auto blocks = delassus.diagonal_blocks();
  for (std::size_t c = 0; c < contacts.size(); ++c) contacts[c].diagonal_block = blocks[c];
  return contacts;
}

/// A problem, and the arrays that its solver holds references to.
struct Setting {
  explicit Setting(const ContactProblem& problem, FrictionLaw chosen)
      : law(chosen),
        delassus(problem, 1e6),
        contacts(contacts_of(problem, delassus)),
        system(problem, delassus),
        solver(contacts, law, delassus, system) {}

  VectorXd velocity(const VectorXd& impulse) const {
    return delassus.free_velocity() + delassus.velocity_change(impulse);
  }

  /// The largest violation of nu in K', y in its dual cone and nu . y = 0, relative to free motion.
  double violation(const VectorXd& impulse, const VectorXd& lift) const {
    const VectorXd u = velocity(impulse);
    double unit = 0, largest = 0, gap = 0;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const Index row = 3 * static_cast<Index>(c);
      const double root = std::sqrt(contacts[c].diagonal_block.trace() / 3);
      const Vector3d spring =
          contacts[c].stiffness.cwiseProduct(u.segment<3>(row) + contacts[c].offset);
      const Vector3d nu = root * (impulse.segment<3>(row) + spring);
      Vector3d y = u.segment<3>(row) / root;
      y(0) += lift(static_cast<Index>(c)) / root;
      const bool is_cone = law == FrictionLaw::cone;
      const double mu = contacts[c].friction;
      const double pull = is_cone ? nu.tail<2>().norm() : nu.tail<2>().lpNorm<Eigen::Infinity>();
      const double slip = is_cone ? y.tail<2>().norm() : y.tail<2>().lpNorm<1>();
      largest = std::max({largest, -nu(0), pull - mu * nu(0), mu * slip - y(0)});
      gap = std::max(gap, std::abs(nu.dot(y)));
      unit = std::max(unit, delassus.free_velocity().segment<3>(row).norm() / root);
    }
    return std::max(largest / unit, gap / (unit * unit));
  }

  FrictionLaw law;
  Delassus delassus;
  std::vector<MeasuredContact> contacts;
  NewtonSystem system;
  AssociatedContact solver;
};

class Associated : public testing::TestWithParam<FrictionLaw> {
 protected:
  void expect_solved(const ContactProblem& problem, double speed) {
    Setting setting(problem, GetParam());
    VectorXd lift(problem.contact_count());
    for (Index c = 0; c < lift.size(); ++c) lift(c) = speed * static_cast<double>(c % 3);

    const VectorXd impulse = setting.solver.solve(lift);

    EXPECT_GT(setting.violation(VectorXd::Zero(impulse.size()), lift), 0.1);
    EXPECT_LE(setting.violation(impulse, lift), 1e-3);
    EXPECT_LE(setting.solver.iterations(), 60);
  }
};

INSTANTIATE_TEST_SUITE_P(Laws,
                         Associated,
                         testing::Values(FrictionLaw::cone, FrictionLaw::pyramid));

TEST_P(Associated, ObeysItsLawsInLocalAndGlobalForm) {
  expect_solved(scenes::random_local({.friction = 0.7}), 0.1);
  expect_solved(scenes::sphere_packing({.edge = 3, .friction = 0.8, .gaps = 0}), 0.01);
}

TEST_P(Associated, ObeysItsLawsWithoutFriction) {
  expect_solved(scenes::random_local({.friction = 0}), 0);
  expect_solved(scenes::box_stack({.boxes = 3, .friction = 0}), 0);
}

TEST_P(Associated, ObeysItsLawsOnGlue) {
  expect_solved(scenes::sphere_packing({.edge = 3, .friction = 0.5, .glue = {.stiffness = 1e7}}),
                0.01);
}

TEST_P(Associated, ObeysItsLawsWhereImpulsesAreNotUnique) {
  expect_solved(scenes::jam({.seed = 1, .mass_ratio = 1e4}), 0);
}

/// The impulses of a jam are not unique, its velocities are: other equations find the same.
TEST_P(Associated, FindsOneVelocityWhateverTheImpulses) {
  const ContactProblem problem = scenes::jam({.seed = 2, .mass_ratio = 100});
  ContactProblem condensed = CondensedProblem(problem).local();
  condensed.delassus = make_rows(condensed.delassus);
  Setting global(problem, GetParam()), local(condensed, GetParam());
  const VectorXd lift = VectorXd::Constant(problem.contact_count(), 0.01);

  const VectorXd velocity = global.velocity(global.solver.solve(lift));

  EXPECT_LE((local.velocity(local.solver.solve(lift)) - velocity).norm(),
            1e-4 * global.delassus.free_velocity().norm());
}

TEST_P(Associated, LiftsByFrictionTimesSlip) {
  const ContactProblem problem = scenes::random_local({.contacts = 1, .friction = 0.5});
  const Setting setting(problem, GetParam());

  const VectorXd lift = setting.solver.lift_of(Vector3d(7, 3, -4));

  EXPECT_DOUBLE_EQ(lift(0), GetParam() == FrictionLaw::cone ? 2.5 : 3.5);
}
}  // namespace
}  // namespace tetwarp::test
