#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <string>

#include "bench/measure/floors.hpp"
#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

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

/// Share of wrong labels among covered voxels.
double wrong_share(const scenes::Scene& scene, const std::uint8_t* labels) {
  const Grid& grid = scene.output_grid;
  const AffineRows map = turned_about_middle(scene.source_grid, grid, std::numbers::pi / 4);
  const auto n = static_cast<double>(scene.source_grid.dims[0]);
  std::int64_t covered = 0, wrong = 0;
#pragma omp parallel for schedule(static) reduction(+ : covered, wrong)
  for (std::int64_t voxel = 0; voxel < grid.voxel_count(); ++voxel) {
    if (labels[voxel] == 0) continue;
    ++covered;
    wrong += labels[voxel] != label_at(mapped(map, position_of(voxel, grid)), n);
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
  WarpJob job(scene, source, {.filter = filter, .backend = Backend::cpu, .threads = threads});
  const std::function<void()> step = [&] { job.step(); };
  step();  // first touch
  const double wrong = wrong_share(scene, reinterpret_cast<const std::uint8_t*>(job.output()));
  if (!(wrong < 12.0 / static_cast<double>(n))) {
    return refuse(state, "more wrong labels than a surface half a voxel off would make");
  }
  const Timing timing =
      time_in_turn(std::span(&step, 1), protocol_for(Backend::cpu, threads)).front();
  count_timing(state, timing);
  state.counters["wrong_share"] = wrong;
  state.counters["ns_per_covered"] = 1e9 * timing.median / static_cast<double>(job.covered());
}
}  // namespace

void add_label_rows(const Selection& selection) {
  const int threads = selection.threads;
  for (const std::int64_t n : {64, 128, 256}) {
    if (n == 256 && !selection.is_full()) continue;
    for (const Filter filter : {Filter::nearest, Filter::labels}) {
      add_row("labels/" + std::to_string(n) + "/" + name_of(filter) + "/uint8/" +
                  place_of(Backend::cpu, threads),
              [=](benchmark::State& state) { run(state, n, filter, threads); });
    }
  }
}

}  // namespace tetwarp::bench
