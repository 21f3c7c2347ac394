/// @file fields.cpp
#include "bench/fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/inputs.hpp"
#include "bench/measure.hpp"
#include "bench/timing.hpp"

namespace tetwarp::bench {

namespace {

/// A field by name, and where a target has it.
struct FieldRow {
  const char* name;
  float* FieldTarget::*field;
  int components;
};
constexpr std::array field_rows{FieldRow{"displacement", &FieldTarget::displacement, 3},
                                FieldRow{"jacobian", &FieldTarget::jacobian, 1},
                                FieldRow{"gradient", &FieldTarget::gradient, 9},
                                FieldRow{"strain", &FieldTarget::strain, 6}};

/// Largest distance of a displacement from the exact one, where there is one to compare [voxel].
double displacement_error(const Workload& workload, const float* displacement) {
  const scenes::Scene& scene = inputs().scene(workload);
  const Truth& truth = inputs().truth(workload);
  const Grid& grid = scene.output_grid;
  double largest = 0;
  for (std::size_t v = 0; v < truth.voxels.size(); ++v) {
    if (truth.owners[v] < 0) continue;
    const std::int64_t at = truth.voxels[v];
    const Point3 from = scene.source_grid.world_of(truth.positions[v]);
    const Point3 to = grid.world_of({static_cast<double>(at % grid.dims[0]),
                                     static_cast<double>(at / grid.dims[0] % grid.dims[1]),
                                     static_cast<double>(at / (grid.dims[0] * grid.dims[1]))});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double found = displacement[3 * static_cast<std::size_t>(at) + axis];
      largest = std::max(largest, error_between(found, from[axis] - to[axis]));
    }
  }
  return largest;
}

void run(benchmark::State& state, const Workload& workload, const FieldRow& row, int threads) {
  const scenes::Scene& scene = inputs().scene(workload);
  const VolumeView source = inputs().image(workload, PixelType::float32, Image::textured);
  const auto voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
  const Buffer output(voxels * sizeof(float));
  const Buffer samples(voxels * static_cast<std::size_t>(row.components) * sizeof(float));
  auto* const field = reinterpret_cast<float*>(samples.data());
  void* const out = output.data();
  Warper warper(std::span(&source, 1), scene.mesh,
                {.output_grid = scene.output_grid,
                 .backend = Backend::cpu,
                 .threads = threads,
                 .skip = {.unchanged_tets = false}});
  std::int64_t covered = 0;
  const auto step = [&](float* to) {
    FieldTarget fields;
    fields.*row.field = to;
    covered = warper.step(scene.deformed, {.volumes = std::span(&out, 1), .fields = fields})
                  .counts.covered;
  };
  const std::function<void()> jobs[] = {[&] { step(field); }, [&] { step(nullptr); }};
  for (const auto& job : jobs) job();  // first touch
  if (row.field == &FieldTarget::displacement) {
    const double error = displacement_error(workload, field);
    if (!(error < 1e-4)) return refuse(state, "a displacement is off by 1e-4 voxel or more");
    state.counters["max_error"] = error;
  }
  const std::vector<Timing> timings =
      time_in_turn(jobs, {.busy_threads = static_cast<double>(threads)});
  count_timing(state, timings[0]);
  state.counters["plain"] = 1e3 * timings[1].median;
  state.counters["field_ns_per_covered"] =
      1e9 * (timings[0].median - timings[1].median) / static_cast<double>(covered);
}

}  // namespace

void register_field_rows(Extent extent, int threads) {
  for (const Workload& workload : {torso_700(), waved(256, 5000), waved(256, 500000)}) {
    if (workload.tet_count() > 5000 && extent != Extent::full) continue;
    for (const FieldRow& row : field_rows) {
      const std::string name =
          "fields/" + workload.name + "/" + row.name + "/cpu/threads:" + std::to_string(threads);
      benchmark::RegisterBenchmark(
          name.c_str(),
          [workload, row, threads](benchmark::State& state) { run(state, workload, row, threads); })
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace tetwarp::bench
