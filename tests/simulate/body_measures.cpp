/// @file body_measures.cpp
/// Energies and momenta of states, straight from their definitions.
#include <Eigen/Dense>
#include <cmath>

#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

Vector eigen_vector(const Point3& p) {
  return {p[0], p[1], p[2]};
}

Matrix gradient_of(const Model& model, const ModelState& state, std::size_t t) {
  Matrix f = Matrix::Zero();
  const auto x = [&](std::size_t a) {
    return eigen_vector(state.position[static_cast<std::size_t>(model.tets.nodes[t][a])]);
  };
  for (std::size_t a = 1; a < 4; ++a) {
    const double* g = model.tets.gradient[t].data() + 3 * (a - 1);
    f += (x(a) - x(0)) * Eigen::RowVector3d(g[0], g[1], g[2]);
  }
  return f;
}

}  // namespace

ModelState state_of(const BodyStepper& stepper) {
  ModelState state;
  stepper.get_state(state);
  return state;
}

double distance(const Point3& a, const Point3& b) {
  return (eigen_vector(a) - eigen_vector(b)).norm();
}

double kinetic_energy(const Model& model, const ModelState& state) {
  double energy = 0;
  const auto v = [&](std::size_t block) { return eigen_vector(state.velocity[block]); };
  for (std::size_t e = 0; e < model.scalar_blocks.nodes.size(); ++e) {
    const auto& [a, b] = model.scalar_blocks.nodes[e];
    energy += 0.5 * model.scalar_blocks.mass[e] *
              v(static_cast<std::size_t>(a)).dot(v(static_cast<std::size_t>(b)));
  }
  for (std::size_t r = 0; r < model.rigid.mass.size(); ++r) {
    const std::size_t block = static_cast<std::size_t>(model.node_count) + 2 * r;
    const auto& q = state.rotation[r];
    const Matrix turn = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
    const Vector own = turn.transpose() * eigen_vector(state.angular_momentum[r]);
    energy += 0.5 * model.rigid.mass[r] * v(block).squaredNorm();
    for (int i = 0; i < 3; ++i) {
      energy += 0.5 * own[i] * own[i] / model.rigid.inertia[r][static_cast<std::size_t>(i)];
    }
  }
  return energy;
}

double elastic_energy(const Model& model, const ModelState& state) {
  double energy = 0;
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    const Matrix f = gradient_of(model, state, t);
    const Eigen::JacobiSVD<Matrix> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
    const Matrix s = svd.matrixV() * u.transpose() * f;
    const Matrix strain = 0.5 * (s + s.transpose()) - Matrix::Identity();
    const double trace = strain.trace();
    energy += model.tets.volume[t] * (model.tets.mu[t] * strain.squaredNorm() +
                                      0.5 * model.tets.lambda[t] * trace * trace);
  }
  return energy;
}

Point3 momentum(const Model& model, const ModelState& state) {
  Vector sum = Vector::Zero();
  for (std::size_t n = 0; n < model.node_mass.size(); ++n) {
    sum += model.node_mass[n] * eigen_vector(state.velocity[n]);
  }
  for (std::size_t r = 0; r < model.rigid.mass.size(); ++r) {
    sum += model.rigid.mass[r] *
           eigen_vector(state.velocity[static_cast<std::size_t>(model.node_count) + 2 * r]);
  }
  return {sum[0], sum[1], sum[2]};
}

Point3 angular_momentum(const Model& model, const ModelState& state) {
  Vector sum = Vector::Zero();
  for (std::size_t e = 0; e < model.scalar_blocks.nodes.size(); ++e) {
    const auto& [a, b] = model.scalar_blocks.nodes[e];
    sum += model.scalar_blocks.mass[e] *
           eigen_vector(state.position[static_cast<std::size_t>(a)])
               .cross(eigen_vector(state.velocity[static_cast<std::size_t>(b)]));
  }
  return {sum[0], sum[1], sum[2]};
}

int inverted_count(const Model& model, const ModelState& state) {
  int count = 0;
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    count += gradient_of(model, state, t).determinant() <= 0;
  }
  return count;
}

}  // namespace tetwarp::test
