/// @file test_warp_arguments.cpp
/// Bad arguments throw with one sentence that names them; progress is reported and can cancel a
/// step.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/error.hpp>

#include "host/base/warp_backend.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
const double nan = std::numeric_limits<double>::quiet_NaN();

/// A valid warp of 8^3 voxels; tests make one argument invalid.
struct Call {
  Volume source = scenes::wavy_volume(scenes::unit_grid(8, 8, 8), PixelType::int16);
  Mesh mesh = covering_mesh(source.grid);
  std::vector<Point3> deformed = mesh.rest_positions;
  WarpOptions options = [] {
    WarpOptions cpu;
    cpu.backend = Backend::cpu;
    return cpu;
  }();

  void run() const { warp(source, mesh, deformed, options); }
  std::string complaint() const {
    return test::message_of([this] { run(); });
  }
};

TEST(WarpArguments, GoodOnesThrowNothing) {
  EXPECT_EQ(Call().complaint(), "");
}

TEST(WarpArguments, NameTheMesh) {
  Call none, wild, infinite, far, wide;
  none.mesh.tets.clear();
  wild.mesh.tets[2][1] = 99999;
  infinite.mesh.rest_positions[3][2] = nan;
  far.mesh.rest_positions[5][0] = 0x1p41;
  wide.mesh.rest_positions[0][0] = -0x1p21;

  EXPECT_EQ(none.complaint(), "mesh: no tetrahedra or hexahedra");
  EXPECT_EQ(wild.complaint(), "mesh: tetrahedron 2 refers to node 99999, expected 0 to 79");
  EXPECT_EQ(infinite.complaint(), "mesh: rest position of node 3 is not finite");
  EXPECT_EQ(far.complaint(),
            "mesh: rest position of node 5 is over 2^40 voxels from the source grid");
  EXPECT_EQ(wide.complaint(), "mesh: tetrahedron 0 spans over 2^20 voxels of the source at rest");
}

TEST(WarpArguments, NameTheDeformedPositions) {
  Call few, infinite, far, wide;
  few.deformed.pop_back();
  infinite.deformed[4][1] = nan;
  far.deformed[0][0] = 0x1p41;
  wide.deformed[0][0] = -0x1p21;

  EXPECT_EQ(few.complaint(), "deformed positions: expected 80 nodes as at rest, got 79");
  EXPECT_EQ(infinite.complaint(), "deformed positions: node 4 is not finite");
  EXPECT_EQ(far.complaint(),
            "deformed positions: a node of tetrahedron 0 is not finite or over 2^40 voxels from "
            "the output grid");
  EXPECT_EQ(wide.complaint(),
            "deformed positions: tetrahedron 0 spans over 2^20 voxels; use a coarser output grid");
}

TEST(WarpArguments, NameTheReferencesLimitsToo) {
  Call far, wide;
  far.options.backend = wide.options.backend = Backend::reference;
  far.deformed[0][0] = 0x1p41;
  wide.deformed[0][0] = -0x1p21;

  EXPECT_EQ(far.complaint(), "a node is over 2^40 voxels from the grid");
  EXPECT_EQ(wide.complaint(), "a tetrahedron spans over 2^20 voxels; use a coarser grid");
}

/// 2^25 cells, each in the box of 128 tetrahedra. Refused before anything is written.
TEST(WarpArguments, NameTheLimitOfPairs) {
  Call call;
  call.options.output_grid = scenes::unit_grid(4096, 4096, 1024);
  call.mesh.rest_positions = {{-1, -1, -1}, {4097, -1, -1}, {-1, 4097, -1}, {-1, -1, 4097}};
  call.mesh.tets.assign(128, {0, 1, 2, 3});
  Warper warper(call.source, call.mesh, call.options);
  std::array<std::int16_t, 1> never_written = {};
  void* const data = never_written.data();

  EXPECT_EQ(
      message_of([&] { warper.step(call.mesh.rest_positions, {.volumes = std::span(&data, 1)}); }),
      "mesh: 4294967296 pairs of tetrahedron and cell, at most 2^32 - 2 fit; compute "
      "regions of the grid");
}

TEST(WarpArguments, NameTheSource) {
  const Call call;
  const VolumeView good = call.source;
  const auto complaint_of = [&](const std::vector<VolumeView>& sources) {
    return message_of([&] { Warper(sources, call.mesh, call.options); });
  };
  VolumeView elsewhere = good, many = good, empty = good, on_device = good;
  elsewhere.grid.origin = {1, 0, 0};
  many.components = 10;
  empty.data = nullptr;
  on_device.memory = Memory::device;

  EXPECT_EQ(complaint_of({}), "sources: no volume");
  EXPECT_EQ(complaint_of({good, elsewhere}),
            "sources: volumes on different grids; warp them one by one");
  EXPECT_EQ(complaint_of({many}), "source: 10 components, expected 1 to 9");
  EXPECT_EQ(complaint_of({empty}), "source: no samples");
  EXPECT_EQ(complaint_of({on_device}), "source: device memory needs back end cuda");
}

TEST(WarpArguments, NameThePixelType) {
  Call wide, infinite;
  wide.source = make_volume(wide.source.grid, PixelType::int64);
  infinite.options.background = nan;

  EXPECT_EQ(wide.complaint(),
            "source: int64 cannot be interpolated without loss; use the nearest filter");
  EXPECT_EQ(infinite.complaint(), "background: not a finite number, which int16 cannot hold");
}

TEST(WarpArguments, NameArraysThatAreNotLabels) {
  Call real, several;
  real.source = make_volume(real.source.grid, PixelType::float32);
  several.source = make_volume(several.source.grid, PixelType::uint8, 3);
  real.options.filter = several.options.filter = Filter::labels;

  EXPECT_EQ(real.complaint(), "source: float32 holds no labels; use another filter or integers");
  EXPECT_EQ(several.complaint(), "source: 3 components, labels have one; use the nearest filter");
}

TEST(WarpArguments, NameTheOptions) {
  Call empty, outside, threads, many_threads;
  empty.options.region = Region{{2, 3, 4}, {3, 3, 5}};
  outside.options.region = Region{{2, 3, 4}, {3, 4, 9}};
  threads.options.threads = -1;
  many_threads.options.threads = 100000;

  EXPECT_EQ(empty.complaint(), "region: 3 to 3 on axis 1 is empty or not within 0 to 8");
  EXPECT_EQ(outside.complaint(), "region: 4 to 9 on axis 2 is empty or not within 0 to 8");
  EXPECT_EQ(threads.complaint(), "threads: -1, expected 0 (all cores) to 1024");
  EXPECT_EQ(many_threads.complaint(), "threads: 100000, expected 0 (all cores) to 1024");
}

TEST(WarpArguments, NameTheGrid) {
  const auto complaint_of = [](const std::function<void(Grid&)>& spoil) {
    Call call;
    Grid grid = call.source.grid;
    spoil(grid);
    call.options.output_grid = grid;
    return call.complaint();
  };

  EXPECT_EQ(complaint_of([](Grid& g) { g.dims[1] = 0; }),
            "output grid: 0 voxels on axis 1, expected 1 to 2^30");
  EXPECT_EQ(complaint_of([](Grid& g) { g.spacing[0] = -1; }),
            "output grid: spacing -1.000000 on axis 0, expected a positive number");
  EXPECT_EQ(complaint_of([](Grid& g) { g.origin[2] = nan; }),
            "output grid: origin is not finite on axis 2");
  EXPECT_EQ(complaint_of([](Grid& g) { g.direction[4] = nan; }),
            "output grid: direction is not finite");
  EXPECT_EQ(complaint_of([](Grid& g) { g.direction[4] = 0; }),
            "output grid: direction is singular, expected three independent axes");
  EXPECT_EQ(complaint_of([](Grid& g) {
              g.dims = {1 << 30, 1 << 30, 1};
            }),
            "output grid: more than 2^59 voxels");
}

TEST(WarpArguments, NameTheVolume) {
  Volume volume = make_volume(scenes::unit_grid(2, 2, 2), PixelType::uint8, 1, "ct");

  EXPECT_EQ(message_of([&] { volume.samples<float>(); }), "volume 'ct' holds uint8, not float32");
  volume.data.resize(7);
  EXPECT_EQ(message_of([&] { VolumeView{volume}; }), "volume 'ct' holds 7 bytes, its grid needs 8");
  EXPECT_EQ(message_of([] { make_volume(scenes::unit_grid(2, 2, 2), PixelType::uint8, 0); }),
            "volume: 0 components, expected 1 to 9");
}

TEST(WarpArguments, NameTheTarget) {
  const Call call;
  Warper warper(call.source, call.mesh, call.options);
  Volume output = make_volume(call.source.grid, call.source.type);
  std::array<void*, 2> pointers = {output.data.data(), nullptr};
  const auto complaint_of = [&](const WarpTarget& target) {
    return message_of([&] { warper.step(call.deformed, target); });
  };
  WarpTarget on_device{.volumes = std::span(pointers).first(1)}, streamed = on_device;
  on_device.memory = Memory::device;
  streamed.stream = &output;
  const PositionsView device_positions(call.deformed.front().data(), 80, Memory::device);

  EXPECT_EQ(complaint_of({.volumes = pointers}),
            "target: expected one output per source, 1, got 2");
  EXPECT_EQ(complaint_of({.volumes = std::span(pointers).last(1)}), "target: an output is null");
  const std::string on_cuda = "device memory and streams need back end cuda";
  EXPECT_EQ(complaint_of(on_device), on_cuda);
  EXPECT_EQ(complaint_of(streamed), on_cuda);
  EXPECT_EQ(message_of([&] { warper.step(device_positions); }), on_cuda);

  Call elsewhere;
  elsewhere.options.output_grid = elsewhere.source.grid;
  elsewhere.options.output_grid->origin[1] += 1;
  Warper other(elsewhere.source, elsewhere.mesh, elsewhere.options);
  std::vector<float> forward(3 * static_cast<std::size_t>(output.grid.voxel_count()));
  EXPECT_EQ(message_of([&] {
              other.step(elsewhere.deformed, {.volumes = std::span(pointers).first(1),
                                              .fields = {.forward = forward.data()}});
            }),
            "target: the forward field is on the source grid, which the output grid is not; leave "
            "out output_grid or the field");
}

TEST(WarpArguments, OneNewVolumeCannotHoldSeveralSources) {
  const Call call;
  const std::array<VolumeView, 2> sources = {call.source, call.source};
  Warper warper(sources, call.mesh, call.options);

  EXPECT_EQ(message_of([&] { warper.step(call.deformed); }),
            "step into a new volume: the Warper has several sources");
}

TEST(WarpArguments, CudaWithoutADeviceGivesTheReason) {
  const BackendStatus status = cuda_status(0);
  if (status.usable) GTEST_SKIP() << "there is " << status.device;
  Call call;
  call.options.backend = Backend::cuda;
  EXPECT_EQ(message_of<CudaError>([&] { call.run(); }),
            "back end cuda: " + status.reason + "; use cpu or auto");
  call.options.backend = Backend::automatic;
  const Warper warper(call.source, call.mesh, call.options);
  EXPECT_EQ(warper.report().backend, Backend::cpu);
  EXPECT_EQ(warper.report().backend_reason, "no usable CUDA device (" + status.reason + ")");
}

class WarpProgress : public ::testing::TestWithParam<Backend> {};
INSTANTIATE_TEST_SUITE_P(Backends,
                         WarpProgress,
                         ::testing::Values(Backend::cpu, Backend::reference),
                         [](const auto& info) { return name_of(info.param); });

TEST_P(WarpProgress, RisesToOneAndChangesNothing) {
  Call call;
  call.options.backend = GetParam();
  Warper warper(call.source, call.mesh, call.options);
  std::vector<double> fractions;

  const Warped watched = run_step(warper, call.source, call.deformed, [&](double fraction) {
    fractions.push_back(fraction);
    return true;
  });

  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_GE(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
  EXPECT_EQ(watched.volume.data, run_step(warper, call.source, call.deformed).volume.data);
}

TEST_P(WarpProgress, StopsAStepAndTheNextOneIsWhole) {
  Call call;
  call.options.backend = GetParam();
  Warper warper(call.source, call.mesh, call.options);
  int calls = 0;

  EXPECT_THROW(run_step(warper, call.source, call.deformed, [&](double) { return ++calls < 2; }),
               Cancelled);

  EXPECT_EQ(calls, 2);
  EXPECT_TRUE(warper.report().steps.empty());
  EXPECT_EQ(run_step(warper, call.source, call.deformed).volume.data, call.source.data);
}
}  // namespace
}  // namespace tetwarp::test
