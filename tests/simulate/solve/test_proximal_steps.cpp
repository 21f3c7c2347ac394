/// The majorant of contacts on compliant bodies against the dense matrix J M^-1 J^T, and the steps
/// that use it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/proximal_step.hpp"
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
  CpuExec exec(1);
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

/// The least eigenvalue of majorant - J M^-1 J^T.
/// @param dense  J M^-1 J^T
double least_excess(const Eigen::MatrixXd& dense,
                    const std::vector<ContactConstants<double>>& majorant) {
  Eigen::MatrixXd difference = -dense;
  for (std::size_t c = 0; c < majorant.size(); ++c) {
    for (int a = 0; a < 3; ++a) {
      const auto place = 3 * static_cast<Eigen::Index>(c) + a;
      difference(place, place) += majorant[c].block[4 * a];
    }
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(difference).eigenvalues().minCoeff();
}

/// Steps with the majorant then never raise the energy of impulses on frictionless contacts.
TEST(Majorant, IsLargerThanTheMatrix) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    const RandomContacts contacts(seed, 1 + static_cast<std::int32_t>(seed) % 5,
                                  1 + 7 * (static_cast<std::int32_t>(seed) % 9));
    const Majorants found = majorants_of(contacts);
    for (const ContactConstants<double>& own : found.majorant) {
      EXPECT_EQ(own.block[1], 0);
      EXPECT_EQ(own.tangent_metric, std::max(own.block[4], own.block[8]));
    }
    const Eigen::MatrixXd dense = contacts.dense();
    EXPECT_GE(least_excess(dense, found.majorant), -1e-5 * dense.cwiseAbs().maxCoeff());
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

/// Steps from zero impulses.
class Steps {
 public:
  Steps(const RandomContacts& contacts, const Majorants& of, const std::vector<double>& offset)
      : of_(of), touching_(contacts.touching()), offset_(offset), none_(offset.size(), 0.0) {
    touching_.rows.offset = view(offset_);
    terms_.resize(of_.constants.size());
    past_.resize(2 * offset.size());
    begin();
  }

  void begin() {
    state_ = {};
    impulse_ = ahead_ = none_;
    push_.assign(static_cast<std::size_t>(3 * touching_.bodies.row_of_node.size), 0.0);
    velocity_ = push_;
  }
  /// @returns the sums of the last one of eight steps
  const ProximalState::Sums& run() {
    CpuExec exec(1);
    for (int step = 0; step < ProximalState::steps_at_once; ++step) {
      exec.for_each_by_lanes("", static_cast<std::int64_t>(of_.constants.size()),
                             ProximalStepOp{touching_,
                                            view(std::as_const(of_.constants)),
                                            view(std::as_const(of_.majorant)),
                                            {},
                                            view(std::as_const(velocity_)),
                                            &state_,
                                            step,
                                            view(ahead_),
                                            view(impulse_),
                                            view(past_),
                                            view(terms_)});
      const std::int64_t nodes = touching_.bodies.row_of_node.size;
      exec.for_each_by_lanes("", nodes,
                             NodePushOp{touching_, view(std::as_const(ahead_)),
                                        view(std::as_const(none_)), view(push_)});
      exec.for_each_by_lanes(
          "", nodes, NodeMoveOp{touching_.bodies, view(std::as_const(push_)), {}, view(velocity_)});
    }
    state_.sums = {};
    for (const ProximalState::Sums& term : terms_) state_.sums += term;
    ProximalDecideOp{&state_}(0);
    return state_.sums;
  }
  void grow() {
    CpuExec exec(1);
    exec.for_each("", static_cast<std::int64_t>(of_.majorant.size()),
                  MajorantGrowOp{view(of_.majorant)});
    begin();
  }

  const std::vector<ContactConstants<double>>& majorant() const { return of_.majorant; }
  /// Runs with a majorant that is large enough. Products of impulses that hardly change are
  /// roundings.
  void expect_solve(int runs, const Solvable& known) {
    const double first = run().value[0];
    for (int n = 1; n < runs; ++n) {
      const bool is_small = run().value[0] <= 1e-10 * first;
      EXPECT_TRUE(is_small || !ProximalState::has_missed(state_.sums)) << n;
    }
    EXPECT_LE(state_.sums.value[0], 1e-12 * (first + 1));
    expect_solved(known);
  }

 private:
  void expect_solved(const Solvable& known) const {
    std::vector<double> u(offset_);
    for (std::size_t c = 0; c < terms_.size(); ++c) {
      const auto contact = static_cast<std::int64_t>(c);
      touching_.add_velocity(touching_.rows.block_start[contact],
                             touching_.rows.block_start[contact + 1], velocity_.data(),
                             u.data() + 3 * c);
      EXPECT_GE(impulse_[3 * c], 0);
      EXPECT_NEAR(u[3 * c], known.normal_velocity[c], 1e-4);
    }
  }

  Majorants of_;
  TouchingNodes touching_;
  std::vector<double> offset_, none_, impulse_, ahead_, push_, velocity_, past_;
  std::vector<ProximalState::Sums> terms_;
  ProximalState state_;
};

TEST(ProximalSteps, SolveContactsOfAKnownSolution) {
  for (const std::int32_t count : {0, 1, 31, 32, 33}) {
    SCOPED_TRACE(count);
    const auto seed = static_cast<unsigned>(count);
    const RandomContacts contacts(seed, 6, count);
    const Solvable known = solvable(contacts.dense(), seed);
    Steps(contacts, majorants_of(contacts), known.offset).expect_solve(400, known);
  }
}

/// Impulses on the rods go to and fro, as none of them may be negative, and do not diverge.
TEST(ProximalSteps, DoubleAMajorantThatIsTooSmall) {
  const RandomContacts contacts = RandomContacts::of_rods();
  const Majorants found = majorants_of(contacts);
  EXPECT_NEAR(found.scale[0], 1.2 * 6, 0.1);
  EXPECT_NEAR(found.scale[1], 1.2 * 12, 0.1);
  const Eigen::MatrixXd dense = contacts.dense();
  EXPECT_LT(least_excess(dense, found.majorant), -4);
  const Solvable known = solvable(dense, 1);
  Steps steps(contacts, found, known.offset);
  int runs = 0;
  while (runs < 5 && !ProximalState::has_missed(steps.run())) ++runs;
  EXPECT_LT(runs, 5);

  steps.grow();

  EXPECT_GT(least_excess(dense, steps.majorant()), 0);
  steps.expect_solve(100, known);
}

}  // namespace
}  // namespace tetwarp::test
