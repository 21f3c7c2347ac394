/// @file test_warp_curved.cpp
/// Whole warps by tetrahedra of ten nodes, on every back end.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/curved_scenes.hpp"
#include "tests/support/each_backend.hpp"
#include "tests/support/field_buffers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
constexpr std::int64_t volume_edge = 24;  ///< of the volumes [voxel]
const Grid grid = scenes::unit_grid(volume_edge, volume_edge, volume_edge);

class WarpCurved : public EachBackend {
 protected:
  Warped run(const Volume& source,
             const CurvedMesh& mesh,
             const std::vector<Point3>& deformed,
             WarpOptions options = {}) {
    return run_on(GetParam(), source, mesh, deformed, options);
  }
  static Warped run_on(Backend backend,
                       const Volume& source,
                       const CurvedMesh& mesh,
                       const std::vector<Point3>& deformed,
                       WarpOptions options = {}) {
    options.backend = backend;
    Warper warper(std::array{VolumeView(source)}, mesh, options);
    return run_step(warper, source, deformed);
  }
  Warped run_straight(const Volume& source,
                      const CurvedMesh& mesh,
                      const std::vector<Point3>& deformed,
                      WarpOptions options = {}) {
    options.backend = GetParam();
    Warper warper(source, mesh.mesh, options);
    return run_step(warper, source, deformed);
  }
};
INSTANTIATE_TEST_SUITE_P(Backends, WarpCurved, each_backend, name_of_backend);

/// Corners four voxels apart, within the volume; middle nodes at even numbers.
CurvedMesh cubes() {
  return with_mid_nodes(scenes::lattice({5, 5, 5}, {2, 2, 2}, {22, 22, 22}));
}

Volume ramp(std::size_t axis) {
  Volume volume = make_volume(grid, PixelType::float64);
  const auto samples = volume.samples<double>();
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const std::size_t index[3] = {s % volume_edge, s / volume_edge % volume_edge,
                                  s / volume_edge / volume_edge};
    samples[s] = static_cast<double>(index[axis]);
  }
  return volume;
}

/// Rest positions of covered voxels by the samples of three ramps.
struct Places {
  std::array<Warped, 3> along;

  Point3 at(std::size_t v) const {
    return {along[0].volume.samples<double>()[v], along[1].volume.samples<double>()[v],
            along[2].volume.samples<double>()[v]};
  }
};

double distance(const Point3& a, const Point3& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

Point3 index_of(std::size_t v) {
  return {static_cast<double>(v % volume_edge), static_cast<double>(v / volume_edge % volume_edge),
          static_cast<double>(v / volume_edge / volume_edge)};
}

/// Positions are multiples of a quantum, so that the quadratic map of every cell is the motion.
TEST_P(WarpCurved, ReproducesAQuadraticMotion) {
  const CurvedMesh mesh = cubes();
  std::vector<Point3> deformed;
  for (const Point3& x : mesh.mesh.rest_positions) deformed.push_back(quadratic(x));
  Places places;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    places.along[axis] = run(ramp(axis), mesh, deformed, {.background = -99});
  }
  const Warped& first = places.along[0];
  double worst = 0;
  for (std::size_t v = 0; v < first.owner.size(); ++v) {
    const Point3 rest = places.at(v);
    if (first.owner[v] < 0 || std::ranges::find(rest, -99.0) != rest.end()) continue;
    worst = std::max(worst, distance(quadratic(rest), index_of(v)));
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_EQ(first.counts.voxels_straightened, 0);
  EXPECT_GT(first.counts.covered, 5000);
  const Places straight = {{run_straight(ramp(0), mesh, deformed),
                            run_straight(ramp(1), mesh, deformed),
                            run_straight(ramp(2), mesh, deformed)}};
  EXPECT_TRUE(first.owner == straight.along[0].owner);
  double off = 0;
  for (std::size_t v = 0; v < first.owner.size(); ++v) {
    if (first.owner[v] >= 0) off = std::max(off, distance(quadratic(straight.at(v)), index_of(v)));
  }
  EXPECT_GT(off, 0.05);  // what the curves correct
}

/// Curved cells that move as one affine body.
TEST_P(WarpCurved, ReproducesAnAffineMotionOfCurvedCells) {
  CurvedMesh mesh = cubes();
  std::vector<Point3>& rest = mesh.mesh.rest_positions;
  const std::size_t corners = 6 * 6 * 6;
  const std::vector<Point3> moved = shaken(rest, 0.25, 3);
  for (std::size_t n = corners; n < rest.size(); ++n) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rest[n][axis] = std::nearbyint(moved[n][axis] * 1024) / 1024;
    }
  }
  const auto affine = [](const Point3& x) {
    return Point3{1.25 * x[0] - 0.25 * x[1] + 1, x[1] + 0.125 * x[2], 0.875 * x[2] + 0.25 * x[0]};
  };
  std::vector<Point3> deformed;
  for (const Point3& x : rest) deformed.push_back(affine(x));
  Places places;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    places.along[axis] = run(ramp(axis), mesh, deformed, {.background = -99});
  }
  double worst = 0;
  std::int64_t sampled = 0;
  for (std::size_t v = 0; v < places.along[0].owner.size(); ++v) {
    const Point3 x = places.at(v);
    if (places.along[0].owner[v] < 0 || std::ranges::find(x, -99.0) != x.end()) continue;
    worst = std::max(worst, distance(affine(x), index_of(v)));
    ++sampled;
  }
  EXPECT_LT(worst, 1e-8);
  EXPECT_GT(sampled, 1000);
  EXPECT_EQ(places.along[0].counts.voxels_straightened, 0);
}

TEST_P(WarpCurved, HasTheBitsOfFourNodesWhereEdgesAreStraight) {
  const CurvedMesh mesh = cubes();
  const std::vector<Point3> deformed = straightened(mesh, shaken(mesh.mesh.rest_positions, 1.3, 7));
  for (const Filter filter : {Filter::nearest, Filter::linear, Filter::cubic}) {
    for (const PixelType type : {PixelType::int16, PixelType::float32, PixelType::float64}) {
      const Volume source = scenes::wavy_volume(grid, type, 2);
      const Warped ten = run(source, mesh, deformed, {.filter = filter});
      const Warped four = run_straight(source, mesh, deformed, {.filter = filter});

      EXPECT_TRUE(is_same(ten, four));
      EXPECT_EQ(ten.counts.covered, four.counts.covered);
      EXPECT_EQ(ten.counts.voxels_straightened, 0);
    }
  }
}

/// Random middle nodes, at rest and deformed; slopes of the source are below 1 per voxel.
TEST_P(WarpCurved, IsTheReference) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  CurvedMesh mesh = cubes();
  mesh.mid_nodes[7] = mesh.mid_nodes[11] = no_mid_nodes;
  mesh.mesh.rest_positions = shaken(mesh.mesh.rest_positions, 0.1, 21);
  const std::vector<Point3> deformed = shaken(mesh.mesh.rest_positions, 0.15, 22);
  const auto compare = [&](const Volume& source, const WarpOptions& options) {
    const Warped here = run(source, mesh, deformed, options);
    const Warped judge = run_on(Backend::reference, source, mesh, deformed, options);
    EXPECT_TRUE(here.owner == judge.owner);
    EXPECT_LE(largest_difference(here.volume, judge.volume), 1e-5);
    EXPECT_EQ(here.counts.voxels_straightened, judge.counts.voxels_straightened);
    found("difference", largest_difference(here.volume, judge.volume));
    const Warped straight = run_straight(source, mesh, deformed, options);
    EXPECT_GT(largest_difference(here.volume, straight.volume), 0.01);
  };
  for (const Filter filter : {Filter::linear, Filter::cubic, Filter::bspline}) {
    compare(scenes::wavy_volume(grid, PixelType::float32, 2), {.filter = filter});
  }
  compare(scenes::wavy_volume(grid, PixelType::float64), {.outside = Outside::identity});
}

TEST_P(WarpCurved, HasFieldsOfTheQuadraticMap) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  CurvedMesh mesh = cubes();
  mesh.mesh.rest_positions = shaken(mesh.mesh.rest_positions, 0.2, 31);
  const std::vector<Point3> deformed = shaken(mesh.mesh.rest_positions, 0.3, 32);
  const Volume source = scenes::wavy_volume(grid, PixelType::uint8);
  FieldBuffers here(grid, false), judge(grid, false);
  for (FieldBuffers* fields : {&here, &judge}) {
    const Backend backend = fields == &here ? GetParam() : Backend::reference;
    Warper warper(std::array{VolumeView(source)}, mesh, {.backend = backend});
    Volume volume = make_volume(grid, PixelType::uint8);
    void* const data = volume.data.data();
    warper.step(deformed, {.volumes = {&data, 1}, .fields = fields->target()});
  }
  for (std::size_t field = 0; field < here.arrays().size(); ++field) {
    double worst = 0;
    for (std::size_t n = 0; n < here.arrays()[field].size(); ++n) {
      worst = std::max(worst, double{std::abs(here.arrays()[field][n] - judge.arrays()[field][n])});
    }
    EXPECT_LE(worst, 2e-5) << field;
    found("field" + std::to_string(field), worst);
  }
}

/// Middle nodes beyond all limits, and of a whole shift.
TEST_P(WarpCurved, TakesTheStraightMapWhereTheCurvedOneIsLostOrAddsNothing) {
  CurvedMesh mesh = cubes();
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  const std::size_t corners = 6 * 6 * 6;
  std::vector<Point3> deformed = shaken(mesh.mesh.rest_positions, 0.4, 41);
  for (std::size_t n = corners; n < deformed.size(); ++n) deformed[n] = {0x1p42, 0, 0};
  const Warped lost = run(source, mesh, deformed);
  EXPECT_TRUE(is_same(lost, run_straight(source, mesh, deformed)));
  EXPECT_EQ(lost.counts.voxels_straightened, lost.counts.covered);
  mesh.mesh.rest_positions = shaken(mesh.mesh.rest_positions, 0.4, 42);
  deformed = scenes::shifted(mesh.mesh.rest_positions, {2, -1, 3});
  const Warped moved = run(source, mesh, deformed);
  EXPECT_TRUE(is_same(moved, run_straight(source, mesh, deformed)));
  EXPECT_EQ(moved.counts.voxels_straightened, 0);
}

/// Edges bent so far that cells are folded: each voxel is mapped by one of both maps, and counted
/// if it is the straight one. Newton's method and the reference's continuation may end on different
/// sheets of a folded map.
TEST_P(WarpCurved, CountsVoxelsOfFoldedCells) {
  const CurvedMesh mesh = cubes();
  std::vector<Point3> deformed = shaken(mesh.mesh.rest_positions, 3.5, 51);
  for (std::size_t n = 0; n < 6 * 6 * 6; ++n) deformed[n] = mesh.mesh.rest_positions[n];
  const Volume source = scenes::wavy_volume(grid, PixelType::float64);
  const Warped here = run(source, mesh, deformed);
  const Warped straight = run_straight(source, mesh, deformed);

  std::int64_t same = 0;
  for (std::size_t v = 0; v < here.owner.size(); ++v) {
    same += here.owner[v] >= 0 &&
            here.volume.samples<double>()[v] == straight.volume.samples<double>()[v];
  }
  EXPECT_TRUE(here.owner == straight.owner);
  EXPECT_GT(here.counts.voxels_straightened, here.counts.covered / 20);
  EXPECT_LT(here.counts.voxels_straightened, here.counts.covered);
  EXPECT_GE(same, here.counts.voxels_straightened);
  found("straightened", static_cast<double>(here.counts.voxels_straightened));
}

TEST_P(WarpCurved, HasTheBitsOfTheWholeInRegionsAndUpdates) {
  const CurvedMesh mesh = cubes();
  std::vector<Point3> deformed = shaken(mesh.mesh.rest_positions, 0.5, 61);
  const Volume source = scenes::wavy_volume(grid, PixelType::int16);
  const Warped whole = run(source, mesh, deformed);
  const Region region{{3, 5, 2}, {20, 21, 13}};
  const Warped part = run(source, mesh, deformed, {.region = region});
  std::size_t p = 0;
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
      for (std::int64_t i = region.begin[0]; i < region.end[0]; ++i, ++p) {
        const auto v = static_cast<std::size_t>((k * volume_edge + j) * volume_edge + i);
        ASSERT_EQ(part.volume.samples<std::int16_t>()[p], whole.volume.samples<std::int16_t>()[v]);
      }
    }
  }

  Warper series(std::array{VolumeView(source)}, mesh, {.backend = GetParam()});
  Volume output = make_volume(grid, PixelType::int16);
  void* const data = output.data.data();
  for (const std::size_t node : {std::size_t{0}, std::size_t{300}, deformed.size() - 1}) {
    series.step(deformed, {.volumes = {&data, 1}, .holds_previous = true});
    deformed[node][1] += 0.75;  // a corner, then middle nodes alone
    series.step(deformed, {.volumes = {&data, 1}, .holds_previous = true});
    EXPECT_TRUE(output.data == run(source, mesh, deformed).volume.data) << node;
  }
}

TEST_P(WarpCurved, RefusesWhatItDoesNotMap) {
  const CurvedMesh mesh = cubes();
  const Volume source = scenes::wavy_volume(grid, PixelType::float32, 3);
  const auto refusal = [&](const WarpOptions& options) {
    return message_of([&] { run(source, mesh, mesh.mesh.rest_positions, options); });
  };
  const std::string end = ", which tetrahedra of ten nodes do not have; split them";
  EXPECT_EQ(refusal({.antialias = true}), "antialias averages by affine maps" + end);
  EXPECT_EQ(refusal({.intensity = Intensity::density}),
            "intensity density scales by affine maps" + end);
  EXPECT_EQ(refusal({.quantities = {Quantity::vector}}),
            "quantities of vectors and tensors turn by affine maps" + end);
  EXPECT_EQ(message_of([&] {
              Warper warper(std::array{VolumeView(source)}, mesh, {.backend = GetParam()});
              std::vector<float> forward(3 * volume_edge * volume_edge * volume_edge);
              Volume volume = make_volume(grid, PixelType::float32, 3);
              void* const data = volume.data.data();
              warper.step(mesh.mesh.rest_positions,
                          {.volumes = {&data, 1}, .fields = {.forward = forward.data()}});
            }),
            "target: the forward displacement is that of affine maps" + end);
  CurvedMesh bad = mesh;
  bad.mid_nodes[3][2] = 100000;
  EXPECT_EQ(message_of([&] { run(source, bad, mesh.mesh.rest_positions); }),
            "mesh: tetrahedron 3 has the middle node 100000, expected 0 to " +
                std::to_string(mesh.mesh.rest_positions.size() - 1) + ", or -1 for all six");
  bad.mid_nodes.pop_back();
  EXPECT_EQ(message_of([&] { run(source, bad, mesh.mesh.rest_positions); }),
            "mesh: middle nodes of 624 tetrahedra, expected none or 625");
}
}  // namespace
}  // namespace tetwarp::test
