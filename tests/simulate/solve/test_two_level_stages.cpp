/// The stages of kernels/contact against sparse matrices, at the sizes around those of warps and
/// blocks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/proximal_step.hpp"
#include "tests/simulate/random_step.hpp"

namespace tetwarp::test {
namespace {

using Vector = Eigen::VectorXd;

View<const double> read(const Vector& values) {
  return {values.data(), values.size()};
}
View<double> write(Vector& values) {
  return {values.data(), values.size()};
}

template <class Op>
void each(std::int64_t count, const Op& op) {
  CpuExec(1).for_each("", count, op);
}
template <class Op>
void each_by_lanes(std::int64_t count, const Op& op) {
  CpuExec(1).for_each_by_lanes("", count, op);
}
void expect_near(const Vector& found, const Vector& expected, double tolerance = 1e-13) {
  ASSERT_EQ(found.size(), expected.size());
  if (found.size() == 0) return;
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(),
            tolerance * (1 + expected.cwiseAbs().maxCoeff()));
}
/// What a stage is to overwrite.
Vector unset(std::int64_t count) {
  return Vector::Constant(3 * count, -7);
}

/// A step with its diagonal blocks inverted and its compliance.
struct Stages {
  explicit Stages(std::int32_t count) : size(count), step(count) {
    each(step.diagonal_rows().size,
         DiagonalInvertOp{step.diagonal_rows(), {step.system(), step.values(), of.diagonal}});
    const ComplianceBlockOp fill{of, view(compliance)};
    for (std::int64_t node = 0; node < nodes; ++node) {
      for (std::int32_t other = 0; other < of.of_node(node).node_count; ++other) {
        fill(node, other, 0);
      }
    }
  }

  std::int32_t size;  ///< rows, contacts
  RandomStep step;
  std::vector<float> compliance;
  std::vector<double> inverse;
  CompliantBodies of = step.compliant(compliance, inverse);
  Vector offset = step.vector(3 * std::int64_t{size});
  TouchingRows touching = step.touching(offset);
  TouchingNodes contacts = step.touching_nodes(of, touching);
  std::int64_t nodes = of.row_of_node.size;
};

template <class Check>
void stages_at_all_sizes(const Check& check) {
  for (const std::int32_t size : {0, 1, 31, 32, 33, 1025}) {
    SCOPED_TRACE(size);
    Stages stages(size);
    check(stages);
  }
}

TEST(TwoLevelStages, StartIsThatOfTheRowsInTheSystem) {
  stages_at_all_sizes([](Stages& s) {
    const Vector free = s.step.vector(3 * (s.step.system_count() + 1));
    Vector velocity = unset(s.size), weight = velocity, expected = velocity;
    each(s.size, RowStartOp{s.step.system_row(), s.step.system(), s.step.values(), read(free),
                            write(velocity), write(weight)});
    for (std::int32_t row = 0; row < s.size; ++row) {
      expected.segment<3>(3 * row) = free.segment<3>(3 * s.step.system_row()[row]);
    }
    EXPECT_EQ(velocity, expected);
    EXPECT_EQ(weight, Vector(s.step.a.diagonal()));

    const Vector more = s.step.vector(3 * s.size);
    each(3 * s.size, AddNumbersOp{read(more), write(velocity)});
    EXPECT_EQ(velocity, expected + more);
  });
}

TEST(TwoLevelStages, BodiesMoveByTheirInverses) {
  stages_at_all_sizes([](Stages& s) {
    const Vector push = s.step.vector(3 * s.size), from = s.step.vector(3 * s.size);
    Vector moved = unset(s.size), to = moved;
    each_by_lanes(s.size, ComplianceOp{s.of, read(push), write(moved)});
    each(s.size, RowMoveOp{s.of, read(moved), read(from), write(to)});
    expect_near(moved, s.step.inverses * push, 1e-12);
    expect_near(to, from + s.step.rotations * moved);
    Vector in_place = from;
    each(s.size, RowMoveOp{s.of, read(moved), read(in_place), write(in_place)});
    EXPECT_EQ(in_place, to);
  });
}

TEST(TwoLevelStages, NodesMoveByTheInversesOfTheirRows) {
  stages_at_all_sizes([](Stages& s) {
    const Vector push = s.step.vector(3 * s.nodes), from = s.step.vector(3 * s.nodes);
    const Vector expected =
        s.step.picks * Vector(s.step.inverses * Vector(s.step.picks.transpose() * push));
    Vector velocity = unset(s.nodes);
    each_by_lanes(s.nodes, NodeMoveOp{s.of, read(push), {}, write(velocity)});
    expect_near(velocity, expected, 1e-6);
    each_by_lanes(s.nodes, NodeMoveOp{s.of, read(push), read(from), write(velocity)});
    expect_near(velocity, from + expected, 1e-6);

    const Vector of_rows = s.step.vector(3 * s.size);
    each(s.nodes, NodeVelocityOp{s.of, read(of_rows), write(velocity)});
    expect_near(velocity, s.step.picks * Vector(s.step.rotations.transpose() * of_rows));
  });
}

TEST(TwoLevelStages, ContactsPushRowsAndMoveWithThem) {
  stages_at_all_sizes([](Stages& s) {
    const Vector velocity = s.step.vector(3 * s.size), after = s.step.vector(3 * s.size);
    const Vector before = s.step.vector(3 * s.size);
    Vector of_contacts = unset(s.size), push = of_contacts, defect = of_contacts;
    each(s.size, TouchVelocityOp{s.touching, read(velocity), write(of_contacts)});
    each_by_lanes(s.size, RowPushOp{s.of, s.touching, read(after), read(before), write(push)});
    expect_near(of_contacts, s.step.jacobian * velocity + s.offset);
    const Vector pushed = s.step.jacobian.transpose() * (after - before);
    expect_near(push, s.step.rotations.transpose() * pushed);

    const Vector load = s.step.vector(3 * (s.step.system_count() + 1));
    Vector of_rows = unset(s.size);
    for (std::int32_t row = 0; row < s.size; ++row) {
      of_rows.segment<3>(3 * row) = load.segment<3>(3 * s.step.system_row()[row]);
    }
    each_by_lanes(s.size,
                  RowDefectOp{s.of, s.touching, s.step.system(), s.step.values(), read(load),
                              read(velocity), read(after), read(before), write(defect)});
    expect_near(defect,
                s.step.rotations.transpose() * Vector(of_rows + pushed - s.step.a * velocity));
  });
}

TEST(TwoLevelStages, ErrorsAreScalarProducts) {
  stages_at_all_sizes([](Stages& s) {
    const Vector a = s.step.vector(3 * s.size), b = s.step.vector(3 * s.size);
    const Vector free = s.step.vector(3 * s.size);
    std::vector<ContactConstants<double>> constants(index_of(s.size));
    double natural = 0;
    for (std::int32_t c = 0; c < s.size; ++c) {
      constants[index_of(c)].block[0] = 2;  // frictionless: min(r, u / 2)^2 2
      natural += 2 * std::pow(std::min(a[3 * c], b[3 * c] / 2), 2);
    }
    CpuExec exec(1);
    const auto square = exec.sum<PlainSums<1>>("", 0, 3 * s.size, DefectSquareOp{read(a), read(b)});
    const auto error = exec.sum<PlainSums<2>>(
        "", 0, s.size,
        TouchErrorOp{view(std::as_const(constants)), {}, read(a), read(b), read(free)});
    EXPECT_NEAR(square.value[0], a.dot(b), 1e-12 * (1 + s.size));
    EXPECT_NEAR(error.value[0], natural, 1e-12 * (1 + s.size));
    EXPECT_NEAR(error.value[1], a.dot(b - free), 1e-12 * (1 + s.size));
  });
}

TEST(TwoLevelStages, JacobiansAreTurnedIntoFrames) {
  stages_at_all_sizes([](Stages& s) {
    std::vector<double> turned(s.step.turned().size());
    each(s.step.block_count(), TurnJacobianOp{s.of, s.touching, view(turned)});
    for (std::size_t i = 0; i < turned.size(); ++i)
      EXPECT_NEAR(turned[i], s.step.turned()[i], 1e-14);
  });
}

TEST(TwoLevelStages, PartsPushNodesAndMoveWithThem) {
  stages_at_all_sizes([](Stages& s) {
    const Vector of_parts = s.step.vector(3 * s.step.part_count());
    const Vector after = s.step.vector(3 * s.size), before = s.step.vector(3 * s.size);
    const Vector velocity = s.step.vector(3 * s.nodes);
    Vector diagonal = s.step.vector(3 * s.step.part_count()).cwiseAbs();
    if (diagonal.size() > 0) diagonal[1] = 0;
    Vector push = unset(s.nodes), vector = unset(s.step.part_count());
    each_by_lanes(s.nodes, PartPushOp{s.contacts, read(of_parts), write(push)});
    expect_near(push, s.step.picks * Vector(s.step.parts.transpose() * of_parts));
    each_by_lanes(s.nodes, NodePushOp{s.contacts, read(after), read(before), write(push)});
    const Vector impulses = s.step.sum_parts.transpose() * (after - before);
    expect_near(push, s.step.picks * Vector(s.step.parts.transpose() * impulses));

    each(s.step.part_count(),
         PartVectorOp{s.contacts, read(velocity), read(diagonal), write(vector)});
    const Vector moved = s.step.parts * Vector(s.step.picks.transpose() * velocity);
    for (Eigen::Index i = 0; i < vector.size(); ++i) {
      EXPECT_NEAR(vector[i] * diagonal[i], diagonal[i] > 0 ? moved[i] : 0, 1e-13);
      EXPECT_TRUE(diagonal[i] > 0 || vector[i] == 0);
    }
  });
}

TEST(TwoLevelStages, MajorantsAreScaledDiagonals) {
  stages_at_all_sizes([](Stages& s) {
    std::vector<ContactConstants<double>> constants(index_of(s.size)), majorant = constants;
    Vector diagonal = unset(s.step.part_count()), vector = diagonal;
    each(s.size, OwnBlockOp{s.contacts, view(constants), write(diagonal), write(vector)});
    const RandomStep::Sparse moved = s.step.parts * s.step.inverses;
    for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
      const double expected = moved.row(i).dot(s.step.parts.row(i));
      EXPECT_NEAR(diagonal[i], expected, 1e-6 * expected);
      EXPECT_EQ(vector[i], expected > 0 ? scattered(i) / std::sqrt(diagonal[i]) : 0);
    }
    const Vector scale = s.step.vector(s.of.bodies.size).cwiseAbs();
    Vector scaled = diagonal;
    for (std::int64_t p = 0; p < s.step.part_count(); ++p) {
      scaled.segment<3>(3 * p) *= scale[s.contacts.part_body[p]];
    }
    const Vector expected = s.step.sum_parts * scaled;
    each(s.size, MajorantOp{s.contacts, view(std::as_const(constants)), read(diagonal), read(scale),
                            view(majorant)});
    each(s.size, MajorantGrowOp{view(majorant)});
    const RandomStep::Sparse jacobian = s.step.sum_parts * s.step.parts;
    const RandomStep::Sparse all_moved = jacobian * s.step.inverses;
    for (std::int32_t c = 0; c < s.size; ++c) {
      Eigen::Matrix3d own;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          own(a, b) = all_moved.row(3 * c + a).dot(jacobian.row(3 * c + b));
          const double found = majorant[index_of(c)].block[3 * a + b];
          EXPECT_NEAR(found, a == b ? 2 * expected[3 * c + a] : 0, 1e-13 * (1 + found));
        }
      }
      const ContactConstants<double>& found = constants[index_of(c)];
      for (int e = 0; e < 9; ++e) EXPECT_NEAR(found.block[e], own(e / 3, e % 3), 1e-6 * own.norm());
      const double metric = found.tangent_metric, first = own(1, 1) - metric;
      EXPECT_NEAR(first * (own(2, 2) - metric), own(1, 2) * own(1, 2), 1e-6 * own.squaredNorm());
      EXPECT_GE(2 * metric, 0.999999 * (own(1, 1) + own(2, 2)));
      EXPECT_NEAR(majorant[index_of(c)].tangent_metric,
                  2 * std::max(expected[3 * c + 1], expected[3 * c + 2]), 1e-12);
    }
  });
}

/// Bodies whose nodes move by a factor of their pushes, within the limits and beyond them.
TEST(TwoLevelStages, ScalesOfBodiesAreEigenvaluesWithinTheirLimits) {
  stages_at_all_sizes([](Stages& s) {
    const Vector push = s.step.vector(3 * s.nodes), before = 0.5 * push;
    Vector after = before, scale = Vector::Constant(s.of.bodies.size, -7), expected = scale;
    for (std::int64_t b = 0; b < s.of.bodies.size; ++b) {
      const CompliantBody& own = s.of.bodies[b];
      const double most = 3.0 * own.contact_count;
      const double factor = b % 4 == 0   ? 0.1
                            : b % 4 == 1 ? 1.5
                            : b % 4 == 2 ? most - 0.1
                                         : 2 * most;
      after.segment(3 * own.first_node, 3 * own.node_count) *= factor;
      expected[b] = own.node_count == 0
                        ? 0
                        : std::clamp(BodyScaleOp::margin * factor, 1.0, std::max(most, 1.0));
    }
    each_by_lanes(s.of.bodies.size,
                  BodyScaleOp{s.of, read(push), read(before), read(after), write(scale)});
    expect_near(scale, expected);
  });
}

}  // namespace
}  // namespace tetwarp::test
