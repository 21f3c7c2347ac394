#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
struct SeriesCase {
  Workload workload;
  int moved_percent;
  Backend backend;
  int threads;
};

/// A Warper that steps alternately to two poses of the mesh.
class Swing {
 public:
  Swing(const SeriesCase& row, const VolumeView& source, bool is_update)
      : scene_(inputs().scene(row.workload)),
        poses_{scene_.deformed, nudged_center(scene_.deformed, 0.01 * row.moved_percent)},
        bytes_(static_cast<std::size_t>(scene_.output_grid.voxel_count()) * size_of(source.type)),
        output_(bytes_),
        is_update_(is_update),
        warper_(std::span(&source, 1),
                scene_.mesh,
                {.output_grid = scene_.output_grid,
                 .backend = row.backend,
                 .threads = row.threads,
                 .expert = {.skip = {.unchanged_tets = is_update}}}) {}

  /// Steps to the other pose.
  void step(std::int32_t* owner = nullptr) {
    void* const out = output_.data();
    last_ =
        warper_.step(poses_[pose_],
                     {.volumes = std::span(&out, 1), .owner = owner, .holds_previous = is_update_});
    pose_ = 1 - pose_;
  }

  const Counts& counts() const { return last_.counts; }
  const std::byte* output() const { return output_.data(); }
  bool equals(const Swing& other) const {
    return std::memcmp(output_.data(), other.output_.data(), bytes_) == 0;
  }

 private:
  const scenes::Scene& scene_;
  std::array<std::vector<Point3>, 2> poses_;
  std::size_t bytes_;
  Buffer output_;
  bool is_update_;
  Warper warper_;
  std::size_t pose_ = 0;
  StepReport last_;
};

void run(benchmark::State& state, const SeriesCase& row) {
  const scenes::Scene& scene = inputs().scene(row.workload);
  const VolumeView source = inputs().image(row.workload);
  Swing update(row, source, true), whole(row, source, false);
  update.step();
  const auto voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
  auto owner = std::make_unique_for_overwrite<std::int32_t[]>(voxels);
  whole.step(owner.get());  // the first pose is the workload's own, whose truth is known
  const StepCheck check =
      check_step(row.workload, source, Filter::linear, whole.output(), owner.get(), whole.counts());
  if (check.fault) return refuse(state, *check.fault);
  owner.reset();

  const std::function<void()> jobs[] = {[&] { update.step(); }, [&] { whole.step(); }};
  for (int warm_up = 0; warm_up < 2; ++warm_up) {
    for (const auto& job : jobs) job();
  }
  // A small update is not work for all threads, so that one busy processor is enough.
  const std::vector<Timing> timings = time_in_turn(jobs, protocol_for(row.backend, 1));
  const Counts counts = update.counts();
  for (int pose = 0; pose < 2; ++pose) {
    if (!update.equals(whole)) return refuse(state, "an update differs from a whole step");
    for (const auto& job : jobs) job();
  }
  count_beside(state, timings, "whole");
  const auto share = [](std::int64_t kept, std::int64_t all) {
    return 1 - static_cast<double>(kept) / static_cast<double>(all);
  };
  state.counters["tets_moved"] = share(counts.tets_unchanged, counts.tetrahedra);
  state.counters["cells_touched"] = share(counts.cells_unchanged, counts.cells);
  state.counters["max_error"] = check.accuracy.max_error;
}
}  // namespace

void add_series_rows(const Selection& selection) {
  std::vector<int> percents = {0, 5};
  if (selection.is_full()) percents = {0, 1, 5, 20, 60, 100};
  for (const Backend backend : selection.backends()) {
    for (const int percent : percents) {
      const SeriesCase row{waved(384, 50000), percent, backend, selection.threads};
      add_row("series/" + row.workload.name + "/moved:" + std::to_string(percent) +
                  "/linear/float32/" + place_of(backend, row.threads),
              [row](benchmark::State& state) { run(state, row); });
    }
  }
}

}  // namespace tetwarp::bench
