/// @file test_warp_outside.cpp
/// Voxels outside of the mesh that move with its nearest point, on every back end.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/warp/outside_surface.hpp"
#include "kernels/warp/surface_near.hpp"
#include "kernels/warp/surface_tree.hpp"
#include "tests/support/each_backend.hpp"
#include "tests/support/hex_scenes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
/// A step with its displacement.
struct Extended {
  Warped warped;
  std::vector<float> displacement;
};

Extended extended(const Volume& source,
                  const scenes::Scene& scene,
                  Backend backend,
                  WarpOptions options) {
  options.backend = backend;
  options.output_grid = scene.output_grid;
  Warper warper(source, scene.mesh, options);
  Extended result;
  result.warped.volume = make_volume(warper.output_grid(), source.type, source.components);
  const auto voxels = static_cast<std::size_t>(warper.output_grid().voxel_count());
  result.warped.owner.assign(voxels, -99);
  result.displacement.assign(3 * voxels, -77.0F);
  void* const data = result.warped.volume.data.data();
  warper.step(scene.deformed, {.volumes = {&data, 1},
                               .owner = result.warped.owner.data(),
                               .fields = {.displacement = result.displacement.data()}});
  return result;
}

/// One tetrahedron of right angles at (8, 8, 8) with edges of 6, moved by `shift`.
scenes::Scene corner_scene(const Point3& shift) {
  scenes::Scene scene;
  scene.mesh.rest_positions = {{8, 8, 8}, {14, 8, 8}, {8, 14, 8}, {8, 8, 14}};
  scene.mesh.tets = {{0, 1, 2, 3}};
  scene.deformed = scenes::shifted(scene.mesh.rest_positions, shift);
  scene.source_grid = scene.output_grid = scenes::unit_grid(24, 24, 24);
  return scene;
}

class WarpOutside : public EachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, WarpOutside, each_backend, name_of_backend);

TEST_P(WarpOutside, ATranslatedMeshTranslatesEverything) {
  const scenes::Scene scene = corner_scene({2, -1, 0.5});
  const Volume source = scenes::ramp_volume(scene.source_grid, {5, 1, 100, 10});

  const Extended all =
      extended(source, scene, GetParam(), {.outside = Outside::nearest, .background = -1});

  for (std::size_t v = 0; v < all.warped.owner.size(); ++v) {
    ASSERT_EQ(all.displacement[3 * v], -2);
    ASSERT_EQ(all.displacement[3 * v + 1], 1);
    ASSERT_EQ(all.displacement[3 * v + 2], -0.5);
    const auto n = static_cast<std::int64_t>(v);
    const double i = static_cast<double>(n % 24) - 2, j = static_cast<double>(n / 24 % 24) + 1,
                 k = static_cast<double>(n / 576) - 0.5;
    const bool is_inside = i >= -0.5 && j <= 23.5 && k >= -0.5;
    const double near = std::clamp(i, 0.0, 23.0) + 100 * std::clamp(j, 0.0, 23.0) +
                        10 * std::clamp(k, 0.0, 23.0) + 5;
    ASSERT_NEAR(all.warped.volume.samples<float>()[v], is_inside ? near : -1, 1e-3) << v;
  }
}

/// Below the face z = 8 of the corner the distance is 8 - k.
TEST_P(WarpOutside, FalloffIsTheSmoothStepOfTheDistance) {
  const scenes::Scene scene = corner_scene({1, 0, 0});
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);

  const Extended falling =
      extended(source, scene, GetParam(), {.outside = Outside::falloff, .falloff = 5});
  const Extended still = extended(source, scene, GetParam(), {.outside = Outside::identity});

  for (std::int64_t k = 0; k < 8; ++k) {
    const auto v = static_cast<std::size_t>(k * 576 + 10 * 24 + 10);
    const double t = static_cast<double>(8 - k) / 5;
    const double weight = t < 1 ? 1 - t * t * (3 - 2 * t) : 0;
    EXPECT_NEAR(falling.displacement[3 * v], -weight, 1e-7);
    if (t < 1) continue;
    EXPECT_EQ(falling.warped.volume.samples<float>()[v], still.warped.volume.samples<float>()[v]);
  }
}

/// On the node whose three faces see no voxel of their own beyond it.
TEST_P(WarpOutside, BeyondANodeItsDisplacementCounts) {
  scenes::Scene scene = corner_scene({0, 0, 0});
  scene.deformed[1] = {15, 8.5, 8};  // the others stay
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::uint8);

  const Extended all = extended(source, scene, GetParam(), {.outside = Outside::nearest});

  const std::size_t v = 8 * 576 + 9 * 24 + 22;
  EXPECT_NEAR(all.displacement[3 * v], -1, 1e-6);
  EXPECT_NEAR(all.displacement[3 * v + 1], -0.5, 1e-6);
  EXPECT_NEAR(all.displacement[3 * v + 2], 0, 1e-6);
}

TEST_P(WarpOutside, CoveredVoxelsHaveTheBitsOfAnyOtherChoice) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 20);
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::int16);

  const Extended all = extended(source, scene, GetParam(), {.outside = Outside::nearest});
  const Extended none = extended(source, scene, GetParam(), {});

  for (std::size_t v = 0; v < all.warped.owner.size(); ++v) {
    ASSERT_EQ(all.warped.owner[v], none.warped.owner[v]);
    if (all.warped.owner[v] < 0) continue;
    ASSERT_EQ(all.warped.volume.samples<std::int16_t>()[v],
              none.warped.volume.samples<std::int16_t>()[v]);
  }
}

TEST_P(WarpOutside, ChangesThatItDoesNotDefineAreRefused) {
  const scenes::Scene scene = corner_scene({1, 0, 0});
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32, 3);
  const auto message = [&](WarpOptions options) {
    options.backend = GetParam();
    return message_of<std::invalid_argument>([&] { Warper(source, scene.mesh, options); });
  };

  EXPECT_EQ(message({.outside = Outside::falloff}), "falloff: expected a finite distance above 0");
  EXPECT_EQ(message({.intensity = Intensity::density, .outside = Outside::nearest}),
            "outside: nearest is for values, not for densities; use background or identity");
  EXPECT_EQ(message({.quantities = {Quantity::vector}, .outside = Outside::nearest}),
            "outside: nearest turns no vectors and tensors; use background or identity");
  EXPECT_EQ(message({.outside = Outside::nearest,
                     .source_window = SourceWindow{{{0, 0, 0}, {4, 4, 4}}, {}}}),
            "source window: outside nearest takes displacements from the whole mesh; use "
            "background or identity");
}

/// Points that are equally near two parts of the surface may take either: those voxels are few.
void expect_reference(const scenes::Scene& scene, Backend backend, const WarpOptions& options) {
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float64);
  const Extended mine = extended(source, scene, backend, options);
  const Extended truth = extended(source, scene, Backend::reference, options);
  std::size_t outside = 0, others = 0;
  for (std::size_t v = 0; v < mine.warped.owner.size(); ++v) {
    if (mine.warped.owner[v] >= 0) continue;
    ++outside;
    double apart = 0;
    for (std::size_t n = 3 * v; n < 3 * v + 3; ++n) {
      apart = std::max<double>(apart, std::abs(mine.displacement[n] - truth.displacement[n]));
    }
    const double change = std::abs(mine.warped.volume.samples<double>()[v] -
                                   truth.warped.volume.samples<double>()[v]);
    others += apart > 1e-5 || change > 1e-9;
  }
  EXPECT_GT(outside, 100U) << scene.name;
  EXPECT_LE(others, outside / 200) << scene.name;
}

TEST_P(WarpOutside, AgreesWithAllTrianglesOfTheReference) {
  for (const char* name : {"waved", "rotated", "oblique", "other_grid", "slivers_1"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 10);
    const double distance = 3 * scene.output_grid.spacing[0];
    expect_reference(scene, GetParam(), {.outside = Outside::nearest});
    expect_reference(scene, GetParam(), {.outside = Outside::falloff, .falloff = distance});
  }
  const HexBox box = hex_box({2, 2, 2}, {4, 4, 4}, {9, 10, 9}, bent(0.8));
  const Grid grid = scenes::unit_grid(14, 14, 14);
  expect_reference({"hexahedra", box.mesh, box.deformed, grid, grid}, GetParam(),
                   {.outside = Outside::nearest});
}

TEST(WarpOutsideCpu, RegionsThreadsAndStepsBeforeDoNotChangeBits) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  WarpOptions options{.outside = Outside::falloff, .falloff = 4, .backend = Backend::cpu};
  options.output_grid = scene.output_grid;
  Warper whole(source, scene.mesh, options);
  const Warped all = run_step(whole, source, scene.deformed);
  for (const int threads : {1, 3}) {
    WarpOptions part = options;
    part.threads = threads;
    part.region = Region{{5, 3, 9}, {19, 20, 21}};
    Warper warper(source, scene.mesh, part);
    const auto& [begin, end] = *part.region;
    for (const auto& step : {scenes::shifted(scene.deformed, {1, 0, 0}), scene.deformed}) {
      const Warped some = run_step(warper, source, step);
      if (step != scene.deformed) continue;
      std::size_t n = 0;
      for (std::int64_t k = begin[2]; k < end[2]; ++k) {
        for (std::int64_t j = begin[1]; j < end[1]; ++j) {
          for (std::int64_t i = begin[0]; i < end[0]; ++i, ++n) {
            const auto& d = scene.output_grid.dims;
            const auto v = static_cast<std::size_t>((k * d[1] + j) * d[0] + i);
            ASSERT_EQ(some.volume.samples<float>()[n], all.volume.samples<float>()[v]);
          }
        }
      }
    }
  }
}

enum class Triangles { apart, joined, thin };

/// Triangles within a cube with an edge of 10 or a little beyond it, in a tree.
struct Soup {
  std::vector<SurfaceNode> nodes;
  std::vector<std::int32_t> triangles;
  std::vector<SurfaceBox> boxes;

  /// Apart of each other, in strips that share nodes and cross, or with corners on a line.
  Soup(Triangles kind, int count) : nodes(static_cast<std::size_t>(3 * count)) {
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const std::size_t corner = n % 3;
      const bool is_joined = kind == Triangles::joined;
      triangles.push_back(static_cast<std::int32_t>(is_joined ? n / 3 % 40 + corner : n));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::uint64_t>(3 * (n / 3) + axis);
        const auto own = static_cast<std::uint64_t>(3 * n + axis);
        nodes[n].at[axis] = 10 * scenes::uniform(1, at) + scenes::uniform(2, own);
        nodes[n].to_rest[axis] = scenes::uniform(3, own);
      }
      if (kind != Triangles::thin || corner != 2) continue;
      const double share = n % 2 == 0 ? 0.3 : 1, off = n % 4 == 0 ? 0 : 1e-6;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double from = nodes[n - 2].at[axis], to = nodes[n - 1].at[axis];
        nodes[n].at[axis] = from + share * (to - from) + off * (axis == 0);
      }
    }
    std::int64_t leaves = 1;
    while (4 * leaves < count) leaves *= 2;
    boxes.resize(static_cast<std::size_t>(2 * leaves));
    for (std::int64_t first = leaves; first > 0; first /= 2) {
      const SurfaceBoxOp body{tree(), {boxes.data(), std::ssize(boxes)}, first};
      for (std::int64_t n = 0; n < first; ++n) body(n);
    }
  }

  SurfaceTree tree() const {
    return {{nodes.data(), std::ssize(nodes)},
            {triangles.data(), std::ssize(triangles)},
            {boxes.data(), std::ssize(boxes)}};
  }
};

/// A point of the cube from -2 to 12.
std::array<double, 3> place(std::uint64_t seed, std::uint64_t number) {
  std::array<double, 3> at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = 14 * scenes::uniform(seed, 3 * number + axis) - 2;
  }
  return at;
}

void expect_same(const NearestSurfacePoint& one, const NearestSurfacePoint& other) {
  EXPECT_EQ(one.triangle, other.triangle);
  EXPECT_EQ(one.distance2, other.distance2);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(one.to_rest[axis], other.to_rest[axis]);
}

constexpr double everywhere = std::numeric_limits<double>::infinity();

/// Soups of every size around the leaves of a tree, searched from anywhere.
TEST(SurfaceTree, FindsTheNearestOfAllTriangles) {
  for (const int count : {1, 2, 4, 5, 31, 32, 33, 1025}) {
    const Soup soup(Triangles::apart, count);
    const SurfaceTree tree = soup.tree();
    for (std::uint64_t p = 0; p < 50; ++p) {
      const auto x = place(4, p);
      NearestSurfacePoint every{everywhere, -1, {}}, found = every;
      for (std::int64_t t = 0; t < count; ++t) take_triangle(tree, t, x.data(), every);
      find_nearest(tree, x.data(), found);

      expect_same(found, every);
    }
  }
}

/// Rows through balls of any size, near and far, also where more triangles are near than are kept.
TEST(SurfaceNear, HasTheBitsOfTheTreeForAllPositionsOfABall) {
  constexpr double half = 0.5 * (SurfaceNear::lanes - 1);
  std::int64_t far = 0, found = 0;
  for (const Triangles kind : {Triangles::apart, Triangles::joined, Triangles::thin}) {
    for (const int count : {1, 5, 33, 1025}) {
      const Soup soup(kind, count);
      const SurfaceTree tree = soup.tree();
      for (std::uint64_t p = 0; p < 60; ++p) {
        const auto center = place(5, p), toward = place(6, p);
        const double radius = p % 6 == 0 ? 0 : std::pow(10, 3 * scenes::uniform(7, p) - 2);
        const double reach = p % 2 == 0 ? everywhere : 1.5;
        const double length = std::hypot(toward[0], toward[1], toward[2]);
        std::array<double, 3> first{}, step{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          step[axis] = radius / half * toward[axis] / length;
          first[axis] = center[axis] - half * step[axis];
        }
        SurfaceNear near(tree, center.data(), radius, reach);
        if (!near.is_far()) near.begin_row(first.data(), step.data());
        for (int lane = 0; lane < SurfaceNear::lanes; ++lane) {
          std::array<double, 3> x = first;
          for (std::size_t axis = 0; axis < 3; ++axis) x[axis] += lane * step[axis];
          NearestSurfacePoint plain{reach * reach, -1, {}}, mine = plain;
          find_nearest(tree, x.data(), plain);
          if (!near.is_far()) near.find(lane, x.data(), mine);

          expect_same(mine, plain);
          ++(near.is_far() ? far : found);
        }
      }
    }
  }
  EXPECT_GT(far, 100);
  EXPECT_GT(found, 1500);
}

TEST(OutsideSurface, HoldsTheTrianglesOfOneTetrahedronAlone) {
  Mesh mesh;
  mesh.rest_positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}, {3, 2, 1, 0}};  // the last one is the first again

  const OutsideSurface surface = make_outside_surface(mesh);

  EXPECT_EQ(surface.triangles.size(), 6U);
  EXPECT_EQ(surface.nodes.size(), 5U);
  EXPECT_EQ(surface.leaves, 2);
}
}  // namespace
}  // namespace tetwarp::test
