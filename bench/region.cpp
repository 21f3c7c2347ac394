/// @file region.cpp
#include "bench/region.hpp"

#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/inputs.hpp"
#include "bench/measure.hpp"
#include "bench/timing.hpp"

namespace tetwarp::bench {

namespace {

struct RegionCase {
  Workload workload;
  Backend backend;
  int threads;
};

Region middle_of(const Grid& grid) {
  Region region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    region.begin[axis] = grid.dims[axis] / 4;
    region.end[axis] = grid.dims[axis] / 4 + grid.dims[axis] / 2;
  }
  return region;
}

/// A warper and its output.
struct Job {
  const scenes::Scene& scene;
  Warper warper;
  Buffer output;
  std::int64_t covered = 0;  ///< voxels in the last step

  Job(const RegionCase& row, const VolumeView& source, const std::optional<Region>& region)
      : scene(inputs().scene(row.workload)),
        warper(std::span(&source, 1),
               scene.mesh,
               {.output_grid = scene.output_grid,
                .region = region,
                .backend = row.backend,
                .threads = row.threads,
                .skip = {.unchanged_tets = false}}),
        output(static_cast<std::size_t>(warper.output_grid().voxel_count()) * sizeof(float)) {}

  void step() {
    void* const out = output.data();
    covered = warper.step(scene.deformed, {.volumes = std::span(&out, 1)}).counts.covered;
  }
};

/// The samples of the region are those of the whole grid there.
bool is_part_of(const Job& part, const Job& whole, const Region& region) {
  const Grid &grid = whole.scene.output_grid, &cut = part.warper.output_grid();
  const auto row_bytes = static_cast<std::size_t>(cut.dims[0]) * sizeof(float);
  const std::byte* row = part.output.data();
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j, row += row_bytes) {
      const std::int64_t at = (k * grid.dims[1] + j) * grid.dims[0] + region.begin[0];
      const std::byte* expected = whole.output.data() + at * std::int64_t{sizeof(float)};
      if (std::memcmp(row, expected, row_bytes) != 0) return false;
    }
  }
  return true;
}

void run(benchmark::State& state, const RegionCase& row) {
  const VolumeView source = inputs().image(row.workload, PixelType::float32, Image::textured);
  const Region region = middle_of(inputs().scene(row.workload).output_grid);
  Job part(row, source, region), whole(row, source, std::nullopt);
  const std::function<void()> jobs[] = {[&] { part.step(); }, [&] { whole.step(); }};
  for (const auto& job : jobs) job();  // first touch
  if (!is_part_of(part, whole, region)) {
    return refuse(state, "a region differs from the whole there");
  }
  const std::vector<Timing> timings = time_in_turn(
      jobs, {.busy_threads = row.backend == Backend::cpu ? static_cast<double>(row.threads) : 0.0});
  count_timing(state, timings[0]);
  state.counters["whole"] = 1e3 * timings[1].median;
  state.counters["cost_share"] = timings[0].median / timings[1].median;
  state.counters["voxel_share"] = static_cast<double>(part.warper.output_grid().voxel_count()) /
                                  static_cast<double>(whole.scene.output_grid.voxel_count());
  state.counters["covered_share"] =
      static_cast<double>(part.covered) / static_cast<double>(whole.covered);
}

}  // namespace

void register_region_rows(int threads, bool with_cuda) {
  std::vector<Backend> backends = {Backend::cpu};
  if (with_cuda) backends.push_back(Backend::cuda);
  for (const Backend backend : backends) {
    const RegionCase row{rotated(256), backend, threads};
    std::string name = "region/" + row.workload.name + "/linear/float32/" + name_of(backend);
    if (backend == Backend::cpu) name += "/threads:" + std::to_string(threads);
    benchmark::RegisterBenchmark(name.c_str(), [row](benchmark::State& state) { run(state, row); })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace tetwarp::bench
