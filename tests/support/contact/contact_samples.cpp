#include "tests/support/contact/contact_samples.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

namespace tetwarp::samples {

SparseMatrix sparse_of(const Eigen::MatrixXd& dense) {
  SparseMatrix matrix;
  matrix.rows = dense.rows();
  matrix.columns = dense.cols();
  matrix.row_start.push_back(0);
  for (Eigen::Index row = 0; row < dense.rows(); ++row) {
    for (Eigen::Index column = 0; column < dense.cols(); ++column) {
      if (dense(row, column) == 0) continue;
      matrix.column.push_back(static_cast<std::int32_t>(column));
      matrix.value.push_back(dense(row, column));
    }
    matrix.row_start.push_back(static_cast<std::int64_t>(matrix.column.size()));
  }
  return matrix;
}

std::vector<double> list_of(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::MatrixXd random_spd(std::mt19937& random, Eigen::Index size, double condition) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(0, std::log(condition));
  const Eigen::MatrixXd any =
      Eigen::MatrixXd::NullaryExpr(size, size, [&] { return normal(random); });
  const Eigen::MatrixXd axes = any.householderQr().householderQ();
  const Eigen::VectorXd spread =
      Eigen::VectorXd::NullaryExpr(size, [&] { return std::exp(exponent(random)); });
  return axes * spread.asDiagonal() * axes.transpose();
}

Eigen::VectorXd random_vector(std::mt19937& random, Eigen::Index size) {
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(size, [&] { return normal(random); });
}

AdhesionState adhesion_of(std::mt19937& random, const std::vector<double>& kappa) {
  AdhesionState adhesion;
  adhesion.time_step = 0.5;
  const Eigen::VectorXd gaps =
      0.5 * random_vector(random, 3 * static_cast<Eigen::Index>(kappa.size()));
  for (std::size_t c = 0; c < kappa.size(); ++c) {
    adhesion.area.push_back(4);  // dt^2 area = 1
    adhesion.stiffness.push_back(kappa[c]);
    adhesion.tangential_stiffness.push_back(0.75 * kappa[c]);
    adhesion.intensity.push_back(kappa[c] > 0 ? 1 : 0);
    for (int a = 0; a < 3; ++a) {
      adhesion.gap.push_back(a == 0 ? 0 : gaps(3 * static_cast<Eigen::Index>(c) + a));
    }
  }
  return adhesion;
}

std::vector<double> random_kappa(std::mt19937& random, std::int64_t contacts) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> kappa(static_cast<std::size_t>(contacts));
  for (double& value : kappa) {
    const double exponent = 6 * unit(random) - 3;
    value = unit(random) < 0.2 ? 0 : std::pow(10, exponent);
  }
  return kappa;
}

ContactProblem random_local(std::mt19937& random,
                            std::int64_t contacts,
                            double friction,
                            const std::vector<double>& kappa,
                            double condition) {
  ContactProblem problem;
  problem.delassus = sparse_of(random_spd(random, 3 * contacts, condition));
  problem.free_velocity = list_of(random_vector(random, 3 * contacts));
  problem.friction.assign(static_cast<std::size_t>(contacts), friction);
  problem.adhesion = adhesion_of(random, kappa);
  return problem;
}

ContactProblem single_contact(const Eigen::Vector3d& velocity, double friction) {
  ContactProblem problem;
  problem.delassus = sparse_of(Eigen::Matrix3d::Identity());
  problem.free_velocity = list_of(velocity);
  problem.friction = {friction};
  return problem;
}

AdhesionState bond(double kappa) {
  AdhesionState adhesion;
  adhesion.time_step = 1;
  adhesion.area = {1};
  adhesion.stiffness = {kappa};
  adhesion.intensity = {1};
  return adhesion;
}

ContactProblem random_global(std::mt19937& random,
                             Eigen::Index bodies,
                             Eigen::Index dofs,
                             double coupling,
                             double friction) {
  const Eigen::Index size = bodies * dofs;
  const Eigen::Index contacts = 2 * bodies - 1;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3 * contacts, size);
  std::normal_distribution<double> normal;
  for (Eigen::Index b = 0; b < bodies; ++b) {
    system.block(b * dofs, b * dofs, dofs, dofs) = random_spd(random, dofs, 10);
    jacobian.block(3 * b, b * dofs, 3, dofs) =
        Eigen::MatrixXd::NullaryExpr(3, dofs, [&] { return normal(random); });
    if (b + 1 == bodies) continue;
    const Eigen::MatrixXd link = coupling * random_spd(random, dofs, 3);
    system.block(b * dofs, (b + 1) * dofs, dofs, dofs) -= link;
    system.block((b + 1) * dofs, b * dofs, dofs, dofs) -= link.transpose();
    system.block(b * dofs, b * dofs, dofs, dofs) += link;
    system.block((b + 1) * dofs, (b + 1) * dofs, dofs, dofs) += link;
    jacobian.block(3 * (bodies + b), b * dofs, 3, 2 * dofs) =
        Eigen::MatrixXd::NullaryExpr(3, 2 * dofs, [&] { return normal(random); });
  }
  ContactProblem problem;
  problem.system = sparse_of(0.5 * (system + system.transpose()));
  problem.jacobian = sparse_of(jacobian);
  problem.load = list_of(random_vector(random, size));
  problem.velocity_offset = list_of(random_vector(random, 3 * contacts));
  problem.friction.assign(static_cast<std::size_t>(contacts), friction);
  for (Eigen::Index b = 0; b <= bodies; ++b) {
    problem.block_start.push_back(static_cast<std::int32_t>(b * dofs));
  }
  return problem;
}

double smallest_eigenvalue(const Eigen::MatrixXd& matrix) {
  return matrix.selfadjointView<Eigen::Lower>().eigenvalues()(0);
}

Eigen::MatrixXd solve_spd(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right_sides) {
  return matrix.llt().solve(right_sides);
}

}  // namespace tetwarp::samples
