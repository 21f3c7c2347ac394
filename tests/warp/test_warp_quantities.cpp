/// @file test_warp_quantities.cpp
/// Vectors and tensors follow the deformation, in world axes.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/support/affine_scenes.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {
using Matrix = Eigen::Matrix3d;
using Vector = Eigen::Vector3d;

constexpr std::array vectors = {Quantity::vector, Quantity::covariant_vector,
                                Quantity::contravariant_vector};
constexpr std::array tensors = {Quantity::tensor, Quantity::principal_tensor};

Matrix tensor_of(const double* d) {
  Matrix tensor;
  tensor << d[0], d[3], d[5], d[3], d[1], d[4], d[5], d[4], d[2];
  return tensor;
}

Volume constant_volume(const Grid& grid, const std::vector<double>& value) {
  Volume volume = make_volume(grid, PixelType::float64, static_cast<int>(value.size()));
  for (std::size_t s = 0; s < volume.samples<double>().size(); ++s) {
    volume.samples<double>()[s] = value[s % value.size()];
  }
  return volume;
}

const std::vector<double> some_vector = {0.3, -1.1, 0.7};
const std::vector<double> some_tensor = {1.9, 0.4, 0.8, 0.3, -0.2, 0.5};

/// Calls check(component values) for every covered voxel of a warp of equal values, on every back
/// end; source and output on grids of different, oblique and mirrored axes.
void for_covered(const std::vector<double>& value,
                 Quantity quantity,
                 const Matrix& forward,
                 const std::function<void(const double*)>& check) {
  Grid source = scenes::oblique_grid(9, 8, 7);
  Grid mirrored = scenes::unit_grid(20, 9, 11);
  mirrored.direction = {0, -1, 0, 1, 0, 0, 0, 0, -1};
  mirrored.spacing = {0.8, 1.1, 1.7};
  const Point3 at = center_of(source);
  mirrored.origin = {at[0] + 5, at[1] - 8, at[2] + 9};
  for (const Grid& output : {source, mirrored}) {
    const scenes::Scene scene = affine_scene(source, output, forward);
    for (const Backend backend : usable_backends()) {
      SCOPED_TRACE(name_of(backend));
      WarpOptions options{.filter = Filter::cubic};
      options.quantities = {quantity};
      const Warped warped = run_warp(constant_volume(source, value), scene, backend, options);
      const auto samples = warped.volume.samples<double>();
      EXPECT_GT(warped.counts.covered, 100);
      for (std::size_t v = 0; v < warped.owner.size(); ++v) {
        if (warped.owner[v] >= 0) check(samples.data() + v * value.size());
      }
    }
  }
}

/// Under a rotation all laws agree. Nodes are rounded to 2^-20 voxel, of tetrahedra some two voxels
/// thick: a matrix is good to 2e-6.
TEST(WarpQuantities, FollowARotation) {
  const Matrix rotation = turn(2.1, {1, -2, 0.5});
  const Vector turned = rotation * Vector(some_vector[0], some_vector[1], some_vector[2]);
  const Matrix expected = rotation * tensor_of(some_tensor.data()) * rotation.transpose();
  for (const Quantity quantity : vectors) {
    for_covered(some_vector, quantity, rotation, [&](const double* v) {
      ASSERT_NEAR((Eigen::Map<const Vector>(v) - turned).norm(), 0, 1e-5);
    });
  }
  for (const Quantity quantity : tensors) {
    for_covered(some_tensor, quantity, rotation,
                [&](const double* d) { ASSERT_NEAR((tensor_of(d) - expected).norm(), 0, 2e-5); });
  }
}

/// F = 1 + g e_x e_y^T: R turns by atan(g / 2) about z, F^-T takes e_x to (1, -g, 0), F takes e_y
/// to (g, 1, 0).
TEST(WarpQuantities, FollowAShear) {
  constexpr double g = 0.75;
  Matrix shear = Matrix::Identity();
  shear(0, 1) = g;
  const double angle = -std::atan(g / 2);
  const auto expect = [&](Quantity quantity, const Vector& in, const Vector& out) {
    for_covered({in(0), in(1), in(2)}, quantity, shear, [&](const double* v) {
      ASSERT_NEAR((Eigen::Map<const Vector>(v) - out).norm(), 0, 1e-5);
    });
  };
  expect(Quantity::vector, Vector::UnitX(), {std::cos(angle), std::sin(angle), 0});
  expect(Quantity::covariant_vector, Vector::UnitX(), {1, -g, 0});
  expect(Quantity::covariant_vector, Vector::UnitY(), Vector::UnitY());
  expect(Quantity::contravariant_vector, Vector::UnitY(), {g, 1, 0});
  expect(Quantity::contravariant_vector, Vector::UnitX(), Vector::UnitX());

  const Matrix rotation = turn(angle, Vector::UnitZ());
  const Matrix finite = rotation * tensor_of(some_tensor.data()) * rotation.transpose();
  for_covered(some_tensor, Quantity::tensor, shear,
              [&](const double* d) { ASSERT_NEAR((tensor_of(d) - finite).norm(), 0, 2e-5); });
  // A tensor along y, with its second direction z: y becomes (g, 1, 0), z is unchanged.
  const Vector along = Vector(g, 1, 0).normalized(), across = along.cross(Vector::UnitZ());
  const Matrix principal = 3 * along * along.transpose() +
                           2 * Vector::UnitZ() * Vector::UnitZ().transpose() +
                           across * across.transpose();
  for_covered({1, 3, 2, 0, 0, 0}, Quantity::principal_tensor, shear,
              [&](const double* d) { ASSERT_NEAR((tensor_of(d) - principal).norm(), 0, 2e-5); });
}

/// Waved meshes, some of them turned inside out; float32 and integers, footprints and densities.
/// The reference's rotation is as accurate as the gap between singular values, which is tiny in
/// slivers.
TEST(WarpQuantities, AreTheReference) {
  for (const char* name : {"waved", "oblique", "other_grid"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 14);
    SCOPED_TRACE(name);
    for (const bool is_tensor : {false, true}) {
      const Volume source =
          scenes::wavy_volume(scene.source_grid, PixelType::float64, is_tensor ? 6 : 3);
      for (int q = 0; q < (is_tensor ? 2 : 3); ++q) {
        const auto of = static_cast<std::size_t>(q);
        WarpOptions options{.antialias = true, .background = 7};
        options.intensity = q == 1 ? Intensity::density : Intensity::value;
        options.quantities = {is_tensor ? tensors[of] : vectors[of]};
        const Warped expected = run_warp(source, scene, Backend::reference, options);
        for (const Backend backend : usable_backends()) {
          SCOPED_TRACE(name_of(backend));
          const Warped warped = run_warp(source, scene, backend, options);
          EXPECT_LE(largest_difference(warped.volume, expected.volume), 1e-9);
        }
      }
    }
  }
}

/// A reflection contains no rotation: the nearest proper one is used, lengths are preserved.
TEST(WarpQuantities, StayFiniteWhereATetrahedronIsInsideOutOrNearlyFlat) {
  for (const Vector& stretch : {Vector(1, -0.5, 2), Vector(1, 1, 1e-4), Vector(-1, -1, -1)}) {
    const Matrix forward = turn(0.3, {1, 1, 0}) * stretch.asDiagonal();
    for (const Quantity quantity : {Quantity::vector, Quantity::tensor}) {
      const auto& value = quantity == Quantity::vector ? some_vector : some_tensor;
      const double length = quantity == Quantity::vector
                                ? Eigen::Map<const Vector>(value.data()).norm()
                                : tensor_of(value.data()).norm();
      const Grid grid = scenes::unit_grid(9, 9, 9);
      const scenes::Scene scene = affine_scene(grid, grid, forward);
      for (const Backend backend : usable_backends()) {
        SCOPED_TRACE(name_of(backend));
        WarpOptions options;
        options.quantities = {quantity};
        const Warped warped = run_warp(constant_volume(grid, value), scene, backend, options);
        EXPECT_GT(warped.counts.covered, 5);
        for (std::size_t v = 0; v < warped.owner.size(); ++v) {
          if (warped.owner[v] < 0) continue;
          const double* at = warped.volume.samples<double>().data() + v * value.size();
          const double now = quantity == Quantity::vector ? Eigen::Map<const Vector>(at).norm()
                                                          : tensor_of(at).norm();
          ASSERT_NEAR(now, length, 1e-12);
        }
      }
    }
  }
}

TEST(WarpQuantities, AreRefusedWhereTheyCannotBe) {
  const Grid grid = scenes::unit_grid(4, 4, 4);
  const auto complaint = [&](PixelType type, int components, const WarpOptions& options) {
    const scenes::Scene scene = affine_scene(grid, grid, Matrix::Identity());
    return message_of(
        [&] { warp(make_volume(grid, type, components), scene.mesh, scene.deformed, options); });
  };
  EXPECT_EQ(complaint(PixelType::float32, 1, {.filter = Filter::nearest, .antialias = true}),
            "antialias: cannot average samples with nearest and labels; use another filter");
  EXPECT_EQ(complaint(PixelType::float32, 2, {.quantities = {Quantity::vector}}),
            "quantities: a vector has 3 components, the source 2");
  EXPECT_EQ(complaint(PixelType::float32, 3, {.quantities = {Quantity::principal_tensor}}),
            "quantities: a tensor has 6 components, the source 3");
  EXPECT_EQ(complaint(PixelType::float32, 3, {.quantities = {{}, {}}}),
            "quantities: expected none or one per source, 1, got 2");
  EXPECT_EQ(
      complaint(PixelType::int64, 1, {.filter = Filter::nearest, .intensity = Intensity::density}),
      "source: int64 cannot be scaled or turned; leave out intensity and quantities, or use "
      "another type");
  EXPECT_EQ(
      complaint(PixelType::uint8, 1, {.filter = Filter::labels, .intensity = Intensity::density}),
      "source: labels cannot be scaled or turned; leave out intensity and quantities, or use "
      "another type");
  const auto conserve = [&](WarpOptions options) {
    options.intensity = Intensity::conservative;
    return complaint(PixelType::float32, 3, options);
  };
  EXPECT_EQ(conserve({}), "");
  EXPECT_EQ(conserve({.antialias = true}),
            "intensity: to keep the total, means are exact without antialias");
  EXPECT_EQ(conserve({.background = 1}), "intensity: to keep the total, the background must be 0");
  EXPECT_EQ(conserve({.outside = Outside::identity}),
            "intensity: to keep the total, outside must be background");
  EXPECT_EQ(conserve({.quantities = {Quantity::vector}}),
            "intensity: to keep the total, vectors and tensors take density");
}

/// Between grids of the same axes; not where the grids, and with them the world, are turned.
TEST(WarpQuantities, AreCopiedUnderAWholeShift) {
  const Grid grid = scenes::oblique_grid(12, 11, 10);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32, 3);
  const Mesh mesh = covering_mesh(grid);
  scenes::Scene scene = {"shift", mesh, moved(grid, mesh.rest_positions, {2, -1, 3}), grid, grid};
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    for (const Quantity quantity : vectors) {
      WarpOptions options;
      options.quantities = {quantity};
      options.intensity = Intensity::density;
      EXPECT_EQ(run_warp(source, scene, backend, options).volume.data,
                run_warp(source, scene, backend).volume.data);
    }
  }
  Grid turned = grid;  // everything turns by 90 degrees about z: same indices, other world
  for (std::size_t axis = 0; axis < 3; ++axis) {
    turned.direction[axis] = -grid.direction[3 + axis];
    turned.direction[3 + axis] = grid.direction[axis];
  }
  scene.output_grid = turned;
  for (std::size_t n = 0; n < scene.deformed.size(); ++n) {
    const Vector p = vector_of(mesh.rest_positions[n]) - vector_of(grid.origin);
    scene.deformed[n] = {grid.origin[0] - p(1), grid.origin[1] + p(0), grid.origin[2] + p(2)};
  }
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    WarpOptions options;
    options.quantities = {Quantity::vector};
    const Warped warped = run_warp(source, scene, backend, options);
    const auto from = source.samples<float>(), to = warped.volume.samples<float>();
    for (std::size_t v = 0; v < warped.owner.size(); ++v) {
      ASSERT_NEAR(to[3 * v], -from[3 * v + 1], 1e-5);
      ASSERT_NEAR(to[3 * v + 1], from[3 * v], 1e-5);
      ASSERT_NEAR(to[3 * v + 2], from[3 * v + 2], 1e-5);
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
