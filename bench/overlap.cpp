/// @file overlap.cpp
#include "bench/overlap.hpp"

#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <tetwarp/page_lock.hpp>
#include <vector>

#include "bench/inputs.hpp"
#include "bench/measure.hpp"
#include "bench/timing.hpp"
#include "bench/truth.hpp"

namespace tetwarp::bench {

namespace {

constexpr std::size_t steps_per_job = 8;

struct OverlapCase {
  Workload workload;
  Backend backend;
  int threads;
};

/// A warper and two buffers; even steps are the workload's own pose, odd ones another.
class TwoBuffers {
 public:
  TwoBuffers(const OverlapCase& row, const VolumeView& source)
      : scene_(inputs().scene(row.workload)),
        poses_{scene_.deformed, nudged_centre(scene_.deformed, 1.0)},
        bytes_(static_cast<std::size_t>(scene_.output_grid.voxel_count()) * size_of(source.type)),
        warper_(std::span(&source, 1),
                scene_.mesh,
                {.output_grid = scene_.output_grid,
                 .backend = row.backend,
                 .threads = row.threads,
                 .skip = {.unchanged_tets = false}}) {
    for (std::size_t b = 0; b < 2; ++b) {
      buffers_[b] = Buffer(bytes_);
      pointers_[b] = buffers_[b].data();
      if (row.backend == Backend::cuda) locks_[b] = PageLock(buffers_[b].data(), bytes_);
    }
  }

  Counts even_step(std::int32_t* tet) {
    return warper_.step(poses_[0], {.volumes = {&pointers_[0], 1}, .owner = tet}).counts;
  }

  void one_by_one() {
    for (std::size_t s = 0; s < steps_per_job; ++s) warper_.step(poses_[s % 2], target(s));
  }

  void overlapped() {
    for (std::size_t s = 0; s < steps_per_job; ++s) {
      warper_.begin_step(poses_[s % 2], target(s));
      if (s > 0) warper_.finish_step();
    }
    warper_.finish_step();
  }

  const std::byte* output(std::size_t buffer) const { return buffers_[buffer].data(); }
  bool equals(const TwoBuffers& other) const {
    return std::memcmp(output(0), other.output(0), bytes_) == 0 &&
           std::memcmp(output(1), other.output(1), bytes_) == 0;
  }

 private:
  WarpTarget target(std::size_t step) const { return {.volumes = {&pointers_[step % 2], 1}}; }

  const scenes::Scene& scene_;
  std::array<std::vector<Point3>, 2> poses_;
  std::size_t bytes_;
  std::array<Buffer, 2> buffers_;
  std::array<void*, 2> pointers_{};
  std::array<PageLock, 2> locks_;
  Warper warper_;
};

void run(benchmark::State& state, const OverlapCase& row) {
  const scenes::Scene& scene = inputs().scene(row.workload);
  const VolumeView source = inputs().image(row.workload, PixelType::float32, Image::textured);
  TwoBuffers in_flight(row, source), apart(row, source);
  const auto voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
  auto tet = std::make_unique_for_overwrite<std::int32_t[]>(voxels);
  const Counts counts = apart.even_step(tet.get());
  const Accuracy accuracy =
      compare(inputs().truth(row.workload), source, Filter::linear, apart.output(0), tet.get());
  const auto fault =
      fault_of(accuracy, error_bound(source.type, Filter::linear), counts, scene, tet.get());
  if (fault) return refuse(state, *fault);
  tet.reset();

  const std::function<void()> jobs[] = {[&] { in_flight.overlapped(); },
                                        [&] { apart.one_by_one(); }};
  for (const auto& job : jobs) job();
  std::vector<Timing> timings = time_in_turn(
      jobs, {.busy_threads = row.backend == Backend::cpu ? static_cast<double>(row.threads) : 0.0});
  if (!in_flight.equals(apart)) return refuse(state, "overlapped steps differ from others");
  for (Timing& timing : timings) {
    for (double* time : {&timing.median, &timing.low, &timing.high, &timing.min}) {
      *time /= static_cast<double>(steps_per_job);
    }
  }
  count_timing(state, timings[0]);
  state.counters["apart"] = 1e3 * timings[1].median;
  state.counters["cost_share"] = timings[0].median / timings[1].median;
  state.counters["max_error"] = accuracy.max_error;
}

}  // namespace

void register_overlap_rows(Extent extent, int threads, bool with_cuda) {
  std::vector<Backend> backends;
  if (extent == Extent::full) backends.push_back(Backend::cpu);
  if (with_cuda) backends.push_back(Backend::cuda);
  for (const Backend backend : backends) {
    for (const Workload& workload : {waved(256, 5000), waved(256, 50000)}) {
      const OverlapCase row{workload, backend, threads};
      std::string name = "overlap/" + workload.name + "/linear/float32/" + name_of(backend);
      if (backend == Backend::cpu) name += "/threads:" + std::to_string(threads);
      benchmark::RegisterBenchmark(name.c_str(),
                                   [row](benchmark::State& state) { run(state, row); })
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace tetwarp::bench
