#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
/// A field by name, its member of FieldTarget, and its components per voxel.
struct FieldRow {
  const char* name;
  float* FieldTarget::*field;
  int components;
};
constexpr std::array field_rows{FieldRow{"displacement", &FieldTarget::displacement, 3},
                                FieldRow{"jacobian", &FieldTarget::jacobian, 1},
                                FieldRow{"gradient", &FieldTarget::gradient, 9},
                                FieldRow{"strain", &FieldTarget::strain, 6}};

void run(benchmark::State& state, const Workload& workload, const FieldRow& row, int threads) {
  WarpJob job(inputs().scene(workload), inputs().image(workload),
              {.backend = Backend::cpu, .threads = threads});
  const auto voxels = static_cast<std::size_t>(job.grid().voxel_count());
  const Buffer samples(voxels * static_cast<std::size_t>(row.components) * sizeof(float));
  FieldTarget field;
  field.*row.field = reinterpret_cast<float*>(samples.data());
  const std::function<void()> jobs[] = {[&] { job.step({.volumes = {}, .fields = field}); },
                                        [&] { job.step(); }};
  for (const auto& step : jobs) step();  // first touch
  const std::vector<Timing> timings = time_in_turn(jobs, protocol_for(Backend::cpu, threads));
  count_timing(state, timings[0]);
  state.counters["plain"] = 1e3 * timings[1].median;
  state.counters["field_ns_per_covered"] =
      1e9 * (timings[0].median - timings[1].median) / static_cast<double>(job.covered());
}
}  // namespace

void add_field_rows(const Selection& selection) {
  const int threads = selection.threads;
  for (const Workload& workload : {torso_700(), waved(256, 5000), waved(256, 500000)}) {
    if (workload.tet_count() > 5000 && !selection.is_full()) continue;
    for (const FieldRow& row : field_rows) {
      add_row("fields/" + workload.name + "/" + row.name + "/" + place_of(Backend::cpu, threads),
              [=](benchmark::State& state) { run(state, workload, row, threads); });
    }
  }
}

}  // namespace tetwarp::bench
