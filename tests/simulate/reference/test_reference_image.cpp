/// Masses of elastic bodies made from images, on the reference.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/support/body_scenes.hpp"

namespace tetwarp::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// An ellipsoid of noise between 1 and 2 on 21 x 17 x 13 voxels of 4, 4 and 5 mm, tilted axes.
Volume noisy_ellipsoid() {
  Grid grid;
  grid.dims = {21, 17, 13};
  grid.spacing = {4e-3, 4e-3, 5e-3};
  grid.origin = {0.3, -0.2, 0.1};
  const Matrix3d turn = Eigen::AngleAxisd(0.4, Vector3d(1, 1, 0).normalized()).toRotationMatrix();
  for (int i = 0; i < 9; ++i) grid.direction[static_cast<std::size_t>(i)] = turn(i / 3, i % 3);
  Volume volume = make_volume(grid, PixelType::float64);
  Noise noise(1);
  auto samples = volume.samples<double>();
  std::size_t v = 0;
  for (int k = 0; k < 13; ++k) {
    for (int j = 0; j < 17; ++j) {
      for (int i = 0; i < 21; ++i, ++v) {
        const double r = std::hypot((i - 10) / 9.5, (j - 8) / 7.5, (k - 6) / 5.5);
        samples[v] = r < 1 ? 1.5 + 0.5 * noise() : 0;
      }
    }
  }
  return volume;
}

Body image_body(const Volume& volume) {
  Body body;
  body.name = "image";
  body.kind = BodyKind::fem;
  body.geometry = ImageGeometry{volume, 0.5};
  body.lattice = Lattice{std::array<std::int64_t, 3>{3, 3, 2}, {}, {}};
  body.transfer = {{1, {1e4, 0.3, 500}}, {1.4, {2e4, 0.2, 1500}}, {2, {3e4, 0.4, 900}}};
  body.damping = {0, 0};
  return body;
}

/// The density that the transfer table above gives a value.
double density_of(double value) {
  return value < 1.4 ? 500 + (value - 1) / 0.4 * 1000 : 1500 - (value - 1.4) / 0.6 * 600;
}

struct ImageMoments {
  double mass = 0;
  Vector3d center = Vector3d::Zero();
  Matrix3d inertia = Matrix3d::Zero();
};

/// Sums over the voxels as boxes, without any mesh.
ImageMoments moments_of(const Volume& volume) {
  ImageMoments moments;
  const auto& dims = volume.grid.dims;
  const double voxel = 4e-3 * 4e-3 * 5e-3;
  const auto samples = volume.samples<double>();
  const auto each = [&](const auto& work) {
    std::size_t v = 0;
    for (std::int64_t k = 0; k < dims[2]; ++k) {
      for (std::int64_t j = 0; j < dims[1]; ++j) {
        for (std::int64_t i = 0; i < dims[0]; ++i, ++v) {
          if (samples[v] < 0.5) continue;
          const Point3 x = volume.grid.world_of(
              {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          work(density_of(samples[v]) * voxel, Vector3d(x[0], x[1], x[2]));
        }
      }
    }
  };
  each([&](double mass, const Vector3d& x) {
    moments.mass += mass;
    moments.center += mass * x;
  });
  moments.center /= moments.mass;
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(
      volume.grid.direction.data());
  const Matrix3d box = axes *
                       (Vector3d(4e-3, 4e-3, 5e-3).array().square() / 12).matrix().asDiagonal() *
                       axes.transpose();
  each([&](double mass, const Vector3d& x) {
    const Vector3d arm = x - moments.center;
    const Matrix3d second = arm * arm.transpose() + box;
    moments.inertia += mass * (second.trace() * Matrix3d::Identity() - second);
  });
  return moments;
}

TEST(ReferenceImage, HasTheMassCenterAndInertiaOfItsVoxels) {
  const Volume volume = noisy_ellipsoid();
  Scene scene = scene_of(1e-3, 1);
  scene.bodies = {image_body(volume)};
  const SceneBodies image(scene);
  const auto bodies = image.bodies();
  const ImageMoments exact = moments_of(volume);

  double mass = 0;
  for (const double m : bodies.masses(0)) mass += m;
  const Point3 center = bodies.record().bodies[0].center;
  const std::array<double, 9> inertia = bodies.inertia(0);

  EXPECT_NEAR(mass, exact.mass, 1e-12 * exact.mass);
  for (int d = 0; d < 3; ++d) {
    EXPECT_NEAR(center[static_cast<std::size_t>(d)], exact.center(d), 1e-12 * 0.08);
  }
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(inertia[static_cast<std::size_t>(i)], exact.inertia(i / 3, i % 3),
                1e-12 * exact.inertia.norm());
  }
}

TEST(ReferenceImage, FallsAsFreelyLumpedAsConsistent) {
  for (const MassKind kind : {MassKind::consistent, MassKind::lumped}) {
    Scene scene = scene_of(1e-3, 10, {0, 0, -9.81});
    scene.bodies = {image_body(noisy_ellipsoid())};
    scene.bodies[0].mass = kind;
    const SceneBodies image(scene);
    auto bodies = image.bodies();

    for (int step = 0; step < 10; ++step) bodies.step();

    for (const Point3& v : bodies.node_velocities(0)) EXPECT_NEAR(v[2], -0.0981, 1e-12);
  }
}

}  // namespace
}  // namespace tetwarp::test
