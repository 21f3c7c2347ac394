/// @file test_warp_hexahedra.cpp
/// Whole warps by hexahedra, and by both kinds of cells, on every back end.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/warp/hex_split.hpp"
#include "tests/support/each_backend.hpp"
#include "tests/support/field_buffers.hpp"
#include "tests/support/hex_scenes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/skip_series.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
class WarpHexahedra : public EachBackend {
 protected:
  Warped run(const Volume& source, const scenes::Scene& scene, const WarpOptions& options = {}) {
    return run_warp(source, scene, GetParam(), options);
  }
};
INSTANTIATE_TEST_SUITE_P(Backends, WarpHexahedra, each_backend, name_of_backend);

constexpr std::int64_t edge = 24;  ///< of the volumes [voxel]

scenes::Scene scene_of(const HexBox& box) {
  const Grid grid = scenes::unit_grid(edge, edge, edge);
  return {"hexahedra", box.mesh, box.deformed, grid, grid};
}

/// Hexahedra that reach half a voxel beyond the grid, bent everywhere.
scenes::Scene bent_scene(double amount, int parts = 1) {
  return scene_of(hex_box({3, 4, 3}, {-0.5, -0.5, -0.5}, {edge - 0.5, edge - 0.5, edge - 0.5},
                          bent(amount), parts));
}

/// The same with every hexahedron's tetrahedra in its place.
scenes::Scene cut(scenes::Scene scene) {
  scene.mesh.tets = split_hexes(scene.mesh.hexes);
  scene.mesh.hexes.clear();
  return scene;
}

/// Replaces all but the last hexahedra of a scene by tetrahedra.
scenes::Scene mixed_scene(double amount) {
  scenes::Scene scene = bent_scene(amount);
  const auto middle = scene.mesh.hexes.begin() + 20;
  scene.mesh.tets = split_hexes(std::vector(scene.mesh.hexes.begin(), middle));
  scene.mesh.hexes.erase(scene.mesh.hexes.begin(), middle);
  return scene;
}

Volume ramp(double x, double y, double z) {
  const Grid grid = scenes::unit_grid(edge, edge, edge);
  Volume volume = make_volume(grid, PixelType::float64);
  const auto samples = volume.samples<double>();
  std::size_t s = 0;
  for (int k = 0; k < edge; ++k) {
    for (int j = 0; j < edge; ++j) {
      for (int i = 0; i < edge; ++i) samples[s++] = x * i + y * j + z * k;
    }
  }
  return volume;
}

/// Slopes of the float64 volume are below 1 per voxel; maps that differ from affine ones by less
/// than four quanta may be taken for them. Found: 1.2e-8 and 3.6e-7.
TEST_P(WarpHexahedra, AreTheReference) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  for (const scenes::Scene& scene : {bent_scene(2.5), mixed_scene(2.5), bent_scene(0.01)}) {
    for (const Filter filter : {Filter::linear, Filter::cubic}) {
      for (const PixelType type : {PixelType::float64, PixelType::float32}) {
        const Volume source = scenes::wavy_volume(scene.source_grid, type, 2);
        const WarpOptions options{.filter = filter};
        const Warped here = run(source, scene, options);
        const Warped judge = run_warp(source, scene, Backend::reference, options);

        EXPECT_TRUE(here.owner == judge.owner);
        EXPECT_LE(largest_difference(here.volume, judge.volume), 1e-5);
        EXPECT_EQ(here.counts.covered, judge.counts.covered);
        EXPECT_EQ(here.counts.inverted, 0);
      }
    }
  }
}

/// Wedges and pyramids are hexahedra with repeated nodes; their parts that are empty own nothing.
/// Found: 3.6e-7.
TEST_P(WarpHexahedra, MayBeWedgesAndPyramids) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  scenes::Scene scene = bent_scene(2.5);
  const std::vector<std::array<std::int32_t, 8>> whole = std::exchange(scene.mesh.hexes, {});
  for (const auto& hex : whole) {
    if (scene.mesh.hexes.size() % 3 == 0) {  // two wedges
      scene.mesh.hexes.push_back({hex[0], hex[1], hex[2], hex[2], hex[4], hex[5], hex[6], hex[6]});
      scene.mesh.hexes.push_back({hex[0], hex[2], hex[3], hex[3], hex[4], hex[6], hex[7], hex[7]});
    } else {  // a pyramid; the rest of the cube is empty
      scene.mesh.hexes.push_back({hex[0], hex[1], hex[2], hex[3], hex[6], hex[6], hex[6], hex[6]});
    }
  }
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  const Warped here = run(source, scene);
  const Warped judge = run_warp(source, scene, Backend::reference);

  EXPECT_TRUE(here.owner == judge.owner);
  EXPECT_LE(largest_difference(here.volume, judge.volume), 1e-5);
  EXPECT_GT(here.counts.covered, edge * edge * edge / 4);
  EXPECT_EQ(here.counts.inverted, 0);
  EXPECT_EQ(here.counts.flat, judge.counts.flat);
}

TEST_P(WarpHexahedra, OwnEveryVoxelBetweenThemOnceAndTellTheCell) {
  HexBox box = hex_box(
      {3, 4, 3}, {-0.5, -0.5, -0.5}, {edge - 0.5, edge - 0.5, edge - 0.5}, [](const Point3& x) {
        const auto inner = [](double c) { return std::sin(3.14159265358979 * (c + 0.5) / edge); };
        const double push = 3 * inner(x[0]) * inner(x[1]) * inner(x[2]);
        return Point3{x[0] + push, x[1] - push, x[2] + push};
      });
  WarpOptions options;
  options.count_folded = true;

  const Warped warped = run(ramp(1, 0, 0), scene_of(box), options);

  EXPECT_EQ(warped.counts.outside, 0);
  EXPECT_EQ(warped.counts.folded, 0);
  EXPECT_EQ(*std::max_element(warped.owner.begin(), warped.owner.end()), 3 * 4 * 3 - 1);
  EXPECT_EQ(*std::min_element(warped.owner.begin(), warped.owner.end()), 0);
}

/// The hexahedron of bent_scene() that contains a tetrahedron of cut(bent_scene(., parts)).
std::int32_t parent_of(std::int32_t tet, int parts) {
  if (tet < 0) return -1;
  const int part = tet / tets_per_hex, row = part / (3 * parts);
  return (row / (4 * parts) / parts * 4 + row % (4 * parts) / parts) * 3 +
         part % (3 * parts) / parts;
}

/// Within a hexahedron the difference falls with the square of the edge of the tetrahedra (found:
/// 0.50, 0.13, 0.034 voxel). Between a curved face and its two triangles a voxel uses the map of
/// the neighboring hexahedron, slightly beyond that (found: 0.09).
TEST_P(WarpHexahedra, AreTheLimitOfEverFinerTetrahedra) {
  std::array<double, 3> error{};
  double beside_faces = 0;
  const scenes::Scene whole = bent_scene(2.5);
  constexpr double beyond = 1e6;  // positions that leave the source get it
  const WarpOptions options{.background = beyond};
  for (const auto& slope : {std::array{1, 0, 0}, std::array{0, 1, 0}, std::array{0, 0, 1}}) {
    const Volume source = ramp(slope[0], slope[1], slope[2]);
    const Warped warped = run(source, whole, options);
    for (std::size_t level = 0; level < error.size(); ++level) {
      const int parts = 1 << level;
      const Warped fine = run(source, cut(bent_scene(2.5, parts)), options);
      for (std::size_t v = 0; v < fine.mask.size(); ++v) {
        const double x = warped.volume.samples<double>()[v], y = fine.volume.samples<double>()[v];
        if (x == beyond || y == beyond) continue;
        const bool is_alike = parent_of(fine.owner[v], parts) == warped.owner[v];
        double& worst = is_alike ? error[level] : beside_faces;
        worst = std::max(worst, std::abs(x - y));
      }
    }
  }
  found("whole", error[0]);
  found("halves", error[1]);
  found("quarters", error[2]);
  found("beside_faces", beside_faces);
  EXPECT_GT(error[0], 0.05);
  EXPECT_LT(error[1], error[0] / 3);
  EXPECT_LT(error[2], error[1] / 3);
  EXPECT_LT(beside_faces, 0.12);
}

TEST_P(WarpHexahedra, CopyWhatMovesByWholeVoxelsAndOnlyThat) {
  scenes::Scene scene = bent_scene(0);
  scene.deformed = scenes::shifted(scene.mesh.rest_positions, {2, -1, 3});
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  const Warped all = run(source, scene);
  EXPECT_TRUE(all.volume.data == run(source, cut(scene)).volume.data);
  if (GetParam() != Backend::reference) {
    EXPECT_EQ(all.counts.voxels_copied, all.counts.covered);
  }

  scene.deformed.back()[0] += 0.5;  // of the last hexahedron, whose other tetrahedra stay

  const Warped most = run(source, scene);
  const Warped judge = run_warp(source, scene, Backend::reference);
  EXPECT_LE(largest_difference(most.volume, judge.volume), 1e-5);
}

/// A map that is affine over a hexahedron is that of each of its tetrahedra, and as quick.
TEST_P(WarpHexahedra, GiveTheBitsOfTetrahedraUnderAffineMaps) {
  if (GetParam() == Backend::reference)
    GTEST_SKIP() << "the reference inverts affine maps like curved ones";
  scenes::Scene scene = bent_scene(0);
  scene.deformed = scenes::rotated_45_45(scene.mesh.rest_positions, {12, 12, 12});
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);

  EXPECT_TRUE(run(source, scene).volume.data == run(source, cut(scene)).volume.data);
}

TEST_P(WarpHexahedra, MoveAsAWholeInUpdates) {
  const scenes::Scene scene = bent_scene(1.5);
  const std::vector sources{scenes::wavy_volume(scene.source_grid, PixelType::int16)};
  WarpOptions options;
  options.backend = GetParam();
  Series series(sources, scene, options);
  std::vector<Point3> deformed = scene.deformed;
  series.step(deformed, false);
  for (std::size_t n = 3; n < deformed.size(); n += 17) {
    deformed[n][n % 3] += 0.75;
    series.step(deformed);
    Series fresh(sources, scene, options);
    fresh.step(deformed, false);
    EXPECT_TRUE(series.has_bits_of(fresh)) << n;
  }
}

/// Fields change within a hexahedron; those of whole steps and of updates are the reference's.
TEST_P(WarpHexahedra, HaveFieldsOfTheTrilinearMap) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  const scenes::Scene scene = mixed_scene(2.5);
  const std::vector sources{scenes::wavy_volume(scene.source_grid, PixelType::uint8)};
  const std::vector<VolumeView> views(sources.begin(), sources.end());
  std::vector<Point3> deformed = scene.deformed;
  const auto step_of = [&](Warper& warper, FieldBuffers& fields, std::vector<std::int32_t>& tet,
                           bool holds_previous) {
    Volume volume = make_volume(scene.output_grid, PixelType::uint8);
    void* const data = volume.data.data();
    warper.step(deformed, {.volumes = {&data, 1},
                           .owner = tet.data(),
                           .fields = fields.target(),
                           .holds_previous = holds_previous});
  };
  const std::vector<std::int32_t> no_owners(
      static_cast<std::size_t>(scene.output_grid.voxel_count()), -99);
  FieldBuffers here(scene.output_grid, true), judge(scene.output_grid, true);
  std::vector<std::int32_t> owners = no_owners, true_owners = no_owners;
  Warper warper(views, scene.mesh, {.backend = GetParam()});
  Warper reference(views, scene.mesh, {.backend = Backend::reference});
  for (const bool is_update : {false, true}) {
    if (is_update) deformed[30][1] += 1.25;
    step_of(warper, here, owners, is_update);
    step_of(reference, judge, true_owners, false);
    EXPECT_TRUE(owners == true_owners);
    for (std::size_t field = 0; field < here.arrays().size(); ++field) {
      double worst = 0;
      for (std::size_t n = 0; n < here.arrays()[field].size(); ++n) {
        worst =
            std::max(worst, double{std::abs(here.arrays()[field][n] - judge.arrays()[field][n])});
      }
      EXPECT_LE(worst, 2e-5) << field;
      found("field" + std::to_string(field), worst);
    }
  }
}

TEST_P(WarpHexahedra, TurnAndAverageAsTheReferenceDoes) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  scenes::Scene scene = mixed_scene(2.5);
  for (Point3& p : scene.deformed) {
    for (double& x : p) x = 0.45 * x + 5;
  }
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float64, 3);
  WarpOptions options{.antialias = true, .quantities = {Quantity::vector}};
  const Warped here = run(source, scene, options);

  EXPECT_LE(
      largest_difference(here.volume, run_warp(source, scene, Backend::reference, options).volume),
      1e-5);
  EXPECT_GT(here.counts.tets_averaged, 0);
}

TEST_P(WarpHexahedra, AreCheckedBeforeUse) {
  scenes::Scene scene = bent_scene(0);
  scene.mesh.hexes[5][7] = 1000;

  EXPECT_EQ(message_of([&] { run(ramp(1, 0, 0), scene); }),
            "mesh: hexahedron 5 refers to node 1000, expected 0 to 79");
}
}  // namespace
}  // namespace tetwarp::test
