/// The majorant of contacts on compliant bodies against the dense matrix J M^-1 J^T, and the steps
/// that use it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "host/exec/contact_exec_cpu.hpp"
#include "kernels/two_level/proximal_step.hpp"

namespace tetwarp::test {
namespace {

template <class T>
View<const T> view(const std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}
template <class T>
View<T> view(std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

/// Elastic bodies of several nodes, each turned, with random inverses and contacts.
class RandomContacts {
 public:
  RandomContacts(unsigned seed, std::int32_t body_count, std::int32_t contact_count)
      : random_(seed) {
    for (std::int32_t b = 0; b < body_count; ++b) add_body(2 + b);
    set_views();
    for (std::int32_t c = 0; c < contact_count; ++c) add_contact();
    finish();
  }

  TouchingNodes touching() const {
    TouchingNodes all;
    all.bodies = bodies_of_;
    all.rows.block_start = view(block_start_);
    all.rows.row = all.rows.node = view(row_);
    all.rows.contact = view(contact_);
    all.rows.part = view(part_);
    all.rows.touch_start = view(touch_start_);
    all.rows.touch = view(touch_);
    all.turned = view(turned_);
    all.part_start = view(part_start_);
    all.part_block = view(part_block_);
    all.part_body = view(part_body_);
    return all;
  }
  std::int64_t contact_count() const { return static_cast<std::int64_t>(block_start_.size()) - 1; }
  std::int64_t part_count() const { return static_cast<std::int64_t>(part_body_.size()); }

  /// J M^-1 J^T from the inverses.
  Eigen::MatrixXd dense() const {
    const auto nodes = static_cast<Eigen::Index>(3 * body_of_row_.size());
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(nodes, nodes);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Eigen::Index first = 3 * bodies_[b].first, size = 3 * bodies_[b].count;
      inverse.block(first, first, size, size) =
          Eigen::Map<const Eigen::MatrixXf>(inverses_[b].data(), size, size).cast<double>();
    }
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3 * contact_count(), nodes);
    for (std::size_t b = 0; b < row_.size(); ++b) {
      jacobian.block<3, 3>(3 * contact_[b], 3 * row_[b]) +=
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turned_.data() + 9 * b);
    }
    return jacobian * inverse * jacobian.transpose();
  }

 private:
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  std::int32_t below(std::int32_t count) {
    return std::uniform_int_distribution<std::int32_t>(0, count - 1)(random_);
  }

  void add_body(std::int32_t rows) {
    CompliantBody own;
    own.first = own.first_node = static_cast<std::int32_t>(body_of_row_.size());
    own.count = own.node_count = rows;
    Eigen::MatrixXd factor(3 * rows, 3 * rows);
    for (Eigen::Index i = 0; i < factor.size(); ++i) factor.data()[i] = number();
    // Nodes mostly move together, as those of a body that contacts push.
    const Eigen::MatrixXd all =
        factor * factor.transpose() + Eigen::MatrixXd::Constant(3 * rows, 3 * rows, 5.0 * rows);
    const Eigen::MatrixXf rounded = all.cast<float>();
    inverses_.emplace_back(rounded.data(), rounded.data() + rounded.size());
    for (std::int32_t r = 0; r < rows; ++r) {
      row_of_node_.push_back(static_cast<std::int32_t>(body_of_row_.size()));
      body_of_row_.push_back(static_cast<std::int32_t>(bodies_.size()));
    }
    bodies_.push_back(own);
  }

  /// Between two bodies, or one and what does not move.
  void add_contact() {
    std::int32_t a = below(static_cast<std::int32_t>(bodies_.size()));
    std::int32_t b = below(static_cast<std::int32_t>(bodies_.size()) + 1) - 1;
    if (b >= 0 && b < a) std::swap(a, b);
    add_part(a);
    if (b > a) add_part(b);
    block_start_.push_back(static_cast<std::int32_t>(row_.size()));
    part_start_.push_back(static_cast<std::int32_t>(part_body_.size()));
  }

  void add_part(std::int32_t body) {
    CompliantBody& own = bodies_[static_cast<std::size_t>(body)];
    const std::int32_t count = 1 + below(std::min(3, own.count));
    for (std::int32_t k = 0; k < count; ++k) {
      row_.push_back(own.first + k);
      contact_.push_back(static_cast<std::int32_t>(block_start_.size()) - 1);
      part_.push_back(static_cast<std::int32_t>(part_body_.size()));
      for (int e = 0; e < 9; ++e) turned_.push_back(number());
    }
    part_body_.push_back(body);
    part_block_.push_back(static_cast<std::int32_t>(row_.size()));
    ++own.contact_count;
  }

  void set_views() {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      bodies_[b].inverse = inverses_[b].data();
      bodies_[b].compliance = static_cast<std::int64_t>(compliance_.size());
      compliance_.resize(compliance_.size() + inverses_[b].size());
    }
  }

  void finish() {
    for (std::int32_t row = 0; row < static_cast<std::int32_t>(body_of_row_.size()); ++row) {
      touch_start_.push_back(static_cast<std::int32_t>(touch_.size()));
      for (std::size_t b = 0; b < row_.size(); ++b) {
        if (row_[b] == row) touch_.push_back(static_cast<std::int32_t>(b));
      }
    }
    touch_start_.push_back(static_cast<std::int32_t>(touch_.size()));
    bodies_of_.bodies = view(bodies_);
    bodies_of_.body_of_row = view(body_of_row_);
    bodies_of_.row_of_node = view(row_of_node_);
    const ComplianceBlockBody fill{bodies_of_, view(compliance_)};
    for (std::size_t node = 0; node < row_of_node_.size(); ++node) {
      const CompliantBody& own = bodies_[static_cast<std::size_t>(body_of_row_[node])];
      for (std::int32_t k = 0; k < own.node_count; ++k) fill(static_cast<std::int64_t>(node), k, 0);
    }
    bodies_of_.compliance = view(std::as_const(compliance_));
  }

  std::mt19937 random_;
  std::vector<CompliantBody> bodies_;
  std::vector<std::vector<float>> inverses_;
  std::vector<float> compliance_;
  std::vector<std::int32_t> body_of_row_, row_of_node_, row_, contact_, part_, part_body_;
  std::vector<std::int32_t> block_start_{0}, part_start_{0}, part_block_{0}, touch_start_, touch_;
  std::vector<double> turned_;
  CompliantBodies bodies_of_;
};

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
