/// @file test_warp_operator.cpp
/// The warp as a matrix: equal to the matrix whose columns the reference warps, transposed exactly,
/// with equal bits for any number of threads; its gradient by nodes against differences of the
/// reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/warp_operator.hpp>

#include "tests/support/hex_scenes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/operator_samples.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
constexpr Filter linear_filters[] = {Filter::nearest, Filter::linear, Filter::cubic,
                                     Filter::bspline, Filter::lanczos};

WarpOptions reference_options(const WarpOperatorOptions& options) {
  WarpOptions all{.filter = options.filter};
  all.outside = options.outside;
  all.output_grid = options.output_grid;
  all.backend = Backend::reference;
  return all;
}

/// Warps of several arrays of samples by the reference.
std::vector<Samples> reference_warps(const Grid& grid,
                                     const std::vector<Samples>& sources,
                                     const Mesh& mesh,
                                     const std::vector<Point3>& deformed,
                                     const WarpOperatorOptions& options) {
  std::vector<VolumeView> views;
  for (const Samples& source : sources) {
    views.emplace_back(grid, PixelType::float64, 1, source.data(), Memory::host);
  }
  Warper warper(views, mesh, reference_options(options));
  std::vector<Samples> warped(
      sources.size(), Samples(static_cast<std::size_t>(warper.output_grid().voxel_count())));
  std::vector<void*> outputs;
  for (Samples& samples : warped) outputs.push_back(samples.data());
  warper.step(deformed, {.volumes = outputs});
  return warped;
}

/// Column by column: the warps of volumes with one sample of 1.
std::vector<Samples> columns_of(const Grid& grid,
                                const Mesh& mesh,
                                const std::vector<Point3>& deformed,
                                const WarpOperatorOptions& options) {
  const auto count = static_cast<std::size_t>(grid.voxel_count());
  std::vector<Samples> units(count, Samples(count, 0.0));
  for (std::size_t s = 0; s < count; ++s) units[s][s] = 1;
  return reference_warps(grid, units, mesh, deformed, options);
}

/// Compares an operator with the matrix of the reference.
void expect_matrix(const Grid& grid,
                   const Mesh& mesh,
                   const std::vector<Point3>& deformed,
                   const WarpOperatorOptions& options,
                   double bound) {
  const std::vector<Samples> columns = columns_of(grid, mesh, deformed, options);
  const WarpOperator warp(grid, mesh, deformed, options);
  const Samples x = random_samples(grid, 3), y = random_samples(warp.output_grid(), 4);
  Samples expected(y.size(), 0.0);
  for (std::size_t s = 0; s < x.size(); ++s) {
    for (std::size_t v = 0; v < y.size(); ++v) expected[v] += x[s] * columns[s][v];
  }
  const Samples forward = forward_of(warp, x), adjoint = adjoint_of(warp, y);
  for (std::size_t v = 0; v < y.size(); ++v) ASSERT_NEAR(forward[v], expected[v], bound) << v;
  for (std::size_t s = 0; s < x.size(); ++s) {
    ASSERT_NEAR(adjoint[s], dot_of(columns[s], y), bound) << s;
  }
}

struct OperatorCase {
  Grid grid;
  Mesh mesh;
  std::vector<Point3> deformed;
};

/// Tetrahedra or hexahedra that cover a grid of n voxels and a half, with nodes and their moves on
/// multiples of 2^-10 voxel, which rounding keeps.
OperatorCase covering_case(std::int64_t n, bool of_hexes) {
  const double far = static_cast<double>(n) + 3;
  OperatorCase result{scenes::unit_grid(n, n, n), {}, {}};
  const auto keep = [](std::vector<Point3> points) {
    for (Point3& x : points) {
      for (double& at : x) at = std::round(at * 1024) / 1024;
    }
    return points;
  };
  if (of_hexes) {
    HexBox box = hex_box({2, 2, 2}, {-4, -4, -4}, {far, far, far}, bent(0.7));
    result.mesh = box.mesh;
    result.deformed = keep(box.deformed);
  } else {
    result.mesh = scenes::lattice({2, 2, 2}, {-4, -4, -4}, {far, far, far});
    result.deformed = keep(scenes::waved(result.mesh.rest_positions, 0.7, 5));
  }
  result.mesh.rest_positions = keep(result.mesh.rest_positions);
  return result;
}

TEST(WarpOperator, IsTheMatrixOfTheReference) {
  for (const char* name : {"waved", "rotated", "oblique", "other_grid", "folded", "aligned"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 6);
    for (const Filter filter : linear_filters) {
      SCOPED_TRACE(std::string(name) + ", filter " + std::to_string(static_cast<int>(filter)));
      WarpOperatorOptions options{.filter = filter, .output_grid = scene.output_grid};
      expect_matrix(scene.source_grid, scene.mesh, scene.deformed, options, 1e-12);
    }
  }
}

TEST(WarpOperator, IsTheMatrixOfTheReferenceInHexahedraAndOutsideOfTheMesh) {
  HexBox box = hex_box({2, 1, 2}, {0.5, 0.5, 0.5}, {4.5, 5.5, 4.5}, bent(0.6));
  for (const Filter filter : {Filter::linear, Filter::bspline}) {
    WarpOperatorOptions options{.filter = filter, .outside = Outside::identity};
    // Positions are found to 2^-32 voxel, and samples of random sources change by at most 3 a
    // voxel.
    expect_matrix(scenes::unit_grid(6, 7, 6), box.mesh, box.deformed, options, 0x3p-32);
  }
}

TEST(WarpOperator, TransposeGivesTheSameProducts) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  for (const Filter filter : linear_filters) {
    for (const bool masked : {false, true}) {
      WarpOperatorOptions options{.filter = filter, .output_grid = scene.output_grid, .threads = 2};
      for (std::int64_t v = 0; masked && v < scene.output_grid.voxel_count(); ++v) {
        options.mask.push_back(scenes::uniform(9, static_cast<std::uint64_t>(v)) < 0.5);
      }
      const WarpOperator warp(scene.source_grid, scene.mesh, scene.deformed, options);
      const Samples x = random_samples(scene.source_grid, 1, 2);
      const Samples y = random_samples(scene.output_grid, 2, 2);
      const Samples forward = forward_of(warp, x), adjoint = adjoint_of(warp, y);
      EXPECT_GT(length_of(forward), 1);
      EXPECT_NEAR(dot_of(forward, y), dot_of(x, adjoint),
                  1e-14 * length_of(forward) * length_of(y));
      const std::vector<std::uint8_t> support = warp.support();
      for (std::size_t v = 0; v < support.size(); ++v) {
        if (support[v] == 0) {
          ASSERT_EQ(forward[2 * v], 0) << v;
        }
        if (masked && options.mask[v] == 0) {
          ASSERT_EQ(support[v], 0) << v;
        }
      }
    }
  }
}

TEST(WarpOperator, BitsDoNotDependOnThreads) {
  const scenes::Scene scene = scenes::adversarial_scene("rotated", 20);
  const Samples x = random_samples(scene.source_grid, 1), y = random_samples(scene.output_grid, 2);
  Samples forward, adjoint;
  std::vector<Point3> gradient;
  for (const int threads : {1, 2, 3, 7}) {
    const WarpOperatorOptions options{
        .filter = Filter::bspline, .output_grid = scene.output_grid, .threads = threads};
    const WarpOperator warp(scene.source_grid, scene.mesh, scene.deformed, options);
    if (threads == 1) {
      forward = forward_of(warp, x);
      adjoint = adjoint_of(warp, y);
      gradient = warp.node_gradient(x, y);
    }
    EXPECT_EQ(forward_of(warp, x), forward) << threads;
    EXPECT_EQ(adjoint_of(warp, y), adjoint) << threads;
    EXPECT_EQ(warp.node_gradient(x, y), gradient) << threads;
  }
}

TEST(WarpOperator, GradientByNodesIsThatOfTheReference) {
  for (const bool of_hexes : {false, true}) {
    const OperatorCase at = covering_case(7, of_hexes);
    const Samples x = random_samples(at.grid, 1), y = random_samples(at.grid, 2);
    for (const Filter filter : {Filter::linear, Filter::cubic, Filter::bspline, Filter::lanczos}) {
      const WarpOperatorOptions options{.filter = filter};
      const WarpOperator warp(at.grid, at.mesh, at.deformed, options);
      const std::vector<Point3> gradient = warp.node_gradient(x, y);
      const auto value = [&](const std::vector<Point3>& deformed) {
        return dot_of(reference_warps(at.grid, {x}, at.mesh, deformed, options)[0], y);
      };
      for (std::uint64_t direction = 0; direction < 6; ++direction) {
        // Steps that rounding keeps and in which few positions meet a kink of linear interpolation.
        constexpr double step = 0x1p-20;
        std::vector<Point3> before = at.deformed, after = at.deformed;
        double expected = 0, size = 0;
        for (std::size_t n = 0; n < before.size(); ++n) {
          if (direction >= 3 && n != (direction * 5) % before.size()) continue;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const double move = step * std::round(8 * scenes::uniform(direction, 3 * n + axis) - 4);
            before[n][axis] -= move;
            after[n][axis] += move;
            expected += gradient[n][axis] * 2 * move;
            size = std::max(size, std::abs(gradient[n][axis] * move));
          }
        }
        EXPECT_NEAR(value(after) - value(before), expected, 2e-5 * size)
            << "hexahedra: " << of_hexes << ", filter " << static_cast<int>(filter)
            << ", direction " << direction;
      }
    }
  }
}

TEST(WarpOperator, GradientAtVoxelCentersIsTheMeanOfBothSides) {
  OperatorCase at = covering_case(6, false);
  at.deformed = at.mesh.rest_positions;
  const Samples x = random_samples(at.grid, 1), y = random_samples(at.grid, 2);
  const std::vector<Point3> gradient =
      WarpOperator(at.grid, at.mesh, at.deformed).node_gradient(x, y);
  const std::size_t node = 13;  // the middle one
  for (std::size_t axis = 0; axis < 3; ++axis) {
    constexpr double step = 0x1p-16;
    std::vector<Point3> before = at.deformed, after = at.deformed;
    before[node][axis] -= step;
    after[node][axis] += step;
    const double change = dot_of(reference_warps(at.grid, {x}, at.mesh, after, {})[0], y) -
                          dot_of(reference_warps(at.grid, {x}, at.mesh, before, {})[0], y);
    EXPECT_NEAR(change / (2 * step), gradient[node][axis], 1e-3 * std::abs(gradient[node][axis]));
  }
}

TEST(WarpOperator, GradientOfWorldPositionsOnAnObliqueGrid) {
  const scenes::Scene scene = scenes::adversarial_scene("oblique", 8);
  // For a source that is linear in the world, a motion of all nodes by v changes every sample of a
  // covered voxel by minus its slope along v.
  const Point3 slope{0.3, -0.2, 0.5};
  Samples x;
  const auto& dims = scene.source_grid.dims;
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i) {
        const Point3 world = scene.source_grid.world_of(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        x.push_back(slope[0] * world[0] + slope[1] * world[1] + slope[2] * world[2]);
      }
    }
  }
  const std::vector<Point3> deformed =
      scenes::shifted(scene.mesh.rest_positions, {0.25, 0.125, -0.25});
  WarpOperatorOptions options{.output_grid = scene.output_grid};
  // Only voxels that read the inside of the source, where interpolation is linear.
  const Grid& grid = scene.output_grid;
  const WarpOperator all(scene.source_grid, scene.mesh, deformed, options);
  const Samples values = forward_of(all, x);
  const std::vector<std::uint8_t> support = all.support();
  double count = 0;
  for (std::size_t v = 0; v < values.size(); ++v) {
    const auto at = static_cast<std::int64_t>(v);
    const Point3 world = grid.world_of({static_cast<double>(at % grid.dims[0]),
                                        static_cast<double>(at / grid.dims[0] % grid.dims[1]),
                                        static_cast<double>(at / grid.dims[0] / grid.dims[1])});
    const double expected =
        slope[0] * (world[0] - 0.25) + slope[1] * (world[1] - 0.125) + slope[2] * (world[2] + 0.25);
    const bool inside = support[v] != 0 && std::abs(values[v] - expected) < 1e-4;
    options.mask.push_back(inside);
    count += inside;
  }
  ASSERT_GT(count, 20);
  const WarpOperator inner(scene.source_grid, scene.mesh, deformed, options);
  Point3 sum{0, 0, 0};
  for (const Point3& part : inner.node_gradient(x, Samples(values.size(), 1.0))) {
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += part[axis];
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sum[axis], -count * slope[axis], 1e-4 * count);
  }
}

TEST(WarpOperator, BadArgumentsAreNamed) {
  const OperatorCase at = covering_case(3, false);
  const auto made_with = [&](const WarpOperatorOptions& options) {
    return message_of([&] { WarpOperator(at.grid, at.mesh, at.deformed, options); });
  };
  EXPECT_NE(made_with({.filter = Filter::labels}).find("filter: labels"), std::string::npos);
  EXPECT_NE(made_with({.outside = Outside::nearest}).find("choose background or identity"),
            std::string::npos);
  EXPECT_NE(made_with({.mask = {1, 1}}).find("mask: expected one number for each of 27 voxels"),
            std::string::npos);
  const WarpOperator warp(at.grid, at.mesh, at.deformed, {.filter = Filter::nearest});
  Samples x(27, 1.0), y(54, 1.0);
  EXPECT_NE(message_of([&] { warp.forward(x, y); }).find("y: expected 1 components"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              warp.adjoint(std::span(y).first(28), x);
            }).find("y: expected a multiple of 27 samples, got 28"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              (void)warp.node_gradient(x, std::span(y).first(27));
            }).find("node_gradient: filter nearest"),
            std::string::npos);
}

}  // namespace
}  // namespace tetwarp::test
