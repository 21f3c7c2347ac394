/// The majorant of contacts on compliant bodies against the dense matrix J M^-1 J^T, and the steps
/// that use it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "host/exec/contact_exec_cpu.hpp"
#include "kernels/two_level/proximal_step.hpp"
#include "tests/simulate/random_contacts.hpp"

namespace tetwarp::test {
namespace {

struct Majorants {
  std::vector<ContactConstants<double>> constants, majorant;
  std::vector<double> scale;
};

Majorants majorants_of(const RandomContacts& contacts) {
  const TouchingNodes touching = contacts.touching();
  Majorants result;
  result.constants.resize(static_cast<std::size_t>(contacts.contact_count()));
  result.majorant = result.constants;
  result.scale.resize(static_cast<std::size_t>(touching.bodies.bodies.size));
  std::vector<double> diagonal(static_cast<std::size_t>(3 * contacts.part_count()));
  std::vector<double> vector = diagonal;
  std::vector<double> push(static_cast<std::size_t>(3 * touching.bodies.row_of_node.size));
  std::vector<double> before = push, after = push;
  CpuContactExec exec(1);
  set_majorants(exec, touching,
                {view(result.constants), view(result.majorant), view(result.scale), view(diagonal),
                 view(vector), view(push), view(before), view(after)});
  return result;
}

TEST(Majorant, OwnBlocksAreThoseOfTheMatrix) {
  const RandomContacts contacts(3, 4, 30);
  const Majorants found = majorants_of(contacts);
  const Eigen::MatrixXd dense = contacts.dense();
  for (std::size_t c = 0; c < found.constants.size(); ++c) {
    for (Eigen::Index a = 0; a < 3; ++a) {
      for (Eigen::Index b = 0; b < 3; ++b) {
        const auto first = 3 * static_cast<Eigen::Index>(c);
        EXPECT_NEAR(found.constants[c].block[3 * a + b], dense(first + a, first + b),
                    1e-5 * dense.diagonal().maxCoeff());
      }
    }
  }
}

/// Steps with the majorant then never raise the energy of impulses on frictionless contacts.
TEST(Majorant, IsLargerThanTheMatrix) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    const RandomContacts contacts(seed, 1 + static_cast<std::int32_t>(seed) % 5,
                                  1 + 7 * (static_cast<std::int32_t>(seed) % 9));
    const Majorants found = majorants_of(contacts);
    Eigen::MatrixXd difference = -contacts.dense();
    const double size = difference.cwiseAbs().maxCoeff();
    for (std::size_t c = 0; c < found.majorant.size(); ++c) {
      const ContactConstants<double>& own = found.majorant[c];
      for (int a = 0; a < 3; ++a) {
        const auto place = 3 * static_cast<Eigen::Index>(c) + a;
        difference(place, place) += own.block[4 * a];
      }
      EXPECT_EQ(own.block[1], 0);
      EXPECT_EQ(own.tangent_metric, std::max(own.block[4], own.block[8]));
    }
    const double least =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(difference).eigenvalues().minCoeff();
    EXPECT_GE(least, -1e-5 * size);
  }
}

/// A body with one contact takes its own diagonal, whatever the others have.
TEST(Majorant, ScalesAreOfBodies) {
  const RandomContacts contacts(7, 3, 60);
  const Majorants found = majorants_of(contacts);
  const TouchingNodes touching = contacts.touching();
  for (std::size_t b = 0; b < found.scale.size(); ++b) {
    EXPECT_GE(found.scale[b], 1);
    const std::int32_t count = touching.bodies.bodies[static_cast<std::int64_t>(b)].contact_count;
    EXPECT_LE(found.scale[b], 3 * count);
  }
}

/// Frictionless contacts with the offsets of a known solution r, u: r >= 0, u >= 0, r u = 0.
struct Solvable {
  std::vector<double> offset, normal_velocity;
};

Solvable solvable(const Eigen::MatrixXd& dense, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> size(0.1, 1);
  Eigen::VectorXd impulse = Eigen::VectorXd::Zero(dense.rows()), velocity = impulse;
  Solvable result;
  for (Eigen::Index c = 0; c < dense.rows(); c += 3) {
    (random() % 2 == 0 ? impulse : velocity)[c] = size(random);
    result.normal_velocity.push_back(velocity[c]);
  }
  const Eigen::VectorXd offset = velocity - dense * impulse;
  result.offset.assign(offset.data(), offset.data() + offset.size());
  return result;
}

TEST(ProximalSteps, SolveContactsOfAKnownSolution) {
  for (const std::int32_t count : {0, 1, 31, 32, 33}) {
    SCOPED_TRACE(count);
    const auto seed = static_cast<unsigned>(count);
    const RandomContacts contacts(seed, 6, count);
    Majorants of = majorants_of(contacts);
    const Solvable known = solvable(contacts.dense(), seed);
    TouchingNodes touching = contacts.touching();
    touching.rows.offset = view(known.offset);
    const auto nodes = static_cast<std::size_t>(3 * touching.bodies.row_of_node.size);
    std::vector<double> impulse(known.offset.size(), 0), ahead = impulse;
    const std::vector<double> none = impulse;
    std::vector<double> push(nodes, 0), velocity = push;
    std::vector<PlainSums<2>> terms(of.constants.size());
    ProximalState state;
    double first = 0;
    for (int run = 0; run < 400; ++run) {
      for (int step = 0; step < ProximalState::steps_at_once; ++step) {
        CpuContactExec exec(1);
        exec.for_each("", count,
                      ProximalStepBody{touching,
                                       view(std::as_const(of.constants)),
                                       view(std::as_const(of.majorant)),
                                       {},
                                       view(std::as_const(velocity)),
                                       &state,
                                       step,
                                       view(ahead),
                                       view(impulse),
                                       view(terms)});
        exec.for_each("", touching.bodies.row_of_node.size,
                      NodePushBody{touching, view(std::as_const(ahead)), view(none), view(push)});
        exec.for_each("", static_cast<std::int64_t>(nodes),
                      NodeMoveBody{touching.bodies, view(std::as_const(push)), {}, view(velocity)});
      }
      state.sums = {};
      for (const PlainSums<2>& term : terms) state.sums += term;
      if (run == 0) first = state.sums.value[0];
      ProximalDecideBody{&state}(0);
    }
    EXPECT_LE(state.sums.value[0], 1e-12 * (first + 1));
    std::vector<double> u(known.offset);
    for (std::int64_t c = 0; c < count; ++c) {
      double* const own = u.data() + 3 * c;
      touching.add_velocity(touching.rows.block_start[c], touching.rows.block_start[c + 1],
                            velocity.data(), own);
      EXPECT_GE(impulse[static_cast<std::size_t>(3 * c)], 0);
      EXPECT_NEAR(own[0], known.normal_velocity[static_cast<std::size_t>(c)], 1e-4);
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
