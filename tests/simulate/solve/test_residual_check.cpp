/// The check of convergence of the two-level iteration: its stages, and the velocities that
/// impulses cause against a factorization of A.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/compliant_gradients.hpp"
#include "kernels/contact/residual_check.hpp"
#include "tests/simulate/random_step.hpp"

namespace tetwarp::test {
namespace {

using Vector = Eigen::VectorXd;

/// A random step with its diagonal blocks inverted.
struct CheckedStep {
  explicit CheckedStep(std::int32_t count) : size(count), step(count) {
    CpuExec(1).for_each(
        "", step.diagonal_rows().size,
        DiagonalInvertOp{step.diagonal_rows(), {step.system(), step.values(), of.diagonal}});
  }
  /// A in frames.
  Eigen::MatrixXd turned() const {
    return Eigen::MatrixXd(step.rotations).transpose() * Eigen::MatrixXd(step.a) *
           Eigen::MatrixXd(step.rotations);
  }
  CompliantGradients system() {
    for (Vector* v : {&x, &z, &p, &q}) *v = Vector::Zero(3 * size);
    return {of, step.system(), step.values(), write(x), write(r), write(z), write(p), write(q)};
  }
  static View<double> write(Vector& values) { return {values.data(), values.size()}; }

  std::int32_t size;  ///< rows, contacts
  RandomStep step;
  std::vector<float> compliance;
  std::vector<double> inverse;
  CompliantBodies of = step.compliant(compliance, inverse);
  Vector x, r = step.vector(3 * size), z, p, q;
};

TEST(ResidualCheck, ProductsAreThoseOfTheTurnedMatrix) {
  for (const std::int32_t size : {0, 1, 31, 32, 33, 1025}) {
    SCOPED_TRACE(size);
    CheckedStep s(size);
    const Vector direction = s.step.vector(3 * size);
    Vector product = Vector::Constant(3 * size, -7);
    CpuExec(1).for_each_by_lanes("", size,
                                 RowProductOp{s.of,
                                              s.step.system(),
                                              s.step.values(),
                                              {direction.data(), direction.size()},
                                              CheckedStep::write(product)});
    const Vector world = s.step.rotations * direction;
    const Vector expected = s.step.rotations.transpose() * Vector(s.step.a * world);
    for (Eigen::Index i = 0; i < product.size(); ++i) {
      EXPECT_NEAR(product[i], expected[i], 1e-12 * (1 + std::abs(expected[i])));
    }
  }
}

/// Iterations end within a fifth of the way to A^-1 r, by a factorization, in the norm of A; with
/// few at a time they give the same bits.
TEST(ResidualCheck, VelocitiesAreFoundToAFifthOfTheWay) {
  for (const std::int32_t size : {1, 31, 32, 33, 200}) {
    SCOPED_TRACE(size);
    CheckedStep s(size);
    const Vector defect = s.r;
    const Eigen::MatrixXd a = s.turned();
    const Vector exact = a.llt().solve(defect);
    CpuExec exec(1);
    std::vector<Vector> found;
    std::int64_t iterations = 0;
    for (const std::int64_t most : {CausedProgress::most_iterations, std::int64_t{3}}) {
      s.r = defect;
      const CompliantGradients system = s.system();
      CausedProgress progress;
      while (progress.end == CausedProgress::End::open) {
        const std::int64_t before = progress.iterations;
        find_caused(exec, system, 0, size, 0, most, progress);
        EXPECT_LE(progress.iterations, before + most);
      }
      EXPECT_EQ(progress.end, CausedProgress::End::found);
      EXPECT_TRUE(found.empty() || progress.iterations == iterations);
      iterations = progress.iterations;
      found.push_back(s.x);
    }
    EXPECT_EQ(found[0], found[1]);
    const Vector left = exact - found[0];
    EXPECT_LE(left.dot(a * left), 0.04 * exact.dot(a * exact));
  }
}

TEST(ResidualCheck, NegligibleDefectsTakeNoIterations) {
  CheckedStep s(33);
  const CompliantGradients system = s.system();
  CpuExec exec(1);
  CausedProgress progress;
  find_caused(exec, system, 0, 33, 1e9, 10, progress);
  EXPECT_EQ(progress.end, CausedProgress::End::found);
  EXPECT_EQ(progress.iterations, 0);
  EXPECT_EQ(s.x, Vector::Zero(3 * 33));
}

/// Squares of defects below zero, as of inverses that rounding has made indefinite, and no numbers.
TEST(ResidualCheck, IndefiniteInversesAreNoAnswer) {
  for (const double square : {-1.0, double{NAN}}) {
    SCOPED_TRACE(square);
    CausedProgress first, later;
    first.begin(square, 1e-9);
    later.begin(1, 1e-9);
    later.add(0.5, square, 1e-9);
    EXPECT_EQ(first.end, CausedProgress::End::lost);
    EXPECT_EQ(later.end, CausedProgress::End::lost);
    CausedProgress last;  // whose gains were small
    last.begin(1, 1e-9);
    for (const double gain : {1.0, 1e-3, 1e-3}) last.add(gain / last.square, 1, 1e-9);
    last.add(1e-3, square, 1e-9);
    EXPECT_EQ(last.end, CausedProgress::End::lost);
  }
  CausedProgress stuck;
  stuck.begin(1, 1e-9);
  stuck.add(0, 1, 1e-9);
  EXPECT_EQ(stuck.end, CausedProgress::End::lost);
  CausedProgress infinite, slow;
  infinite.begin(INFINITY, 1e-9);
  infinite.add(0, INFINITY, 1e-9);  // takes no step
  EXPECT_EQ(infinite.end, CausedProgress::End::lost);
  slow.begin(1, 1e-9);
  for (std::int64_t k = 0; k < CausedProgress::most_iterations; ++k) {
    EXPECT_EQ(slow.end, CausedProgress::End::open) << k;
    slow.add(1, std::pow(1.5, k), 1e-9);
  }
  EXPECT_EQ(slow.end, CausedProgress::End::lost);
}

/// omega D^-1 is at most twice A^-1, and omega times it on a single block; factors at rest and
/// single bodies are what they are.
TEST(ResidualCheck, LowerBlocksAreDividedByEigenvalues) {
  const std::vector<CompliantBody> bodies = {
      {.relaxation = 1, .frame = 0}, {.relaxation = 1.3}, {.relaxation = 1.3}, {.relaxation = 1}};
  const std::vector<std::int32_t> body_of_row = {0, 1, 2, 3}, start = {0, 1, 2, 4, 6, 7};
  const std::vector<std::int32_t> row = {0, 1, 1, 2, 0, 1, 3};
  const std::vector<double> factors = {1, 1 / 1.3, 0.5, 0.5, 1};
  CompliantBodies of;
  of.bodies = view(bodies);
  of.body_of_row = view(body_of_row);
  TouchingRows touching;
  touching.block_start = view(start);
  touching.row = view(row);
  std::vector<ContactConstants<double>> constants(5), lower(5);
  for (auto& own : constants) {
    for (int e = 0; e < 9; ++e) own.block[e] = 1 + e;
    own.tangent_metric = 20;
    own.friction = 0.5;
  }
  CpuExec(1).for_each("", 5,
                      LowerTouchOp{of, touching, view(std::as_const(constants)), view(lower)});
  for (std::size_t c = 0; c < 5; ++c) {
    for (int e = 0; e < 9; ++e) EXPECT_EQ(lower[c].block[e], factors[c] * (1 + e));
    EXPECT_EQ(lower[c].tangent_metric, factors[c] * 20);
    EXPECT_EQ(lower[c].friction, 0.5);
  }
}

}  // namespace
}  // namespace tetwarp::test
