/// @file test_label_rules.cpp
/// Labels by volume and by Gaussian weights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <tetwarp/resample.hpp>
#include <vector>

#include "tests/support/affine_scenes.hpp"
#include "tests/support/hex_scenes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
/// Blocks of two to four voxels with `count` labels, and single voxels of others among them.
Volume blocks_of_labels(const Grid& grid, int count, PixelType type = PixelType::int16) {
  Volume volume = make_volume(grid, type);
  with_pixel_type(type, [&]<class T>(T) {
    const auto labels = volume.samples<T>();
    for (std::size_t v = 0; v < labels.size(); ++v) {
      const auto at = static_cast<std::int64_t>(v);
      const std::int64_t i = at % grid.dims[0], j = at / grid.dims[0] % grid.dims[1],
                         k = at / (grid.dims[0] * grid.dims[1]);
      const std::int64_t block = i / 3 + 7 * (j / 4) + 5 * (k / 2);
      const bool is_single = scenes::uniform(3, v) < 0.1;
      labels[v] = static_cast<T>(((is_single ? at : block) % count) * 3);
    }
  });
  return volume;
}

WarpOptions by(LabelRule rule) {
  return {.filter = Filter::labels, .label_rule = rule};
}

/// Numbers of voxels whose labels differ.
std::int64_t differing(const Volume& a, const Volume& b) {
  const auto x = numbers_of(a), y = numbers_of(b);
  EXPECT_EQ(x.size(), y.size());
  std::int64_t count = 0;
  for (std::size_t n = 0; n < std::min(x.size(), y.size()); ++n) count += x[n] != y[n];
  return count;
}

void expect_reference(const scenes::Scene& scene, const Volume& source, WarpOptions options) {
  const Warped expected = run_warp(source, scene, Backend::reference, options);
  for (const Backend backend : usable_backends()) {
    if (backend == Backend::reference) continue;
    SCOPED_TRACE(scene.name + " " + name_of(backend));
    const Warped warped = run_warp(source, scene, backend, options);
    EXPECT_EQ(differing(warped.volume, expected.volume), 0);
    EXPECT_EQ(warped.owner, expected.owner);
    EXPECT_EQ(warped.mask, expected.mask);
  }
}

/// Turned, shrunk and waved, one folded over itself, in voxels of another shape.
std::vector<scenes::Scene> shrunk_scenes() {
  const Grid source = scenes::oblique_grid(11, 10, 9);
  Grid output = scenes::unit_grid(14, 12, 13);
  output.spacing = {1.9, 2.1, 1.7};
  output.direction = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  const Point3 center = center_of(source);
  output.origin = {center[0] + 12, center[1] - 11, center[2] - 11};
  std::vector<scenes::Scene> scenes;
  for (const double scale : {0.5, 1.1}) {
    scenes.push_back(affine_scene(source, output, turn(0.4, {1, 2, -1}) * scale));
    scenes.back().deformed = scenes::waved(scenes.back().deformed, 1.0, 91);
  }
  for (Point3& p : scenes[1].deformed) p[0] = center[0] + std::abs(p[0] - center[0]);
  return scenes;
}

TEST(LabelVolumes, AreThoseOfTheReference) {
  for (const scenes::Scene& scene : shrunk_scenes()) {
    for (const int count : {3, 40}) {
      WarpOptions options = by(LabelRule::volume);
      options.background = 6;
      expect_reference(scene, blocks_of_labels(scene.source_grid, count), options);
    }
  }
}

TEST(LabelVolumes, AreThoseOfTheReferenceForBadMeshes) {
  for (const char* const name : {"aligned", "half_voxel", "slivers_3", "thin_aligned_5", "soup",
                                 "overlapping", "folded", "flat", "outside"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 8);
    expect_reference(scene, blocks_of_labels(scene.source_grid, 5, PixelType::uint8),
                     by(LabelRule::volume));
  }
}

/// A tetrahedron that is flat at rest, in an oblique plane, has no part of any voxel.
TEST(LabelVolumes, OfTetrahedraFlatAtRestAreTheBackground) {
  const Grid grid = scenes::unit_grid(10, 10, 10);
  const Mesh mesh{{{1, 1, 1}, {5, 2, 1.5}, {2, 6, 3}, {6, 7, 3.5}}, {{0, 1, 2, 3}}};
  const scenes::Scene scene = {
      "flat_at_rest", mesh, {{1, 1, 1}, {9, 1, 1}, {1, 9, 1}, {1, 1, 9}}, grid, grid};
  WarpOptions options = by(LabelRule::volume);
  options.background = 6;
  for (const int count : {1, 5}) {  // one label everywhere, and several
    const Volume source = blocks_of_labels(grid, count);
    expect_reference(scene, source, options);
    for (const double label : numbers_of(run_warp(source, scene, Backend::cpu, options).volume)) {
      ASSERT_EQ(label, 6);
    }
  }
}

/// Under one linear map the share of a label in a box is what conservative carries of the volume
/// that is 1 in the label and 0 elsewhere. The shares of all labels and of what is not covered sum
/// to one, and the label of a voxel has the largest of them.
TEST(LabelVolumes, AreTheLargestOfSharesThatSumToOne) {
  const Grid source = scenes::unit_grid(12, 11, 10);
  const Grid output = scenes::unit_grid(12, 11, 10);
  const double scale = 0.6;
  const scenes::Scene scene = affine_scene(source, output, turn(0.7, {1, 2, 3}) * scale);
  const Volume labels = blocks_of_labels(source, 4);
  const double output_volume = scale * scale * scale;  // of a source voxel
  std::vector<double> uncovered(numbers_of(labels).size(), 1), largest(uncovered.size(), 0);
  std::map<double, std::vector<double>> shares;
  for (int label = 0; label < 12; label += 3) {
    Volume indicator = make_volume(source, PixelType::float64);
    const auto numbers = numbers_of(labels);
    std::ranges::transform(numbers, indicator.samples<double>().begin(),
                           [&](double number) { return number == label ? 1.0 : 0.0; });
    auto& share = shares[label] = numbers_of(
        run_warp(indicator, scene, Backend::cpu, {.intensity = Intensity::conservative}).volume);
    for (std::size_t v = 0; v < share.size(); ++v) {
      uncovered[v] -= share[v] *= output_volume;
      largest[v] = std::max(largest[v], share[v]);
    }
  }
  WarpOptions options = by(LabelRule::volume);
  options.background = 99;

  const auto chosen = numbers_of(run_warp(labels, scene, Backend::cpu, options).volume);

  constexpr double slack = 0x1p-15;  // 2^-16, and nodes rounded to 2^-20 voxel
  std::int64_t covered = 0, background = 0;
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    ASSERT_GE(uncovered[v], -slack);
    const double share = chosen[v] == 99 ? uncovered[v] : shares.at(chosen[v])[v];
    ASSERT_GE(share, std::max(largest[v], uncovered[v]) - slack) << v;
    background += chosen[v] == 99;
    covered += chosen[v] != 99;
  }
  EXPECT_GT(covered, 150);
  EXPECT_GT(background, 600);
}

/// Output voxels of n^3 whole voxels of the source get the label that most of them have, and of
/// equal numbers the lowest: up to 64 voxels with 30 labels, some of them negative.
TEST(LabelVolumes, CountWholeVoxels) {
  const Grid grid = scenes::unit_grid(16, 16, 16);
  Volume source = make_volume(grid, PixelType::int32);
  const auto labels = source.samples<std::int32_t>();
  for (const auto& [edge, label_count] : {std::pair{2, 3}, {2, 8}, {4, 30}}) {
    for (std::size_t v = 0; v < labels.size(); ++v) {
      labels[v] = static_cast<std::int32_t>(scenes::uniform(11, v) * label_count) * 100000 - 700000;
    }
    const std::int64_t count = 16 / edge;
    Grid output = scenes::unit_grid(count, count, count);
    output.spacing = {double(edge), double(edge), double(edge)};
    output.origin = {(edge - 1) / 2.0, (edge - 1) / 2.0, (edge - 1) / 2.0};
    const Mesh mesh = covering_mesh(grid);
    const scenes::Scene scene = {"coarse", mesh, mesh.rest_positions, grid, output};
    std::vector<double> expected;
    for (std::int64_t v = 0; v < count * count * count; ++v) {
      std::map<std::int32_t, int> found;
      for (std::int64_t n = 0; n < edge * edge * edge; ++n) {
        const std::int64_t i = v % count * edge + n % edge,
                           j = v / count % count * edge + n / edge % edge,
                           k = v / count / count * edge + n / edge / edge;
        ++found[labels[static_cast<std::size_t>((k * 16 + j) * 16 + i)]];
      }
      const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
      expected.push_back(std::ranges::max_element(found, fewer)->first);
    }
    for (const Backend backend : usable_backends()) {
      SCOPED_TRACE(std::to_string(label_count) + " " + name_of(backend));
      const Warped warped = run_warp(source, scene, backend, by(LabelRule::volume));
      EXPECT_EQ(numbers_of(warped.volume), expected);
    }
  }
}

/// A region of the output, and a step after another one, which writes only what has changed.
TEST(LabelVolumes, DoNotDependOnRegionsAndEarlierSteps) {
  const scenes::Scene scene = shrunk_scenes()[0];
  const Volume source = blocks_of_labels(scene.source_grid, 5);
  for (const LabelRule rule : {LabelRule::volume, LabelRule::gaussian}) {
    SCOPED_TRACE(name_of(rule));
    WarpOptions options = by(rule);
    options.backend = Backend::cpu;
    options.output_grid = scene.output_grid;
    Warper warper(source, scene.mesh, options);
    Volume output = make_volume(scene.output_grid, source.type);
    void* const data = output.data.data();
    std::vector<Point3> almost = scene.deformed;
    almost.front()[1] += 0.4;
    warper.step(almost, {.volumes = std::span(&data, 1)});
    warper.step(scene.deformed, {.volumes = std::span(&data, 1), .holds_previous = true});
    const Volume whole = Warper(source, scene.mesh, options).step(scene.deformed);
    EXPECT_EQ(differing(output, whole), 0);
    options.region = Region{{3, 2, 4}, {11, 9, 12}};
    const Volume part = Warper(source, scene.mesh, options).step(scene.deformed);
    const auto all = numbers_of(whole), some = numbers_of(part);
    for (std::size_t v = 0; v < some.size(); ++v) {
      const std::size_t i = 3 + v % 8, j = 2 + v / 8 % 7, k = 4 + v / 56;
      ASSERT_EQ(some[v], all[(k * 12 + j) * 14 + i]) << v;
    }
  }
}

TEST(GaussianLabels, AreThoseOfTheReference) {
  for (const std::string_view name : scenes::adversarial_names) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 8);
    WarpOptions options = by(LabelRule::gaussian);
    options.background = 4;
    expect_reference(scene, blocks_of_labels(scene.source_grid, 5, PixelType::uint8), options);
    options.label_gaussian = {.sigma = 0.8, .cutoff = 3};
    options.outside = Outside::identity;
    expect_reference(scene, blocks_of_labels(scene.source_grid, 40), options);
  }
}

TEST(GaussianLabels, AreThoseOfTheReferenceInHexahedra) {
  for (const double amount : {0.0, 1.5}) {
    const HexBox box =
        hex_box({2, 3, 2}, {-0.5, -0.5, -0.5}, {9.5, 9.5, 9.5}, [&](const Point3& x) {
          return Point3{x[0] + amount * std::sin(x[1] / 3), x[1] + amount * std::sin(x[2] / 4),
                        x[2]};
        });
    const Grid grid = scenes::unit_grid(10, 10, 10);
    const scenes::Scene scene = {"bent", box.mesh, box.deformed, grid, grid};
    expect_reference(scene, blocks_of_labels(scene.source_grid, 5), by(LabelRule::gaussian));
  }
}

/// A narrow Gaussian has its weight in one voxel; half an voxel from two of them they are equal,
/// and the lower label wins.
TEST(GaussianLabels, OfANarrowOneAreTheNearest) {
  const Grid grid = scenes::unit_grid(12, 12, 12);
  const Volume source = blocks_of_labels(grid, 7);
  const scenes::Scene scene = affine_scene(grid, grid, turn(0.3, {1, 1, 2}));
  WarpOptions options = by(LabelRule::gaussian);
  options.label_gaussian = {.sigma = 1e-3, .cutoff = 4};
  EXPECT_EQ(differing(run_warp(source, scene, Backend::cpu, options).volume,
                      run_warp(source, scene, Backend::cpu, {.filter = Filter::nearest}).volume),
            0);
}

/// A Gaussian so wide that no weight counts: all labels within the cutoff are equal, and the lowest
/// one wins.
TEST(GaussianLabels, OfAVeryWideOneAreTheLowest) {
  const Grid grid = scenes::unit_grid(6, 6, 6);
  Volume source = make_volume(grid, PixelType::int16);
  const auto labels = source.samples<std::int16_t>();
  for (std::size_t v = 0; v < labels.size(); ++v) labels[v] = v % 2 == 0 ? 7 : 3;  // by column
  const Mesh mesh = covering_mesh(grid);
  const scenes::Scene scene = {"still", mesh, mesh.rest_positions, grid, grid};
  WarpOptions options = by(LabelRule::gaussian);
  options.background = 1;
  options.label_gaussian = {.sigma = 1e5, .cutoff = 1e-5};
  expect_reference(scene, source, options);
  const auto found = numbers_of(run_warp(source, scene, Backend::cpu, options).volume);
  EXPECT_EQ(std::ranges::count(found, 3.0), std::ssize(found));
}

/// The same map as mesh and as transform. Nodes are rounded to 2^-20 voxel, so that labels
/// of almost equal weights may differ.
TEST(GaussianLabels, OfResampleAreThoseOfAWarp) {
  const Grid grid = scenes::unit_grid(14, 13, 12);
  const Volume source = blocks_of_labels(grid, 6);
  const Eigen::Matrix3d linear = turn(0.3, {1, 1, 2}) * 1.3;
  const scenes::Scene scene = affine_scene(grid, grid, linear);
  const Warped warped = run_warp(source, scene, Backend::reference, by(LabelRule::gaussian));
  AffineTransform transform;
  const Eigen::Matrix3d back = linear.inverse();
  const Eigen::Vector3d center = vector_of(center_of(grid)), offset = center - back * center;
  for (std::size_t n = 0; n < 9; ++n) {
    transform.matrix[n] = back(static_cast<int>(n / 3), static_cast<int>(n % 3));
  }
  transform.offset = {offset(0), offset(1), offset(2)};
  const Volume resampled =
      resample(source, transform, {.filter = Filter::labels, .label_rule = LabelRule::gaussian});
  const auto expected = numbers_of(warped.volume), found = numbers_of(resampled);
  std::int64_t covered = 0, wrong = 0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    if (warped.owner[v] < 0) continue;
    ++covered;
    wrong += found[v] != expected[v];
  }
  EXPECT_GT(covered, 2000);
  EXPECT_LE(wrong, 1);
}

TEST(LabelRules, RefuseWhatTheyCannotDo) {
  const scenes::Scene scene = scenes::adversarial_scene("identity", 4);
  const auto complaint = [&](PixelType type, WarpOptions options) {
    options.backend = Backend::cpu;
    return message_of<std::invalid_argument>(
        [&] { Warper(make_volume(scene.source_grid, type), scene.mesh, options); });
  };
  WarpOptions no_labels = by(LabelRule::volume), outside = no_labels, beyond, wide, window;
  no_labels.filter = Filter::linear;
  outside.outside = Outside::identity;
  beyond = wide = window = by(LabelRule::gaussian);
  beyond.outside = Outside::nearest;
  wide.label_gaussian = {.sigma = 3, .cutoff = 3};
  window.source_window = SourceWindow{{{0, 0, 0}, {1, 1, 1}}};
  EXPECT_NE(complaint(PixelType::uint8, no_labels).find("set the filter to labels"),
            std::string::npos);
  EXPECT_NE(complaint(PixelType::uint8, outside).find("outside"), std::string::npos);
  EXPECT_NE(complaint(PixelType::uint8, beyond).find("outside"), std::string::npos);
  EXPECT_NE(complaint(PixelType::uint8, wide).find("at most 8 voxels"), std::string::npos);
  EXPECT_NE(complaint(PixelType::uint8, window).find("whole source"), std::string::npos);
  EXPECT_NE(complaint(PixelType::int64, by(LabelRule::volume)).find("32 bits"), std::string::npos);
  const Volume source = make_volume(scene.source_grid, PixelType::uint8);
  EXPECT_NE(message_of<std::invalid_argument>([&] {
              resample(source, AffineTransform{},
                       {.filter = Filter::labels, .label_rule = LabelRule::volume});
            }).find("warps by a mesh"),
            std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test
