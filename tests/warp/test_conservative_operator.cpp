/// @file test_conservative_operator.cpp
/// The operator of a warp that keeps totals: equal to the warp and to the matrix of the reference,
/// transposed exactly, and its columns sum up to what the mesh covers at rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/warp_operator.hpp>

#include "tests/support/hex_scenes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/operator_samples.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
std::vector<std::uint8_t> random_mask(const Grid& grid) {
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(grid.voxel_count()));
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = scenes::uniform(9, v) < 0.5;
  return mask;
}

WarpOperator operator_of(const scenes::Scene& scene,
                         std::vector<std::uint8_t> mask = {},
                         int threads = 2) {
  return {scene.source_grid,
          scene.mesh,
          scene.deformed,
          {.intensity = Intensity::conservative,
           .output_grid = scene.output_grid,
           .mask = std::move(mask),
           .threads = threads}};
}

Samples warped_by(Backend backend, const scenes::Scene& scene, const Samples& x) {
  WarpOptions options{.intensity = Intensity::conservative, .output_grid = scene.output_grid};
  options.backend = backend;
  const auto components = static_cast<int>(std::ssize(x) / scene.source_grid.voxel_count());
  const VolumeView source(scene.source_grid, PixelType::float64, components, x.data(),
                          Memory::host);
  Warper warper(std::span(&source, 1), scene.mesh, options);
  Samples y(static_cast<std::size_t>(warper.output_grid().voxel_count() * components));
  void* const data = y.data();
  warper.step(scene.deformed, {.volumes = std::span(&data, 1)});
  return y;
}

scenes::Scene hex_scene() {
  HexBox box = hex_box({2, 1, 2}, {0.5, 0.5, 0.5}, {4.5, 5.5, 4.5}, bent(0.6));
  const Grid grid = scenes::unit_grid(6, 7, 6);
  return {"hexahedra", box.mesh, box.deformed, grid, grid};
}

/// A mesh of which each voxel of the output holds a hundred voxels of the source and more.
scenes::Scene compressed_scene() {
  scenes::Scene scene{"compressed",
                      scenes::lattice({1, 1, 1}, {1, 1, 1}, {10, 10, 10}),
                      {},
                      scenes::unit_grid(12, 12, 12),
                      scenes::unit_grid(3, 3, 3)};
  for (const Point3& x : scene.mesh.rest_positions) {
    scene.deformed.push_back({0.2 * x[0], 0.15 * x[1], 0.2 * x[2] - 0.3});
  }
  return scene;
}

/// As what the stage promises between back ends, for samples of at most 1/2 and their sums.
constexpr double bound = 0x1p-42;

TEST(ConservativeOperator, IsTheWarpOfAllSamplesAlsoWhereTheyAreMaskedOrConstant) {
  for (const char* name : {"waved", "rotated", "oblique", "other_grid", "folded", "aligned"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 12);
    Samples x = random_samples(scene.source_grid, 1, 2);
    std::fill(x.begin(), x.begin() + std::ssize(x) / 3, 0.25);
    const std::vector<std::uint8_t> mask = random_mask(scene.output_grid);
    const WarpOperator all = operator_of(scene), masked = operator_of(scene, mask);
    const Samples expected = warped_by(Backend::cpu, scene, x);
    const Samples whole = forward_of(all, x), part = forward_of(masked, x);
    const std::vector<std::uint8_t> support = all.support();
    EXPECT_GT(length_of(whole), 1) << name;
    double largest = 1;
    for (const double value : expected) largest = std::max(largest, std::abs(value));
    for (std::size_t v = 0; v < whole.size(); ++v) {
      ASSERT_NEAR(whole[v], expected[v], bound * largest) << name << ", number " << v;
      ASSERT_EQ(part[v], mask[v / 2] != 0 ? whole[v] : 0) << name << ", number " << v;
      if (support[v / 2] == 0) {
        ASSERT_EQ(whole[v], 0) << name << ", number " << v;
      }
    }
  }
}

TEST(ConservativeOperator, IsTheWarpOfTheReferenceInBothDirections) {
  std::vector<scenes::Scene> all = {hex_scene(), compressed_scene()};
  for (const char* name : {"waved", "oblique", "folded"}) {
    all.push_back(scenes::adversarial_scene(name, 6));
  }
  for (std::size_t n = 0; n < all.size(); ++n) {
    const WarpOperator warp = operator_of(all[n]);
    const Samples x = random_samples(warp.source_grid(), 3);
    const Samples y = random_samples(warp.output_grid(), 4);
    const Samples expected = warped_by(Backend::reference, all[n], x);
    const Samples forward = forward_of(warp, x);
    double largest = 1;
    for (const double value : expected) largest = std::max(largest, std::abs(value));
    for (std::size_t v = 0; v < forward.size(); ++v) {
      ASSERT_NEAR(forward[v], expected[v], 0x1p-36 * largest) << "scene " << n << ", voxel " << v;
    }
    EXPECT_NEAR(dot_of(expected, y), dot_of(x, adjoint_of(warp, y)),
                0x1p-36 * largest * length_of(y) * std::sqrt(static_cast<double>(y.size())));
  }
}

TEST(ConservativeOperator, TransposeGivesTheSameProducts) {
  for (const char* name : {"waved", "folded"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 24);
    for (const bool is_masked : {false, true}) {
      const WarpOperator warp = operator_of(
          scene, is_masked ? random_mask(scene.output_grid) : std::vector<std::uint8_t>{});
      const Samples x = random_samples(scene.source_grid, 1, 2);
      const Samples y = random_samples(scene.output_grid, 2, 2);
      const Samples forward = forward_of(warp, x);
      EXPECT_GT(length_of(forward), 1);
      EXPECT_NEAR(dot_of(forward, y), dot_of(x, adjoint_of(warp, y)),
                  1e-14 * length_of(forward) * length_of(y));
    }
  }
}

/// Each voxel of the source gives away the part of it that is within the mesh, here a box.
TEST(ConservativeOperator, ColumnsSumUpToWhatTheMeshCoversAtRest) {
  scenes::Scene scene{"moved",
                      scenes::lattice({2, 2, 2}, {1.25, 0.75, 2}, {6.5, 6, 5.125}),
                      {},
                      scenes::unit_grid(9, 8, 7),
                      scenes::unit_grid(16, 16, 16)};
  scene.deformed = scenes::waved(scenes::shifted(scene.mesh.rest_positions, {4, 4, 4}), 0.7, 5);
  const WarpOperator warp = operator_of(scene);

  const Samples sums =
      adjoint_of(warp, Samples(static_cast<std::size_t>(warp.output_grid().voxel_count()), 1.0));

  const auto covered = [](std::int64_t voxel, double low, double high) {
    const auto center = static_cast<double>(voxel);
    return std::max(0.0, std::min(center + 0.5, high) - std::max(center - 0.5, low));
  };
  const auto& dims = scene.source_grid.dims;
  for (std::size_t s = 0; s < sums.size(); ++s) {
    const auto at = static_cast<std::int64_t>(s);
    const double expected = covered(at % dims[0], 1.25, 6.5) *
                            covered(at / dims[0] % dims[1], 0.75, 6) *
                            covered(at / dims[0] / dims[1], 2, 5.125);
    ASSERT_NEAR(sums[s], expected, 1e-12) << s;
  }
}

TEST(ConservativeOperator, BitsDoNotDependOnThreads) {
  const scenes::Scene scene = scenes::adversarial_scene("rotated", 20);
  const Samples x = random_samples(scene.source_grid, 1), y = random_samples(scene.output_grid, 2);
  const WarpOperator one = operator_of(scene, {}, 1), three = operator_of(scene, {}, 3);

  EXPECT_EQ(forward_of(three, x), forward_of(one, x));
  EXPECT_EQ(adjoint_of(three, y), adjoint_of(one, y));
}

TEST(ConservativeOperator, WhatItHasNotIsNamed) {
  const scenes::Scene scene = scenes::adversarial_scene("aligned", 4);
  std::vector<Point3> deformed = scene.deformed;
  const auto message = [&](Intensity intensity, Outside outside) {
    return message_of([&] {
      WarpOperator(scene.source_grid, scene.mesh, deformed,
                   {.intensity = intensity, .outside = outside});
    });
  };
  EXPECT_NE(message(Intensity::density, Outside::background).find("choose value or conservative"),
            std::string::npos);
  EXPECT_NE(message(Intensity::conservative, Outside::identity).find("outside must be background"),
            std::string::npos);
  deformed.pop_back();
  EXPECT_NE(message(Intensity::conservative, Outside::background).find("nodes as at rest, got"),
            std::string::npos);
  deformed.push_back({NAN, 0, 0});
  EXPECT_NE(message(Intensity::conservative, Outside::background).find("finite"),
            std::string::npos);
  const WarpOperator warp = operator_of(scene);
  const Samples x = random_samples(scene.source_grid, 1), y = random_samples(scene.output_grid, 2);
  EXPECT_NE(message_of([&] { (void)warp.node_gradient(x, y); }).find("have no derivatives"),
            std::string::npos);
}

}  // namespace
}  // namespace tetwarp::test
