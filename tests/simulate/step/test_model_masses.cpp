#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {

/// Mass, first and second moments of a body at rest: sums of m_ab over blocks.
struct Moments {
  double mass = 0;
  Point3 first{0, 0, 0};
  std::array<double, 9> second{};
};

Moments moments_of(const Model& model) {
  Moments moments;
  const ModelScalarBlocks& blocks = model.scalar_blocks;
  for (std::size_t k = 0; k < blocks.nodes.size(); ++k) {
    const Point3& a = at(model.start.position, blocks.nodes[k][0]);
    const Point3& b = at(model.start.position, blocks.nodes[k][1]);
    moments.mass += blocks.mass[k];
    moments.first = plus(moments.first, times(blocks.mass[k], b));
    for (std::size_t i = 0; i < 9; ++i) moments.second[i] += blocks.mass[k] * a[i / 3] * b[i % 3];
  }
  return moments;
}

/// An ellipsoid of values from 0 to 1 on a turned grid.
Volume blob(const std::array<std::int64_t, 3>& dims) {
  Grid grid;
  grid.dims = dims;
  grid.origin = {0.3, -0.2, 0.1};
  grid.spacing = {0.01, 0.012, 0.009};
  grid.direction = {0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1};
  Volume volume = make_volume(grid, PixelType::float32);
  std::size_t v = 0;
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i, ++v) {
        double square = 0;
        const std::array<std::int64_t, 3> ijk{i, j, k};
        for (std::size_t d = 0; d < 3; ++d) {
          const double half = static_cast<double>(dims[d] - 1) / 2;
          square += std::pow((static_cast<double>(ijk[d]) - half) / (0.9 * half), 2);
        }
        volume.samples<float>()[v] = static_cast<float>(std::max(0.0, 1 - square));
      }
    }
  }
  return volume;
}

Body image_body() {
  Body body;
  body.name = "blob";
  body.geometry = ImageGeometry{blob({22, 22, 23}), 0.1};
  body.lattice = Lattice{.cells = std::array<std::int64_t, 3>{4, 3, 3}};
  body.transfer = {{0.1, {1e4, 0.3, 800}}, {0.6, {1e5, 0.4, 1100}}, {1.0, {2e5, 0.2, 900}}};
  return body;
}

double density_of(double value) {
  if (value <= 0.1) return 800;
  if (value <= 0.6) return 800 + 300 * (value - 0.1) / 0.5;
  return 1100 - 200 * (value - 0.6) / 0.4;
}

/// Mass, center and second moments of an image's foreground.
/// @param has_extent  voxels are boxes, not points
Moments moments_of(const Volume& volume, bool has_extent) {
  Moments image;
  const auto& [dims, origin, spacing, direction] = volume.grid;
  const double voxel = spacing[0] * spacing[1] * spacing[2];
  std::size_t v = 0;
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i, ++v) {
        const double value = static_cast<double>(volume.samples<float>()[v]);
        if (!(value >= 0.1)) continue;
        const double mass = density_of(value) * voxel;
        const Point3 x = volume.grid.world_of(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        image.mass += mass;
        image.first = plus(image.first, times(mass, x));
        for (std::size_t e = 0; e < 9; ++e) {
          image.second[e] += mass * x[e / 3] * x[e % 3];
          for (std::size_t axis = 0; axis < 3 && has_extent; ++axis) {
            image.second[e] += mass / 12 * spacing[axis] * spacing[axis] *
                               direction[e / 3 * 3 + axis] * direction[e % 3 * 3 + axis];
          }
        }
      }
    }
  }
  return image;
}

/// Of coarse lattices those of the voxels as points, of fine ones, also far below the size of a
/// voxel, those of the voxels as boxes.
TEST(ImageMass, EqualsTheIntegralOfTheImage) {
  Body body = image_body();
  for (const std::array<std::int64_t, 3>& cells :
       {std::array<std::int64_t, 3>{1, 1, 1}, {1, 9, 2}, {4, 3, 3}, {17, 11, 13}, {23, 22, 21}}) {
    body.lattice->cells = cells;
    const bool has_extent = cells != std::array<std::int64_t, 3>{1, 1, 1};
    const Moments image = moments_of(std::get<ImageGeometry>(body.geometry).volume, has_extent);

    const Moments model = moments_of(model_of(scene_of({body}, 0.01)));

    EXPECT_NEAR(model.mass / image.mass, 1, 1e-9);
    EXPECT_LT(norm(minus(model.first, image.first)), 1e-9 * image.mass);
    for (std::size_t e = 0; e < 9; ++e) {
      EXPECT_NEAR(model.second[e], image.second[e], 1e-9 * image.mass);
    }
  }
}

/// The mass is density times volume of the voxels from the threshold on, whatever the lattice is.
TEST(ImageMass, CountsEveryVoxelOnceForAnyLattice) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> number(1, 6), sample(0, 3);
  for (int trial = 0; trial < 30; ++trial) {
    Grid grid;
    grid.dims = {number(random), number(random), number(random)};
    grid.spacing = {0.1 * number(random), 0.1 * number(random), 0.1 * number(random)};
    grid.origin = {-3, 5, 0.7 * number(random)};
    grid.direction = {0, -0.6, 0.8, 1, 0, 0, 0, 0.8, 0.6};
    Volume volume = make_volume(grid, PixelType::uint8);
    for (std::uint8_t& value : volume.samples<std::uint8_t>()) {
      value = static_cast<std::uint8_t>(sample(random));
    }
    volume.samples<std::uint8_t>()[0] = 3;
    double mass = 0;
    for (const std::uint8_t value : volume.samples<std::uint8_t>()) mass += value > 1 ? value : 0;
    mass *= 1000 * grid.spacing[0] * grid.spacing[1] * grid.spacing[2];
    Body body;
    body.name = "noise";
    body.geometry = ImageGeometry{volume, 2};
    body.transfer = {{0, {1e4, 0.3, 0}}, {3, {1e4, 0.3, 3000}}};
    body.lattice = Lattice{};
    switch (trial % 3) {
      case 0:
        body.lattice->cells = {number(random), number(random), number(random)};
        break;
      case 1:
        body.lattice->edge = 0.25 * number(random);
        break;
      default:
        body.lattice->tets = 30 * number(random);
    }
    const Simulator simulator(scene_of({body}, 0.01));

    EXPECT_NEAR(simulator.body(0).mass / mass, 1, 1e-9) << trial;
    EXPECT_LE(simulator.body(0).uncovered_volume, 1e-9 * simulator.body(0).foreground_volume);
  }
}

/// A block of one material in any lattice has the masses and moduli of a box in this lattice.
TEST(ImageMass, OfAUniformBlockIsThatOfABox) {
  Body image;
  image.name = "block";
  const Grid grid{.dims = {4, 3, 5}, .origin = {-0.15, -0.2, -0.2}, .spacing = {0.1, 0.2, 0.1}};
  image.geometry = ImageGeometry{make_volume(grid, PixelType::uint8), 0};
  for (const std::array<std::int64_t, 3>& cells :
       {std::array<std::int64_t, 3>{1, 1, 1}, {2, 2, 2}, {3, 5, 1}, {7, 4, 9}}) {
    Body box = elastic_box("box", {0.2, 0.3, 0.25}, cells);
    image.lattice = box.lattice;
    image.material = box.material;
    const Model exact = model_of(scene_of({box}, 0.01)), model = model_of(scene_of({image}, 0.01));

    ASSERT_EQ(model.scalar_blocks.nodes, exact.scalar_blocks.nodes);
    const double largest = *std::ranges::max_element(exact.scalar_blocks.mass);
    for (std::size_t k = 0; k < exact.scalar_blocks.mass.size(); ++k) {
      EXPECT_NEAR(model.scalar_blocks.mass[k], exact.scalar_blocks.mass[k], 1e-12 * largest);
    }
    for (std::size_t t = 0; t < exact.tets.mu.size(); ++t) {
      EXPECT_NEAR(model.tets.mu[t] / exact.tets.mu[t], 1, 1e-12);
      EXPECT_NEAR(model.tets.lambda[t] / exact.tets.lambda[t], 1, 1e-12);
    }
  }
}

TEST(ImageMass, LumpedKeepsMassAndCenter) {
  Body body = image_body();
  const Moments consistent = moments_of(model_of(scene_of({body}, 0.01)));
  body.mass = MassKind::lumped;
  const Model model = model_of(scene_of({body}, 0.01));
  const Moments lumped = moments_of(model);

  EXPECT_NEAR(lumped.mass / consistent.mass, 1, 1e-13);
  EXPECT_LT(norm(minus(lumped.first, consistent.first)), 1e-13 * lumped.mass);
  EXPECT_EQ(model.scalar_blocks.nodes.size(), model.start.position.size());
}

/// Of two layers of equal thickness the arithmetic mean is the upper, the harmonic the lower bound.
TEST(ImageMaterial, MeansAreThoseOfTheVoxels) {
  Body body;
  body.name = "layers";
  Volume volume = make_volume({.dims = {8, 8, 8}, .spacing = {0.1, 0.1, 0.1}}, PixelType::uint8);
  for (std::size_t v = 0; v < 512; ++v) {
    volume.samples<std::uint8_t>()[v] = v % 2 == 0 ? 1 : 3;
  }
  body.geometry = ImageGeometry{volume, 1};
  body.lattice = Lattice{.cells = std::array<std::int64_t, 3>{1, 1, 1}};
  body.lookup = TransferLookup::label;
  body.transfer = {{1, {1e4, 0, 1000}}, {3, {4e4, 0, 3000}}};
  const Model arithmetic = model_of(scene_of({body}, 0.01));
  body.mean = MaterialMean::harmonic;
  const Model harmonic = model_of(scene_of({body}, 0.01));

  EXPECT_NEAR(total(arithmetic.node_mass), 2000 * 0.512, 1e-9);
  double stiffness = 0, volume_of_all = 0, soft = 0;
  for (std::size_t t = 0; t < arithmetic.tets.volume.size(); ++t) {
    stiffness += arithmetic.tets.mu[t] * arithmetic.tets.volume[t];
    soft += harmonic.tets.mu[t] * harmonic.tets.volume[t];
    volume_of_all += arithmetic.tets.volume[t];
    EXPECT_EQ(arithmetic.tets.lambda[t], 0);
    EXPECT_LT(harmonic.tets.mu[t], arithmetic.tets.mu[t]);
  }
  EXPECT_NEAR(volume_of_all, 0.512, 1e-12);
  EXPECT_NEAR(stiffness / volume_of_all, 1.25e4, 1e-8);  // E/2 = mu at nu = 0
  EXPECT_GT(soft / volume_of_all, 0.7e4);  // 8e3 where every tetrahedron has as many of both
  EXPECT_LT(soft / volume_of_all, 0.9e4);
}

TEST(ShapeMass, IsThatOfTheShape) {
  const double pi = std::numbers::pi;
  struct Case {
    Shape shape;
    double volume;
  };
  for (const Case& c : {Case{BoxShape{{0.2, 0.1, 0.3}}, 8 * 0.2 * 0.1 * 0.3},
                        Case{EllipsoidShape{{0.2, 0.1, 0.3}}, 4 * pi / 3 * 0.2 * 0.1 * 0.3},
                        Case{CapsuleShape{0.1, 0.4}, pi * 0.01 * (0.4 + 0.4 / 3)},
                        Case{TorusShape{0.3, 0.1}, 2 * pi * pi * 0.3 * 0.01}}) {
    Body body = elastic_box("body", {1, 1, 1}, {6, 6, 6});
    body.geometry = c.shape;
    const Model model = model_of(scene_of({body}, 0.01));

    EXPECT_NEAR(total(model.node_mass) / (1000 * c.volume), 1, 1e-3);
  }
}

/// Consistent masses integrate products of linear functions exactly: the inertia of a box.
TEST(ShapeMass, HasTheInertiaOfABox) {
  const Model model = model_of(scene_of({elastic_box("box", {0.2, 0.1, 0.3}, {2, 1, 3})}, 0.01));

  const Moments moments = moments_of(model);

  const double mass = 1000 * 8 * 0.2 * 0.1 * 0.3;
  EXPECT_NEAR(moments.mass, mass, 1e-12 * mass);
  EXPECT_NEAR(moments.second[0], mass * 0.04 / 3, 1e-12 * mass);
  EXPECT_NEAR(moments.second[4], mass * 0.01 / 3, 1e-12 * mass);
  EXPECT_NEAR(moments.second[8], mass * 0.09 / 3, 1e-12 * mass);
}

}  // namespace
}  // namespace tetwarp::test
