#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
Region middle_of(const Grid& grid) {
  Region region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    region.begin[axis] = grid.dims[axis] / 4;
    region.end[axis] = grid.dims[axis] / 4 + grid.dims[axis] / 2;
  }
  return region;
}

/// The samples of the region are those of the whole grid there.
bool is_part_of(const WarpJob& part, const WarpJob& whole, const Region& region) {
  const Grid &grid = whole.grid(), &cut = part.grid();
  const auto row_bytes = static_cast<std::size_t>(cut.dims[0]) * sizeof(float);
  const std::byte* row = part.output();
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j, row += row_bytes) {
      const std::int64_t at = (k * grid.dims[1] + j) * grid.dims[0] + region.begin[0];
      const std::byte* expected = whole.output() + at * std::int64_t{sizeof(float)};
      if (std::memcmp(row, expected, row_bytes) != 0) return false;
    }
  }
  return true;
}

void run(benchmark::State& state, const Workload& workload, WarpOptions options) {
  const scenes::Scene& scene = inputs().scene(workload);
  const VolumeView source = inputs().image(workload);
  const Region region = middle_of(scene.output_grid);
  WarpJob whole(scene, source, options);
  options.region = region;
  WarpJob part(scene, source, options);
  const std::function<void()> jobs[] = {[&] { part.step(); }, [&] { whole.step(); }};
  for (const auto& job : jobs) job();  // first touch
  if (!is_part_of(part, whole, region)) {
    return refuse(state, "a region differs from the whole there");
  }
  count_beside(state, time_in_turn(jobs, protocol_for(options.backend, options.threads)), "whole");
  state.counters["voxel_share"] = static_cast<double>(part.grid().voxel_count()) /
                                  static_cast<double>(whole.grid().voxel_count());
  state.counters["covered_share"] =
      static_cast<double>(part.covered()) / static_cast<double>(whole.covered());
}
}  // namespace

void add_region_rows(const Selection& selection) {
  for (const Backend backend : selection.backends()) {
    const WarpOptions options{.backend = backend, .threads = selection.threads};
    add_row(
        "region/" + rotated(256).name + "/linear/float32/" + place_of(backend, selection.threads),
        [options](benchmark::State& state) { run(state, rotated(256), options); });
  }
}

}  // namespace tetwarp::bench
