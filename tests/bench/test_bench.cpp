/// @file test_bench.cpp
/// The truth, the checks, the sampling floor and the clock of the benchmarks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <tetwarp/warp.hpp>
#include <vector>

#include "bench/measure/floors.hpp"
#include "bench/measure/timing.hpp"
#include "bench/warp/truth.hpp"
#include "bench/warp/workloads.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::bench {
namespace {
/// A scene warped by the reference back end.
struct Warped {
  scenes::Scene scene;
  Volume source;
  std::vector<float> output;
  std::vector<std::int32_t> owner;
  Counts counts;

  explicit Warped(const scenes::Scene& warped_scene, int components = 1)
      : scene(warped_scene),
        source(scenes::wavy_volume(scene.source_grid, PixelType::float32, components)),
        output(static_cast<std::size_t>(scene.output_grid.voxel_count() * components)),
        owner(static_cast<std::size_t>(scene.output_grid.voxel_count())) {
    Warper warper(source, scene.mesh,
                  {.output_grid = scene.output_grid, .backend = Backend::reference});
    void* const out = output.data();
    counts =
        warper.step(scene.deformed, {.volumes = std::span(&out, 1), .owner = owner.data()}).counts;
  }

  Accuracy compared() const {
    return compare(make_truth(scene), source, Filter::linear, output.data(), owner.data());
  }
  bool is_refused() const {
    return fault_of(compared(), 1e-5, counts, scene, owner.data()).has_value();
  }
  std::size_t first_voxel(bool covered) const {
    std::size_t v = 0;
    while ((owner[v] >= 0) != covered) ++v;
    return v;
  }
};

Warped rotated_box(int components = 1) {
  for (const scenes::Scene& scene : scenes::adversarial_scenes(12)) {
    if (scene.name == "rotated") return Warped(scene, components);
  }
  throw std::logic_error("no scene named rotated");
}

TEST(BenchTruth, EqualsTheReferenceInEveryVoxel) {
  for (const scenes::Scene& scene : scenes::adversarial_scenes(12)) {
    const Warped warped(scene);

    const Truth truth = make_truth(scene);
    const Accuracy accuracy = warped.compared();

    ASSERT_TRUE(truth.is_complete) << scene.name;
    EXPECT_EQ(truth.owners, warped.owner) << scene.name;
    EXPECT_LE(accuracy.max_error, 1e-7) << scene.name;  // half a unit in the last place of float32
    EXPECT_FALSE(warped.is_refused()) << scene.name;
  }
}

TEST(BenchTruth, SamplesLargeVolumesWithoutBias) {
  scenes::Scene scene = make_scene(waved(256, 40));
  const Truth truth = make_truth(scene);
  std::int64_t covered = 0;
  for (const std::int32_t owner : truth.owners) covered += owner >= 0;
  double volume = 0;  // of the deformed mesh, by the divergence theorem cell by cell
  for (const auto& tet : scene.mesh.tets) {
    double e[3][3];
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        e[a][axis] = scene.deformed[static_cast<std::size_t>(tet[a + 1])][axis] -
                     scene.deformed[static_cast<std::size_t>(tet[0])][axis];
      }
    }
    volume += std::abs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                       e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                       e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
              6;
  }

  ASSERT_FALSE(truth.is_complete);
  ASSERT_EQ(truth.voxels.size(), 100000u);
  // A share of 100,000 draws has a standard deviation of at most 0.0016; five of them.
  EXPECT_NEAR(static_cast<double>(covered) / 100000,
              volume / static_cast<double>(scene.output_grid.voxel_count()), 0.008);
}

TEST(BenchCheck, RefusesAHole) {
  Warped warped = rotated_box();
  warped.owner[warped.first_voxel(true)] = -1;

  EXPECT_EQ(warped.compared().holes, 1);
  EXPECT_TRUE(warped.is_refused());
}

TEST(BenchCheck, RefusesAPaintedVoxel) {
  Warped warped = rotated_box();
  warped.output[warped.first_voxel(false)] = 0.25f;

  EXPECT_EQ(warped.compared().painted, 1);
  EXPECT_TRUE(warped.is_refused());
}

TEST(BenchCheck, RefusesAVoxelWithAnotherOwner) {
  Warped warped = rotated_box();
  ++warped.owner[warped.first_voxel(true)];

  EXPECT_EQ(warped.compared().doubles, 1);
  EXPECT_TRUE(warped.is_refused());
}

TEST(BenchCheck, RefusesAWrongValueAndANaN) {
  for (const float wrong : {0.1f, std::numeric_limits<float>::quiet_NaN()}) {
    Warped warped = rotated_box();
    warped.output[warped.first_voxel(true)] += wrong;

    EXPECT_FALSE(warped.compared().max_error <= 1e-5);
    EXPECT_TRUE(warped.is_refused());
  }
}

TEST(BenchCheck, RefusesAWrongValueInAnyComponent) {
  for (std::size_t component = 0; component < 3; ++component) {
    Warped warped = rotated_box(3);
    EXPECT_FALSE(warped.is_refused());

    warped.output[3 * warped.first_voxel(true) + component] += 0.1f;
    EXPECT_TRUE(warped.is_refused()) << component;
    warped = rotated_box(3);
    warped.output[3 * warped.first_voxel(false) + component] = 0.25f;
    EXPECT_EQ(warped.compared().painted, 1) << component;
  }
}

TEST(BenchCheck, RefusesCountersThatContradictTheOwners) {
  Warped warped = rotated_box();
  ++warped.counts.covered;
  --warped.counts.outside;

  EXPECT_TRUE(warped.is_refused());
}

/// 37 voxels along x: more than one vector and not a multiple of any.
TEST(BenchFloor, SamplesEveryVoxelThroughItsMap) {
  const Grid source = scenes::unit_grid(21, 18, 19), output = scenes::unit_grid(37, 20, 23);
  const AffineRows map = turned_about_middle(source, output, std::numbers::pi / 5);
  for (const PixelType type :
       {PixelType::uint8, PixelType::int16, PixelType::float32, PixelType::float64}) {
    const Buffer image = make_image(source, type, Image::textured);
    const VolumeView view{source, type, 1, image.data(), Memory::host};
    for (const Filter filter : {Filter::nearest, Filter::linear}) {
      for (const RowOrder order : {RowOrder::lines, RowOrder::bundles}) {
        Volume result = make_volume(output, type);
        const std::int64_t sampled = sample_affine(
            {type, filter, source.dims, output.dims, image.data(), result.data.data(), map}, order,
            2);

        // The truth of one tetrahedron, number 0, that covers all positions inside the source.
        Truth truth;
        std::vector<std::int32_t> owner;
        for (std::int64_t v = 0; v < output.voxel_count(); ++v) {
          const std::int64_t row = v / 37, slice = row / 20;
          const double ijk[3] = {static_cast<double>(v % 37), static_cast<double>(row % 20),
                                 static_cast<double>(slice)};
          Point3 x;
          bool is_inside = true;
          for (std::size_t a = 0; a < 3; ++a) {
            x[a] = map[a][0] * ijk[0] + map[a][1] * ijk[1] + map[a][2] * ijk[2] + map[a][3];
            is_inside =
                is_inside && x[a] >= -0.5 && x[a] <= static_cast<double>(source.dims[a]) - 0.5;
          }
          truth.voxels.push_back(v);
          truth.owners.push_back(is_inside ? 0 : -1);
          truth.positions.push_back(x);
          owner.push_back(truth.owners.back());
        }
        const Accuracy accuracy = compare(truth, view, filter, result.data.data(), owner.data());

        EXPECT_EQ(accuracy.painted, 0) << name_of(type);
        EXPECT_LE(accuracy.max_error, error_bound(type, filter)) << name_of(type);
        EXPECT_EQ(sampled, std::count(owner.begin(), owner.end(), 0)) << name_of(type);
      }
    }
  }
}

TEST(BenchClock, KeepsEveryRepetitionWithoutAMinimumOfBusyThreads) {
  int calls = 0;
  const std::function<void()> job = [&] { ++calls; };

  const Timing timing = time_in_turn(std::span(&job, 1), {.repetitions = 5}).front();

  EXPECT_EQ(calls, 5);
  EXPECT_EQ(timing.kept, 5);
  EXPECT_FALSE(timing.contended);
  EXPECT_LE(timing.min, timing.low);
  EXPECT_LE(timing.low, timing.median);
  EXPECT_LE(timing.median, timing.high);
}

TEST(BenchClock, MarksATimeWhoseRepetitionsAllLackedProcessors) {
  int calls = 0;
  const std::function<void()> job = [&] { ++calls; };

  const Timing timing =
      time_in_turn(std::span(&job, 1), {.repetitions = 3, .attempts = 7, .busy_threads = 1e6})
          .front();

  EXPECT_EQ(calls, 7);
  EXPECT_EQ(timing.discarded, 7);
  EXPECT_TRUE(timing.contended);
}

TEST(BenchWorkloads, InvertNoTetrahedron) {
  for (const Workload& workload : {ties_128(), torso_700(), rotated(64), fish_35(), waved(256, 40),
                                   waved(256, 5000), waved(256, 500000), waved(384, 50000)}) {
    const scenes::Scene scene = make_scene(workload);
    Volume source = make_volume(scenes::unit_grid(2, 2, 2), PixelType::uint8);
    WarpOptions options{.output_grid = scenes::unit_grid(1, 1, 1), .backend = Backend::cpu};
    Warper warper(source, scene.mesh, options);
    std::uint8_t voxel = 0;
    void* const out = &voxel;

    const Counts counts = warper.step(scene.deformed, {.volumes = std::span(&out, 1)}).counts;

    EXPECT_EQ(counts.tetrahedra, workload.tet_count()) << workload.name;
    EXPECT_EQ(counts.inverted + counts.flat, 0) << workload.name;
  }
}
}  // namespace
}  // namespace tetwarp::bench
