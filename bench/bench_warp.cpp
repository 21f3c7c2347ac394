/// @file bench_warp.cpp
/// Time of one warp step, memory to memory, setup included, no files. Every case is checked against
/// the reference on the owners of all voxels of a small twin before it is timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <tetwarp/tetwarp.hpp>
#include <vector>

#include "tests/scenes.hpp"

namespace {

using namespace tetwarp;

/// A workload: a lattice in a volume of `dims`, deformed.
struct WarpCase {
  const char* name;
  std::array<std::int64_t, 3> dims;
  std::array<int, 3> cells;
  bool rotated;  ///< by 45 degrees about two axes, the grid grown to hold it; else waved
};

constexpr WarpCase cases[] = {
    {"torso_256x160x122", {256, 160, 122}, {7, 5, 4}, false},
    {"rotated_128", {128, 128, 128}, {6, 6, 6}, true},
    {"rotated_256", {256, 256, 256}, {6, 6, 6}, true},
    {"waved_256", {256, 256, 256}, {10, 10, 10}, false},
    {"waved_256", {256, 256, 256}, {20, 20, 25}, false},
};

/// The scene of a case at a share of its size.
scenes::Scene make_scene(const WarpCase& c, int shrink) {
  scenes::Scene scene;
  scene.source_grid = scenes::unit_grid(c.dims[0] / shrink, c.dims[1] / shrink, c.dims[2] / shrink);
  Point3 high, centre;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    high[axis] = static_cast<double>(scene.source_grid.dims[axis]) - 0.5;
    centre[axis] = (high[axis] - 0.5) / 2;
  }
  scene.mesh = scenes::lattice(c.cells, {-0.5, -0.5, -0.5}, high);
  scene.deformed = c.rotated ? scenes::rotated_45_45(scene.mesh.rest_positions, centre)
                             : scenes::waved(scene.mesh.rest_positions, 12.0 / shrink, 5);
  scene.output_grid = scene.source_grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = 0, top = 0;
    for (const Point3& p : scene.deformed) {
      low = std::min(low, p[axis]);
      top = std::max(top, p[axis]);
    }
    scene.output_grid.origin[axis] = std::ceil(low);
    scene.output_grid.dims[axis] = static_cast<std::int64_t>(std::floor(top) - std::ceil(low)) + 1;
  }
  return scene;
}

/// Largest difference from the reference over a small twin, and whether all owners agree.
struct Check {
  bool owners_agree;
  double max_error;
};
Check check(const WarpCase& c, Backend backend) {
  const scenes::Scene scene = make_scene(c, 4);
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  const std::size_t voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
  std::vector<float> values[2];
  std::vector<std::int32_t> owners[2];
  const Backend both[2] = {Backend::reference, backend};
  for (std::size_t b = 0; b < 2; ++b) {
    values[b].resize(voxels);
    owners[b].resize(voxels);
    Warper warper(source, scene.mesh, {.output_grid = scene.output_grid, .backend = both[b]});
    void* const out = values[b].data();
    warper.step(scene.deformed, {.volumes = std::span(&out, 1), .tet = owners[b].data()});
  }
  Check result{owners[0] == owners[1], 0};
  for (std::size_t v = 0; v < voxels; ++v) {
    const double error = std::abs(double{values[0][v]} - double{values[1][v]});
    result.max_error = std::max(result.max_error, error);
  }
  return result;
}

void run(benchmark::State& state,
         const WarpCase& c,
         Backend backend,
         int threads,
         const SkipOptions& skip = {}) {
  const Check checked = check(c, backend);
  if (!checked.owners_agree || checked.max_error > 1e-5) {
    state.SkipWithError("wrong result: not timed");
    return;
  }
  const scenes::Scene scene = make_scene(c, 1);
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  Volume output = make_volume(scene.output_grid, source.type);
  void* const out = output.data.data();
  Warper warper(
      source, scene.mesh,
      {.output_grid = scene.output_grid, .backend = backend, .threads = threads, .skip = skip});
  const WarpTarget target{.volumes = std::span(&out, 1)};
  warper.step(scene.deformed, target);  // first touch, buffers
  StepReport step;
  Timings sum;
  for (auto _ : state) {
    step = warper.step(scene.deformed, target);
    state.SetIterationTime(step.timings.total);
    sum += step.timings;
  }
  const double steps = static_cast<double>(state.iterations());
  const double covered = static_cast<double>(step.counts.covered);
  const auto pairs = static_cast<double>(step.counts.candidate_pairs);
  state.counters["max_error"] = checked.max_error;
  state.counters["tets"] = static_cast<double>(step.counts.tetrahedra);
  state.counters["ns_per_covered"] = 1e9 * sum.total / steps / covered;
  state.counters["tests_per_covered"] = static_cast<double>(step.counts.inside_tests) / covered;
  state.counters["rejected_share"] = static_cast<double>(step.counts.pairs_rejected) / pairs;
  state.counters["setup_ms"] = 1e3 * sum.setup / steps;
  state.counters["mask_ms"] = 1e3 * sum.mask / steps;
  state.counters["cull_ms"] = 1e3 * sum.cull / steps;
  state.counters["raster_ms"] = 1e3 * sum.raster / steps;
  state.counters["download_ms"] = 1e3 * sum.download / steps;
}

}  // namespace

int main(int argc, char** argv) {
  const BackendStatus cuda = available_backends().front();
  for (const WarpCase& c : cases) {
    const int tets = 5 * c.cells[0] * c.cells[1] * c.cells[2];
    const std::string name = std::string(c.name) + "/" + std::to_string(tets);
    for (const int threads : {1, 2}) {
      const std::string row = name + "/cpu/" + std::to_string(threads);
      benchmark::RegisterBenchmark(
          row.c_str(),
          [&c, threads](benchmark::State& state) { run(state, c, Backend::cpu, threads); })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
    benchmark::RegisterBenchmark((name + "/cpu/2/no_culling").c_str(),
                                 [&c](benchmark::State& state) {
                                   run(state, c, Backend::cpu, 2,
                                       {.rejected_cells = false, .accepted_cells = false});
                                 })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
    if (!cuda.usable) continue;
    benchmark::RegisterBenchmark((name + "/cuda").c_str(),
                                 [&c](benchmark::State& state) { run(state, c, Backend::cuda, 0); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  }
  if (!cuda.usable) std::fprintf(stderr, "cuda: not measured: %s\n", cuda.reason.c_str());
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
