#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "kernels/body/tet_force.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
/// Forces on all nodes by the stage of the step.
std::vector<Point3> forces_of(const Model& model, const ModelState& state) {
  std::vector<Point3> forces(state.position.size());
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    double x[12], f[9], r[9], turned[12], force[12];
    for (std::size_t a = 0; a < 4; ++a) {
      const Point3& p = state.position[static_cast<std::size_t>(model.tets.nodes[t][a])];
      for (std::size_t i = 0; i < 3; ++i) x[3 * a + i] = p[i];
    }
    const double* g = model.tets.gradient[t].data();
    deformation_gradient(x, g, f);
    tet_rotation(f, r);
    const double volume = model.tets.volume[t];
    corotated_forces(f, r, g, volume * model.tets.lambda[t], volume * model.tets.mu[t], turned,
                     force);
    for (std::size_t a = 0; a < 4; ++a) {
      Point3& sum = forces[static_cast<std::size_t>(model.tets.nodes[t][a])];
      for (std::size_t i = 0; i < 3; ++i) sum[i] += force[3 * a + i];
    }
  }
  return forces;
}

double largest(const std::vector<Point3>& values) {
  double most = 0;
  for (const Point3& v : values) most = std::max(most, std::hypot(v[0], v[1], v[2]));
  return most;
}

ModelState moved(const Model& model, const Eigen::Matrix3d& map, const Eigen::Vector3d& shift) {
  ModelState state = model.start;
  for (Point3& p : state.position) {
    const Eigen::Vector3d q = map * Eigen::Vector3d(p[0], p[1], p[2]) + shift;
    p = {q[0], q[1], q[2]};
  }
  return state;
}

Model jittered_block() {
  Model model = empty_model();
  add_block(model, {.cells = {4, 4, 4}, .edge = 1, .jitter = 0.2});
  return model;
}

Eigen::Matrix3d some_rotation() {
  return Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
}

/// Offset 3e3 costs digits of the positions: 1e-10 E h^2.
TEST(ElasticForces, VanishUnderRigidMotion) {
  const Model model = jittered_block();

  const auto forces = forces_of(model, moved(model, some_rotation(), {1e3, 2e3, 3e3}));

  EXPECT_LT(largest(forces), 1e-10 * 1e5);
}

/// An affine map has the same stress everywhere: inner nodes carry no force.
TEST(ElasticForces, PassThePatchTest) {
  const Model model = jittered_block();
  Eigen::Matrix3d strain;
  strain << 1.2, 0.1, 0, 0.05, 0.9, 0.1, 0, 0, 1.1;

  const auto forces = forces_of(model, moved(model, some_rotation() * strain, {0, 0, 0}));

  const double outer = largest(forces);
  double inner = 0;
  for (int k = 1; k < 4; ++k) {
    for (int j = 1; j < 4; ++j) {
      for (int i = 1; i < 4; ++i) {
        inner = std::max(inner, largest({forces[static_cast<std::size_t>((k * 5 + j) * 5 + i)]}));
      }
    }
  }
  EXPECT_GT(outer, 1e3);
  EXPECT_LT(inner, 1e-12 * outer);
}

ModelState strained(const Model& model, unsigned seed) {
  ModelState state = moved(model, some_rotation(), {0, 0, 0});
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.15, 0.15);
  for (Point3& p : state.position) {
    for (double& x : p) x += shift(random);
  }
  return state;
}

TEST(ElasticForces, HaveNoNetForceOrTorque) {
  const Model model = jittered_block();
  const ModelState state = strained(model, 5);

  const auto forces = forces_of(model, state);

  Eigen::Vector3d force(0, 0, 0), torque(0, 0, 0);
  for (std::size_t n = 0; n < forces.size(); ++n) {
    const Eigen::Vector3d f(forces[n][0], forces[n][1], forces[n][2]);
    force += f;
    torque +=
        Eigen::Vector3d(state.position[n][0], state.position[n][1], state.position[n][2]).cross(f);
  }
  const double size = 4;
  EXPECT_LT(force.norm(), 1e-13 * largest(forces));
  EXPECT_LT(torque.norm(), 1e-13 * largest(forces) * size);
}

/// The error of central differences falls with the square of the step: exact gradient.
TEST(ElasticForces, AreTheGradientOfTheEnergy) {
  const Model model = jittered_block();
  const ModelState state = strained(model, 6);
  const auto forces = forces_of(model, state);
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::vector<Point3> direction(state.position.size());
  double slope = 0;
  for (std::size_t n = 0; n < direction.size(); ++n) {
    for (std::size_t i = 0; i < 3; ++i) {
      direction[n][i] = normal(random);
      slope -= forces[n][i] * direction[n][i];
    }
  }
  const auto error_at = [&](double h) {
    ModelState ahead = state, behind = state;
    for (std::size_t n = 0; n < direction.size(); ++n) {
      for (std::size_t i = 0; i < 3; ++i) {
        ahead.position[n][i] += h * direction[n][i];
        behind.position[n][i] -= h * direction[n][i];
      }
    }
    const double quotient =
        (elastic_energy(model, ahead) - elastic_energy(model, behind)) / (2 * h);
    return std::abs(quotient / slope - 1);
  };

  const double coarse = error_at(1e-2), fine = error_at(1e-3);

  EXPECT_LT(fine, 1e-4);
  EXPECT_NEAR(coarse / fine, 100, 20);
}

/// K_ab of the system against derivatives of the forces with the rotation held.
TEST(ElasticForces, HaveTheStiffnessOfTheSystemWhenTheRotationIsHeld) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  double g[9], f[9], r[9], turned[12], force[12];
  for (int k = 0; k < 9; ++k) g[k] = normal(random), f[k] = normal(random);
  tet_rotation(f, r);
  const double lambda = 2, mu = 3;
  corotated_forces(f, r, g, lambda, mu, turned, force);
  for (int b = 1; b < 4; ++b) {
    for (int j = 0; j < 3; ++j) {
      double moved_f[9], other[12], moved_force[12];
      for (int k = 0; k < 9; ++k) moved_f[k] = f[k];
      for (int i = 0; i < 3; ++i) moved_f[3 * j + i] += g[3 * (b - 1) + i];
      corotated_forces(moved_f, r, g, lambda, mu, other, moved_force);
      for (int a = 0; a < 4; ++a) {
        const double *ga = turned + 3 * a, *gb = turned + 3 * b;
        for (int i = 0; i < 3; ++i) {
          const double stiffness =
              lambda * ga[i] * gb[j] + mu * gb[i] * ga[j] + (i == j ? mu * dot3(ga, gb) : 0);
          EXPECT_NEAR(force[3 * a + i] - moved_force[3 * a + i], stiffness, 1e-11);
        }
      }
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
