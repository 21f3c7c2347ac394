/// @file test_warp_intensity.cpp
/// Densities, and preserved totals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tetwarp/make.hpp>
#include <vector>

#include "tests/support/affine_scenes.hpp"
#include "tests/support/intensity_run.hpp"
#include "tests/support/skip_series.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
using Matrix = Eigen::Matrix3d;

/// A column of voxels through a volume of several batches.
TEST(WarpIntensity, ReportsItsProgressWhereTotalsAreKept) {
  Grid grid;
  grid.dims = {96, 96, 96};
  const Volume source = make_volume(grid, PixelType::float32);
  grid.dims = {12, 12, 96};
  const Mesh mesh =
      make_lattice_mesh(make_volume(grid, PixelType::float32), {.cells = 8, .threshold = {}});
  Warper warper(source, mesh, {.intensity = Intensity::conservative, .backend = Backend::cpu});
  std::vector<double> fractions;

  run_step(warper, source, mesh.rest_positions, [&](double fraction) {
    fractions.push_back(fraction);
    return true;
  });

  const auto is_between = [](double fraction) { return fraction > 0.05 && fraction < 0.95; };
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.back(), 1);
  EXPECT_GE(std::ranges::count_if(fractions, is_between), 5);
}

/// Turned, shrunk, stretched and waved meshes, one of them folded over itself, in outputs that hold
/// all of them: with voxels of another shape, and mirrored.
std::vector<scenes::Scene> whole_scenes() {
  const Grid source = scenes::oblique_grid(9, 8, 7);
  Grid output = scenes::unit_grid(26, 22, 24);
  output.spacing = {0.9, 1.1, 1.3};
  output.direction = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  const Point3 center = center_of(source);
  output.origin = {center[0] + 12, center[1] - 11, center[2] - 14};
  std::vector<scenes::Scene> scenes;
  for (const Matrix& linear :
       {Matrix(turn(0.4, {1, 2, -1}) * 0.35), Matrix(turn(1.1, {1, 0, 1}) * 1.2),
        Matrix(Eigen::Vector3d(1.2, -0.7, 0.9).asDiagonal())}) {
    scenes.push_back(affine_scene(source, output, linear));
    scenes.back().deformed = scenes::waved(scenes.back().deformed, 1.0, 91);
  }
  for (Point3& p : scenes[1].deformed) p[0] = center[0] + std::abs(p[0] - center[0]);
  return scenes;
}

/// Totals of float64 sums: every piece costs some roundings of its own size, and they do not add
/// up. The reference finds the same pieces by other means.
TEST(WarpIntensity, KeepsTheTotalAndIsTheReference) {
  for (const scenes::Scene& scene : whole_scenes()) {
    const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float64, 2);
    const Step expected = run(source, scene, Backend::reference, Intensity::conservative);
    for (const Backend backend : usable_backends()) {
      SCOPED_TRACE(name_of(backend));
      const bool is_judge = backend == Backend::reference;
      const Step step = is_judge ? expected : run(source, scene, backend, Intensity::conservative);
      EXPECT_LE(largest_difference(step.volume, expected.volume), 1e-12);
      ASSERT_EQ(step.report.totals.before.size(), 2u);
      ASSERT_EQ(step.report.totals.after.size(), 2u);
      for (std::size_t c = 0; c < 2; ++c) {
        const double before = step.report.totals.before[c];
        EXPECT_NEAR(before / expected.report.totals.before[c], 1, 1e-13);
        EXPECT_GT(before, 100);
        EXPECT_LE(std::abs(step.report.totals.after[c] / before - 1), 1e-12);
      }
    }
  }
}

/// Meshes that fold, overlap, have flat, tiny and inverted tetrahedra, planes in the planes between
/// voxels and nearly there. Sums of the reference's pieces cost a rounding each.
TEST(WarpIntensity, IsTheReferenceForBadMeshes) {
  for (const char* const name : {"aligned", "half_voxel", "slivers_3", "thin_aligned_5", "soup",
                                 "overlapping", "folded", "flat", "outside"}) {
    SCOPED_TRACE(name);
    const scenes::Scene scene = scenes::adversarial_scene(name, 8);
    const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float64);
    const Step expected = run(source, scene, Backend::reference, Intensity::conservative);
    const Step step = run(source, scene, Backend::cpu, Intensity::conservative);
    const auto samples = source.samples<double>();
    const double bound = 1e-12 * std::abs(*std::ranges::max_element(
                                     samples, {}, [](double x) { return std::abs(x); }));
    EXPECT_LE(largest_difference(step.volume, expected.volume), bound);
  }
}

/// Up to 343 voxels of the source go into one, of samples that vary or are all the same.
TEST(WarpIntensity, KeepsTheTotalOfShrunkAndConstantSources) {
  const Grid grid = scenes::unit_grid(28, 28, 28);
  for (const double scale : {1.0 / 7, 1.0 / 3, 0.5}) {
    const scenes::Scene scene = affine_scene(grid, grid, turn(0.3, {1, 1, 2}) * scale);
    Volume source = scenes::wavy_volume(grid, PixelType::float64);
    for (const bool is_constant : {false, true}) {
      if (is_constant) std::ranges::fill(source.samples<double>(), 3.5);
      const StepReport report = run(source, scene, Backend::cpu, Intensity::conservative).report;
      EXPECT_NEAR(report.totals.after[0] / report.totals.before[0], 1, 1e-12) << scale;
    }
  }
}

/// A corner of a box with edges of six voxels, and another one from the far end of the source.
scenes::Scene far_corners(std::int64_t size) {
  scenes::Scene scene;
  scene.source_grid = scenes::unit_grid(size, size, size);
  scene.output_grid = scenes::unit_grid(size, 16, 16);
  const double end = static_cast<double>(size) - 2.3;
  scene.mesh.rest_positions = {{2.3, 2.1, 2.2},     {8.3, 2.1, 2.2},    {2.3, 8.1, 2.2},
                               {2.3, 2.1, 8.2},     {end, end, end},    {end, end - 6, end},
                               {end - 6, end, end}, {end, end, end - 6}};
  scene.mesh.tets = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  scene.deformed = scene.mesh.rest_positions;
  return scene;
}

/// Of the source between the two bodies of a voxel nothing is looked at.
TEST(WarpIntensity, BodiesThatWereFarApartMayOverlap) {
  scenes::Scene scene = far_corners(60);
  for (std::size_t n = 4; n < 8; ++n) {
    for (int axis = 0; axis < 3; ++axis) scene.deformed[n][axis] -= 48.6;
  }
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float64);
  const Step expected = run(source, scene, Backend::reference, Intensity::conservative);
  const Step step = run(source, scene, Backend::cpu, Intensity::conservative);
  EXPECT_LE(largest_difference(step.volume, expected.volume), 1e-12);
  EXPECT_NEAR(step.report.totals.after[0] / step.report.totals.before[0], 1, 1e-12);
}

/// What a part of a mesh gives does not depend on how much the others are compressed, as parts of
/// an output have the meshes that they need.
TEST(WarpIntensity, CompressionElsewhereChangesNoBit) {
  scenes::Scene scene = far_corners(60);
  for (std::size_t n = 0; n < 8; ++n) {
    const double scale = n < 4 ? 0.9 : 0.05;
    const Point3 corner = scene.mesh.rest_positions[n < 4 ? 0 : 4];
    const Point3 to = n < 4 ? Point3{2.3, 2.1, 2.2} : Point3{52.4, 7.3, 6.2};
    for (int axis = 0; axis < 3; ++axis) {
      scene.deformed[n][axis] = to[axis] + scale * (scene.deformed[n][axis] - corner[axis]);
    }
  }
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float64);
  const Step both = run(source, scene, Backend::cpu, Intensity::conservative);
  scene.mesh.tets.pop_back();
  const Step one = run(source, scene, Backend::cpu, Intensity::conservative);
  const auto of_both = both.volume.samples<double>(), of_one = one.volume.samples<double>();
  std::int64_t differing = 0, filled = 0;
  for (std::size_t n = 0; n < of_one.size(); ++n) {
    const bool is_first = n % 60 < 16;
    differing += is_first ? of_both[n] != of_one[n] : 0;
    filled += is_first ? of_one[n] != 0 : of_both[n] != 0;
  }
  EXPECT_EQ(differing, 0);
  EXPECT_GT(filled, 20);
}

/// Three sources of nine components: 27 totals, each that of the source alone.
TEST(WarpIntensity, ReportsTheTotalsOfAllSources) {
  const scenes::Scene scene = whole_scenes()[1];
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32, 9);
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    const Totals one = run(source, scene, backend, Intensity::density).report.totals;
    WarpOptions options{.intensity = Intensity::density, .backend = backend};
    options.output_grid = scene.output_grid;
    const std::vector<VolumeView> sources(3, VolumeView(source));
    Warper warper(sources, scene.mesh, options);
    std::vector<Volume> outputs(3, make_volume(warper.output_grid(), source.type, 9));
    std::vector<void*> arrays;
    arrays.reserve(outputs.size());
    for (Volume& output : outputs) arrays.push_back(output.data.data());
    const Totals all = warper.step(scene.deformed, {.volumes = arrays}).totals;
    ASSERT_EQ(all.before.size(), 27u);
    ASSERT_EQ(all.after.size(), 27u);
    for (std::size_t c = 0; c < 27; ++c) {
      EXPECT_EQ(all.before[c], one.before[c % 9]);
      EXPECT_EQ(all.after[c], one.after[c % 9]);
    }
  }
}

/// All of a volume that does not move, or moves by whole voxels, is the volume; a part of the
/// output is that part.
TEST(WarpIntensity, LeavesAndMovesWholeVoxels) {
  const Grid grid = scenes::oblique_grid(12, 11, 10);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  const Mesh mesh = covering_mesh(grid);
  const scenes::Scene still = {"still", mesh, mesh.rest_positions, grid, grid};
  const scenes::Scene shifted = {"shift", mesh, moved(grid, mesh.rest_positions, {2, -1, 3}), grid,
                                 grid};
  const WarpOptions part{.region = Region{{3, 2, 4}, {9, 10, 7}}};
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    const auto conserved = [&](const scenes::Scene& scene, const WarpOptions& options) {
      return run(source, scene, backend, Intensity::conservative, options).volume.data;
    };
    EXPECT_EQ(conserved(still, {}), source.data);
    for (const WarpOptions& options : {WarpOptions{}, part}) {
      EXPECT_EQ(conserved(shifted, options),
                run(source, shifted, backend, Intensity::value, options).volume.data);
    }
  }
}

/// Twice as long, three times as wide, turned over: a sixth per volume, by both laws; the output's
/// voxels have another size.
TEST(WarpIntensity, DividesByTheVolumeRatio) {
  const Grid grid = scenes::unit_grid(12, 12, 12);
  Grid output = scenes::unit_grid(9, 14, 12);
  output.spacing = {0.5, 1.25, 2};
  output.origin = {3, 3, 3};
  Volume source = make_volume(grid, PixelType::float64);
  std::ranges::fill(source.samples<double>(), 12.0);
  const scenes::Scene scene = affine_scene(grid, output, Eigen::Vector3d(2, -3, 1).asDiagonal());
  for (const Backend backend : usable_backends()) {
    for (const Intensity intensity : {Intensity::density, Intensity::conservative}) {
      SCOPED_TRACE(name_of(backend));
      const Step step = run(source, scene, backend, intensity);
      EXPECT_EQ(step.report.counts.inverted, step.report.counts.tetrahedra);
      const auto is_sixth = [](double sample) { return std::abs(sample - 2) < 1e-5; };
      EXPECT_GT(std::ranges::count_if(step.volume.samples<double>(), is_sixth), 300);
      EXPECT_NEAR(step.report.totals.before[0], 12.0 * 12 * 12 * 12, 1e-7);
    }
  }
}

/// Half of the source is zero, a quarter another constant, with a sample per octant that is not a
/// number: zero stays zero, and only voxels that share such a sample are not numbers.
TEST(WarpIntensity, KeepsWhatIsNearbyApart) {
  const scenes::Scene scene = whole_scenes()[1];
  Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float64, 2);
  const auto samples = source.samples<double>();
  const auto dims = scene.source_grid.dims;
  std::size_t n = 0;
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i) {
        for (int c = 0; c < 2; ++c, ++n) {
          if (2 * k < dims[2]) samples[n] = 0;
          if (2 * k >= dims[2] && 2 * j < dims[1]) samples[n] = 3 + c;
          if (i % 4 == 3 && j % 4 == 1 && k == 5) samples[n] = std::nan("");
        }
      }
    }
  }
  Volume expected = run(source, scene, Backend::reference, Intensity::conservative).volume;
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    Volume volume = run(source, scene, backend, Intensity::conservative).volume;
    std::int64_t zeros = 0, positive = 0;
    for (std::size_t at = 0; at < volume.samples<double>().size(); ++at) {
      const double value = volume.samples<double>()[at], other = expected.samples<double>()[at];
      if (std::isnan(value)) {
        ASSERT_TRUE(std::isnan(other)) << at;
        continue;
      }
      zeros += value == 0 && other == 0;
      positive += value > 0;
      ASSERT_GE(value, 0) << at;
      if (!std::isnan(other)) {
        ASSERT_NEAR(value, other, 1e-12) << at;
      }
    }
    EXPECT_GT(zeros, 1000);
    EXPECT_GT(positive, 200);
  }
}

/// A smooth density on fine voxels: sampling keeps its total to first order.
TEST(WarpIntensity, DensitiesKeepTheTotalAsFarAsSamplingGoes) {
  const Grid grid = scenes::unit_grid(24, 24, 24);
  scenes::Scene scene = affine_scene(grid, grid, 0.7 * Matrix::Identity());
  scene.deformed = scenes::waved(scene.deformed, 1.5, 13);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    const StepReport report = run(source, scene, backend, Intensity::density).report;
    EXPECT_NEAR(report.totals.after[0] / report.totals.before[0], 1, 0.02);
    EXPECT_TRUE(run(source, scene, backend, Intensity::value).report.totals.before.empty());
  }
}

TEST(WarpIntensity, HasTheSameBitsWhateverIsLeftOut) {
  const Grid grid = scenes::unit_grid(18, 17, 16);
  const scenes::Scene scene = affine_scene(grid, grid, turn(0.2, {0, 1, 1}) * 0.8);
  const std::vector<Volume> sources = {scenes::wavy_volume(grid, PixelType::int16),
                                       scenes::wavy_volume(grid, PixelType::float32, 2)};
  for (const Backend backend : usable_backends()) {
    if (backend == Backend::reference) continue;  // leaves nothing out
    SCOPED_TRACE(name_of(backend));
    WarpOptions options{.intensity = Intensity::conservative, .backend = backend, .threads = 3};
    Series updated(sources, scene, options);
    options.expert.skip = {false, false, false, false, false, false, false};
    options.threads = 1;
    Series anew(sources, scene, options);
    std::int64_t unchanged = 0;
    for (const auto& positions : partial_motions(scene, 29)) {
      unchanged += updated.step(positions).cells_unchanged;
      anew.step(positions);
      ASSERT_TRUE(updated.has_bits_of(anew));
    }
    EXPECT_GT(unchanged, 0);
  }
}
}  // namespace
}  // namespace tetwarp::test
