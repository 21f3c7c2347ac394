/// @file test_coverage.cpp
/// Every voxel center in the closed mesh has exactly one owner, none outside has one: the lowest
/// tetrahedron, decided exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/support/brute_force.hpp"
#include "tests/support/each_scene.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
constexpr std::int64_t scene_size = 40;

class Coverage : public EachScene<scene_size> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Coverage, ::testing::ValuesIn(all_scene_names()), scene_name);

TEST(AdversarialScenes, HaveTheNamesThatSuitesAreMadeFrom) {
  const std::vector<scenes::Scene> all = scenes::adversarial_scenes(scene_size);

  ASSERT_EQ(all.size(), scenes::adversarial_names.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].name, scenes::adversarial_names[i]) << i;
  }
}

Volume source_of(const scenes::Scene& scene) {
  return scenes::wavy_volume(scene.source_grid, PixelType::uint8);
}

WarpOptions counting_folds() {
  WarpOptions options;
  options.count_folded = true;
  return options;
}

TEST_P(Coverage, OwnersEqualTheReference) {
  const scenes::Scene& scene = this->scene();
  const Volume source = source_of(scene);

  const Warped cpu = run_warp(source, scene, Backend::cpu, counting_folds());
  const Warped reference = run_warp(source, scene, Backend::reference, counting_folds());

  EXPECT_TRUE(cpu.owner == reference.owner);
  EXPECT_TRUE(cpu.mask == reference.mask);
  EXPECT_EQ(cpu.counts.covered, reference.counts.covered);
  EXPECT_EQ(cpu.counts.folded, reference.counts.folded);
  EXPECT_EQ(cpu.counts.inverted, reference.counts.inverted);
  EXPECT_EQ(cpu.counts.flat, reference.counts.flat);
}

/// Half of the voxels anywhere, half of them covered, so that small meshes are tested too.
TEST_P(Coverage, OwnersEqualBruteForceOnRandomVoxels) {
  const scenes::Scene& scene = this->scene();
  const Grid& grid = scene.output_grid;
  const Warped cpu = run_warp(source_of(scene), scene, Backend::cpu);
  const std::vector<TetQuanta> tets = tets_of(grid, scene.mesh, scene.deformed);
  std::vector<std::size_t> covered;
  for (std::size_t v = 0; v < cpu.owner.size(); ++v) {
    if (cpu.owner[v] >= 0) covered.push_back(v);
  }

  for (std::uint64_t sample = 0; sample < 600; ++sample) {
    const double u = scenes::uniform(71, sample);
    const bool anywhere = sample % 2 == 0 || covered.empty();
    const std::size_t count = anywhere ? cpu.owner.size() : covered.size();
    const auto at = static_cast<std::size_t>(u * static_cast<double>(count));
    const std::size_t v = anywhere ? at : covered[at];
    const auto voxel = static_cast<std::int64_t>(v);
    const std::int64_t row = voxel / grid.dims[0];
    const Quanta center =
        voxel_center(voxel % grid.dims[0], row % grid.dims[1], row / grid.dims[1]);
    ASSERT_EQ(cpu.owner[v], owner_of(tets, center)) << "voxel " << v;
  }
}

TEST_P(Coverage, TheCountsAddUp) {
  const scenes::Scene& scene = this->scene();
  const Warped cpu = run_warp(source_of(scene), scene, Backend::cpu);

  const Counts& counts = cpu.counts;
  const auto owned = std::ranges::count_if(cpu.owner, [](std::int32_t t) { return t >= 0; });
  EXPECT_EQ(counts.covered, owned);
  EXPECT_EQ(std::ranges::count(cpu.mask, 1), owned);
  EXPECT_EQ(std::ranges::count(cpu.mask, 0), counts.outside);
  EXPECT_EQ(counts.voxels, counts.covered + counts.outside);
  EXPECT_EQ(counts.voxels, scene.output_grid.voxel_count());
  EXPECT_EQ(counts.tetrahedra, static_cast<std::int64_t>(scene.mesh.tets.size()));
  EXPECT_EQ(counts.candidate_pairs,
            counts.pairs_rejected + counts.pairs_accepted + counts.pairs_partial);
  EXPECT_LE(counts.exact_tests, counts.inside_tests);
}

/// The tetrahedra of these scenes only meet in faces, so coverage cannot depend on their order.
TEST(CoverageOrder, ShufflingTetrahedraNodesAndCornersKeepsCoverage) {
  for (const char* name : {"aligned", "rotated", "slivers_1", "slivers_3", "slivers_5"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, scene_size);
    const Volume source = source_of(scene);
    const auto nodes = scene.deformed.size();
    scenes::Scene shuffled = scene;
    for (std::size_t n = 0; n < nodes; ++n) {
      shuffled.deformed[nodes - 1 - n] = scene.deformed[n];
      shuffled.mesh.rest_positions[nodes - 1 - n] = scene.mesh.rest_positions[n];
    }
    for (auto& tet : shuffled.mesh.tets) {
      for (std::int32_t& node : tet) node = static_cast<std::int32_t>(nodes) - 1 - node;
      std::rotate(tet.begin(), tet.begin() + 1, tet.end());
    }
    std::ranges::reverse(shuffled.mesh.tets);

    const Warped before = run_warp(source, scene, Backend::cpu);
    const Warped after = run_warp(source, shuffled, Backend::cpu);

    EXPECT_TRUE(before.mask == after.mask) << scene.name;
    // On shared faces both maps give the same position up to rounding: a difference of 1 at most.
    EXPECT_TRUE(std::ranges::equal(numbers_of(before.volume), numbers_of(after.volume),
                                   [](double a, double b) { return std::abs(a - b) <= 1; }))
        << scene.name;
  }
}

TEST(CoverageFolds, CellsInsideSeveralTetrahedraGoToTheLowest) {
  const scenes::Scene scene = scenes::adversarial_scene("overlapping", scene_size);
  const std::vector<TetQuanta> tets = tets_of(scene.output_grid, scene.mesh, scene.deformed);

  const Warped cpu = run_warp(source_of(scene), scene, Backend::cpu, counting_folds());

  EXPECT_GT(cpu.counts.pairs_accepted, 0);
  EXPECT_GT(cpu.counts.folded, 1000);
  for (std::size_t v = 0; v < cpu.owner.size(); v += 13) {
    const auto voxel = static_cast<std::int64_t>(v);
    const std::int64_t row = voxel / scene_size;
    const std::int64_t lines = scene.output_grid.dims[1];
    ASSERT_EQ(cpu.owner[v],
              owner_of(tets, voxel_center(voxel % scene_size, row % lines, row / lines)));
  }
}

/// Smallest angle between two faces of a tetrahedron [degree].
double smallest_dihedral_angle(const std::array<Point3, 4>& tet) {
  double smallest = 180;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a + 1; b < 4; ++b) {
      const std::size_t c = a == 0 ? (b == 1 ? 2 : 1) : 0, d = 6 - a - b - c;
      const Point3 edge = minus(tet[b], tet[a]);
      const Point3 p = cross(edge, minus(tet[c], tet[a])), q = cross(edge, minus(tet[d], tet[a]));
      const double angle = std::atan2(norm(cross(p, q)), dot(p, q));
      smallest = std::min(smallest, angle * 180 / 3.14159265358979323846);
    }
  }
  return smallest;
}

TEST(CoverageScenes, HoldSliversThinnerThanATenthOfADegree) {
  double smallest = 180;
  for (const char* name : {"slivers_1", "slivers_3", "slivers_5"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, scene_size);
    for (const auto& nodes : scene.mesh.tets) {
      std::array<Point3, 4> tet;
      for (std::size_t a = 0; a < 4; ++a) {
        tet[a] = scene.deformed[static_cast<std::size_t>(nodes[a])];
      }
      smallest = std::min(smallest, smallest_dihedral_angle(tet));
    }
  }

  EXPECT_LT(smallest, 0.1);
  EXPECT_GT(smallest, 0.0);
}

/// The cubes of owned voxels and the body differ only within h sqrt(3)/2 of its surface, so the
/// volumes differ by less than surface * h * sqrt(3)/2, and a little for edges: first order in h.
TEST(CoverageVolume, ConvergesToTheMeshVolumeAtFirstOrder) {
  const Mesh box = scenes::lattice({2, 2, 2}, {8, 8, 8}, {26, 24, 22});
  const double surface = 2 * (18 * 16 + 16 * 14 + 14 * 18), volume = 18 * 16 * 14;
  for (const auto& deformed :
       {box.rest_positions, scenes::rotated_45_45(box.rest_positions, {17, 16, 15})}) {
    for (const std::int64_t per_unit : {1, 2, 3}) {
      const double h = 1.0 / static_cast<double>(per_unit);
      Grid grid = scenes::unit_grid(34 * per_unit, 32 * per_unit, 30 * per_unit);
      grid.spacing = {h, h, h};
      const scenes::Scene scene = {"box", box, deformed, grid, grid};

      const Warped cpu = run_warp(source_of(scene), scene, Backend::cpu);

      const double owned = static_cast<double>(cpu.counts.covered) * h * h * h;
      EXPECT_NEAR(owned, volume, 0.9 * surface * h) << per_unit;
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
