/// @file labels.cpp
#include "bench/labels.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <string>

#include "bench/floors.hpp"
#include "bench/inputs.hpp"
#include "bench/measure.hpp"
#include "bench/timing.hpp"

namespace tetwarp::bench {

namespace {

/// The label at x [voxel of a grid of n per axis], 1 to 8.
int label_at(const Point3& x, double n) {
  double wave = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double turns = (3.0 + static_cast<double>(axis)) * (x[axis] + 0.5) / n;
    wave += std::sin(2 * std::numbers::pi * turns + static_cast<double>(axis));
  }
  return 1 + static_cast<int>(std::floor(8 * (wave + 3) / 6.0001));
}

Point3 position_of(std::int64_t voxel, const Grid& grid) {
  return {static_cast<double>(voxel % grid.dims[0]),
          static_cast<double>(voxel / grid.dims[0] % grid.dims[1]),
          static_cast<double>(voxel / (grid.dims[0] * grid.dims[1]))};
}

/// Share of wrong labels among covered voxels.
double wrong_share(const scenes::Scene& scene, const std::uint8_t* labels) {
  const Grid& grid = scene.output_grid;
  const AffineRows map = turned_about_middle(scene.source_grid, grid, std::numbers::pi / 4);
  const auto n = static_cast<double>(scene.source_grid.dims[0]);
  std::int64_t covered = 0, wrong = 0;
#pragma omp parallel for schedule(static) reduction(+ : covered, wrong)
  for (std::int64_t voxel = 0; voxel < grid.voxel_count(); ++voxel) {
    if (labels[voxel] == 0) continue;
    const Point3 at = position_of(voxel, grid);
    Point3 x;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      x[axis] = map[axis][0] * at[0] + map[axis][1] * at[1] + map[axis][2] * at[2] + map[axis][3];
    }
    ++covered;
    wrong += labels[voxel] != label_at(x, n);
  }
  return static_cast<double>(wrong) / static_cast<double>(covered);
}

void run(benchmark::State& state, std::int64_t n, Filter filter, int threads) {
  const scenes::Scene& scene = inputs().scene(rotated(n));
  const Grid& grid = scene.source_grid;
  const Buffer samples(static_cast<std::size_t>(grid.voxel_count()));
  auto* const labels = reinterpret_cast<std::uint8_t*>(samples.data());
  for (std::int64_t voxel = 0; voxel < grid.voxel_count(); ++voxel) {
    labels[voxel] =
        static_cast<std::uint8_t>(label_at(position_of(voxel, grid), static_cast<double>(n)));
  }
  const VolumeView source{grid, PixelType::uint8, 1, labels, Memory::host};
  const Buffer output(static_cast<std::size_t>(scene.output_grid.voxel_count()));
  void* const out = output.data();
  Warper warper(std::span(&source, 1), scene.mesh,
                {.filter = filter,
                 .output_grid = scene.output_grid,
                 .backend = Backend::cpu,
                 .threads = threads});
  StepReport report;
  const std::function<void()> step = [&] {
    report = warper.step(scene.deformed, {.volumes = std::span(&out, 1)});
  };
  step();  // first touch
  const double wrong = wrong_share(scene, reinterpret_cast<const std::uint8_t*>(output.data()));
  if (!(wrong < 12.0 / static_cast<double>(n))) {
    return refuse(state, "more wrong labels than a surface half a voxel off would make");
  }
  const Timing timing =
      time_in_turn(std::span(&step, 1), {.busy_threads = static_cast<double>(threads)}).front();
  count_timing(state, timing);
  state.counters["wrong_share"] = wrong;
  state.counters["ns_per_covered"] =
      1e9 * timing.median / static_cast<double>(report.counts.covered);
}

}  // namespace

void register_label_rows(Extent extent, int threads) {
  for (const std::int64_t n : {64, 128, 256}) {
    if (n == 256 && extent != Extent::full) continue;
    for (const Filter filter : {Filter::nearest, Filter::labels}) {
      const std::string name = "labels/" + std::to_string(n) + "/" + name_of(filter) +
                               "/uint8/cpu/threads:" + std::to_string(threads);
      benchmark::RegisterBenchmark(name.c_str(),
                                   [=](benchmark::State& state) { run(state, n, filter, threads); })
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace tetwarp::bench
