#include "tests/support/elastic_block.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <array>
#include <cmath>
#include <vector>

namespace tetwarp::test {
namespace {
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Corners of a cube by bits x + 2 y + 4 z. The middle tetrahedron takes every second corner;
/// neighboring cubes take turns, so that the diagonals of their common faces agree.
constexpr int split[2][5][4] = {
    {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}},
    {{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 1, 2, 7}, {5, 1, 4, 7}, {6, 2, 4, 7}}};

class Assembly {
 public:
  explicit Assembly(const ElasticBlock& block)
      : block_(block), per_edge_(block.cells + 1), spacing_(block.edge / block.cells) {
    const Index dofs = 3 * node_count();
    mass_.setZero(dofs);
    for (int k = 0; k < block.cells; ++k) {
      for (int j = 0; j < block.cells; ++j) {
        for (int i = 0; i < block.cells; ++i) add_cube(i, j, k);
      }
    }
    for (Index dof = 0; dof < dofs; ++dof) triplets_.emplace_back(dof, dof, mass_(dof));
  }

  Index node_count() const { return Index{per_edge_} * per_edge_ * per_edge_; }
  Index node(int i, int j, int k) const { return (Index{k} * per_edge_ + j) * per_edge_ + i; }
  int per_edge() const { return per_edge_; }

  SparseMatrix system() const {
    Eigen::SparseMatrix<double, Eigen::RowMajor> sum(3 * node_count(), 3 * node_count());
    sum.setFromTriplets(triplets_.begin(), triplets_.end());
    SparseMatrix matrix{sum.rows(), sum.cols(), {}, {}, {}};
    matrix.row_start.assign(sum.outerIndexPtr(), sum.outerIndexPtr() + sum.rows() + 1);
    matrix.column.assign(sum.innerIndexPtr(), sum.innerIndexPtr() + sum.nonZeros());
    matrix.value.assign(sum.valuePtr(), sum.valuePtr() + sum.nonZeros());
    return matrix;
  }

 private:
  void add_cube(int i, int j, int k) {
    for (const auto& corners : split[(i + j + k) % 2]) {
      std::array<Index, 4> nodes;
      Eigen::Matrix4d positions;  // rows 1 x y z
      for (std::size_t c = 0; c < 4; ++c) {
        const int x = i + (corners[c] & 1), y = j + (corners[c] >> 1 & 1),
                  z = k + (corners[c] >> 2);
        nodes[c] = node(x, y, z);
        positions.row(static_cast<Index>(c)) << 1, x * spacing_, y * spacing_, z * spacing_;
      }
      add_tetrahedron(nodes, positions);
    }
  }

  /// Energy of the strain e:  V (lambda tr(e)^2 / 2 + mu e : e).
  void add_tetrahedron(const std::array<Index, 4>& nodes, const Eigen::Matrix4d& positions) {
    const double nu = block_.poisson;
    const double lambda = block_.young * nu / ((1 + nu) * (1 - 2 * nu));
    const double mu = block_.young / (2 * (1 + nu));
    const double volume = std::abs(positions.determinant()) / 6;
    const Eigen::Matrix<double, 3, 4> gradients = positions.inverse().bottomRows<3>();
    const double scale = block_.time_step * block_.time_step * volume;
    for (Index a = 0; a < 4; ++a) {
      const Index row = 3 * nodes[static_cast<std::size_t>(a)];
      mass_.segment<3>(row).array() += block_.density * volume / 4;
      for (Index b = 0; b < 4; ++b) {
        const Vector3d ga = gradients.col(a), gb = gradients.col(b);
        const Matrix3d part = lambda * ga * gb.transpose() + mu * gb * ga.transpose() +
                              mu * ga.dot(gb) * Matrix3d::Identity();
        const Index column = 3 * nodes[static_cast<std::size_t>(b)];
        for (Index r = 0; r < 3; ++r) {
          for (Index c = 0; c < 3; ++c) {
            triplets_.emplace_back(row + r, column + c, scale * part(r, c));
          }
        }
      }
    }
  }

  ElasticBlock block_;
  int per_edge_;
  double spacing_;
  Eigen::VectorXd mass_;
  std::vector<Eigen::Triplet<double>> triplets_;
};
}  // namespace

ContactProblem make_elastic_problem(const ElasticBlock& block) {
  const Assembly assembly(block);
  const int per_edge = assembly.per_edge();
  ContactProblem problem;
  problem.system = assembly.system();
  problem.load.assign(static_cast<std::size_t>(problem.system.rows), 0);
  for (Index node = 0; node <= assembly.node_count(); ++node) {
    problem.block_start.push_back(static_cast<std::int32_t>(3 * node));
  }
  problem.jacobian = {0, problem.system.columns, {0}, {}, {}};
  AdhesionState& adhesion = problem.adhesion;
  adhesion.time_step = block.time_step;
  const int side = per_edge * (per_edge / 2);  // nodes of half the top
  for (int j = 0; j < per_edge; ++j) {
    for (int i = 0; i < per_edge; ++i) {
      if (2 * i != per_edge - 1) {
        const double force = (2 * i < per_edge ? -1 : 1) * block.lift / side;
        const Index top = 3 * assembly.node(i, j, block.cells);
        problem.load[static_cast<std::size_t>(top + 2)] = block.time_step * force;
        problem.load[static_cast<std::size_t>(top)] = block.time_step * block.lift / side;
      }
      const Index bottom = 3 * assembly.node(i, j, 0);
      for (const Index axis : {2, 0, 1}) {  // normal z, tangents x and y
        problem.jacobian.column.push_back(static_cast<std::int32_t>(bottom + axis));
        problem.jacobian.value.push_back(1);
        problem.jacobian.row_start.push_back(++problem.jacobian.rows);
      }
      problem.friction.push_back(block.friction);
      adhesion.area.push_back(block.edge * block.edge / (per_edge * per_edge));
      adhesion.stiffness.push_back(block.stiffness);
      adhesion.intensity.push_back(1);
    }
  }
  problem.velocity_offset.assign(3 * problem.friction.size(), 0);
  return problem;
}

}  // namespace tetwarp::test
