#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "kernels/body/block_assemble.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
/// M + dt^2 K of a sheet scaled by `scale` in its plane, from the stages of a step.
Eigen::MatrixXd system_of_sheet(double scale, double time_step) {
  Model model = empty_model();
  add_sheet(model, 6, 0.1, 400, 0.3 * 0.36);
  const auto& edges = model.edges;
  std::vector<double> position;
  for (const Point3& p : model.start.position) {
    for (const double x : p) position.push_back(scale * x);
  }
  const auto count = static_cast<std::int64_t>(edges.nodes.size());
  const std::vector<std::uint8_t> moved(model.start.position.size());
  std::vector<EdgePull> pulls(edges.nodes.size());
  std::vector<std::uint8_t> turned(edges.nodes.size());
  const EdgeSpringOp body{{edges.nodes.data()->data(), 2 * count},
                          {edges.stiffness.data(), count},
                          {edges.rest_length.data(), count},
                          {position.data(), static_cast<std::int64_t>(position.size())},
                          {moved.data(), static_cast<std::int64_t>(moved.size())},
                          {pulls.data(), count},
                          {turned.data(), count}};
  for (std::int64_t e = 0; e < count; ++e) body(e);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * model.node_count, 3 * model.node_count);
  for (int n = 0; n < model.node_count; ++n) {
    a.block<3, 3>(3 * n, 3 * n).diagonal().setConstant(model.node_mass[static_cast<size_t>(n)]);
  }
  for (std::size_t e = 0; e < edges.nodes.size(); ++e) {
    double block[9] = {};
    add_edge_block(pulls[e], time_step * time_step, block);
    const Eigen::Map<Eigen::Matrix3d> k(block);
    const int i = 3 * edges.nodes[e][0], j = 3 * edges.nodes[e][1];
    a.block<3, 3>(i, i) += k;
    a.block<3, 3>(j, j) += k;
    a.block<3, 3>(i, j) -= k;
    a.block<3, 3>(j, i) -= k;
  }
  return a;
}

/// Without the clamp the least eigenvalue would be negative.
TEST(EdgeSpring, KeepsTheSystemOfACompressedSheetPositive) {
  for (const double scale : {0.7, 0.1, 1.0, 1.5}) {
    const Eigen::MatrixXd a = system_of_sheet(scale, 0.05);

    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(a);

    EXPECT_LT((a - a.transpose()).norm(), 1e-15 * a.norm());
    EXPECT_GT(eigen.eigenvalues().minCoeff(), 0.3 * 0.36 / 49 * 0.99) << scale;
  }
}

/// Stretched by d the force is k d along the edge, and both nodes have opposite ones.
TEST(EdgeSpring, PullsInProportionToItsStretch) {
  Model model = empty_model();
  add_sheet(model, 1, 1, 50, 4);
  for (Point3& p : model.start.position) p[0] *= 1.5;
  model.edges.nodes.resize(1);  // from node 0 to node 1
  model.edges.stiffness.resize(1);
  model.edges.rest_length.resize(1);
  model.edges.gamma.resize(1);
  const double dt = 1e-6;
  const auto stepper = make_cpu_stepper(model, {.linear_tolerance = 1e-13});

  stepper->step(input_for(model, dt));

  ModelState state;
  stepper->get_state(state);
  EXPECT_NEAR(state.velocity[0][0] / dt, 50 * 0.5, 1e-6);
  EXPECT_NEAR(state.velocity[1][0] / dt, -50 * 0.5, 1e-6);
  EXPECT_EQ(state.velocity[0][1], 0);
}

}  // namespace
}  // namespace tetwarp::test
