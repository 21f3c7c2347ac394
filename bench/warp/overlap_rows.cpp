#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <tetwarp/page_lock.hpp>
#include <vector>

#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
constexpr std::size_t steps_per_job = 8;

struct OverlapCase {
  Workload workload;
  Backend backend;
  int threads;
};

/// A Warper and two buffers; even steps use the workload's own pose, odd ones another.
class TwoBuffers {
 public:
  TwoBuffers(const OverlapCase& row, const VolumeView& source)
      : scene_(inputs().scene(row.workload)),
        poses_{scene_.deformed, nudged_center(scene_.deformed, 1.0)},
        bytes_(static_cast<std::size_t>(scene_.output_grid.voxel_count()) * size_of(source.type)),
        warper_(std::span(&source, 1),
                scene_.mesh,
                {.output_grid = scene_.output_grid,
                 .backend = row.backend,
                 .threads = row.threads,
                 .expert = {.skip = {.unchanged_tets = false}}}) {
    for (std::size_t b = 0; b < 2; ++b) {
      buffers_[b] = Buffer(bytes_);
      pointers_[b] = buffers_[b].data();
      if (row.backend != Backend::cuda) continue;
      locks_[b] = PageLock(buffers_[b].data(), bytes_);
      if (!locks_[b].is_locked()) throw std::runtime_error("the output's pages cannot be locked");
    }
  }

  Counts even_step(std::int32_t* owner) {
    return warper_.step(poses_[0], {.volumes = {&pointers_[0], 1}, .owner = owner}).counts;
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
  const VolumeView source = inputs().image(row.workload);
  TwoBuffers in_flight(row, source), apart(row, source);
  const auto voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
  auto owner = std::make_unique_for_overwrite<std::int32_t[]>(voxels);
  const Counts counts = apart.even_step(owner.get());
  const StepCheck check =
      check_step(row.workload, source, Filter::linear, apart.output(0), owner.get(), counts);
  if (check.fault) return refuse(state, *check.fault);
  owner.reset();

  const std::function<void()> jobs[] = {[&] { in_flight.overlapped(); },
                                        [&] { apart.one_by_one(); }};
  for (const auto& job : jobs) job();
  std::vector<Timing> timings = time_in_turn(jobs, protocol_for(row.backend, row.threads));
  if (!in_flight.equals(apart)) return refuse(state, "overlapped steps differ from others");
  for (Timing& timing : timings) {
    for (double* time : {&timing.median, &timing.low, &timing.high, &timing.min}) {
      *time /= static_cast<double>(steps_per_job);
    }
  }
  count_beside(state, timings, "apart");
  state.counters["max_error"] = check.accuracy.max_error;
}
}  // namespace

void add_overlap_rows(const Selection& selection) {
  for (const Backend backend : selection.backends()) {
    if (backend == Backend::cpu && !selection.is_full()) continue;
    for (const Workload& workload : {waved(256, 5000), waved(256, 50000)}) {
      const OverlapCase row{workload, backend, selection.threads};
      add_row("overlap/" + workload.name + "/linear/float32/" + place_of(backend, row.threads),
              [row](benchmark::State& state) { run(state, row); });
    }
  }
}

}  // namespace tetwarp::bench
