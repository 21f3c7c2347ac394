#include <algorithm>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <tetwarp/page_lock.hpp>
#include <utility>
#include <vector>

#include "bench/measure/copy_ways.hpp"
#include "bench/measure/device_memory.hpp"
#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
constexpr std::size_t mebibyte = std::size_t{1} << 20;

double gigabytes_per_second(std::size_t bytes, double seconds) {
  return 1e-9 * static_cast<double>(bytes) / seconds;
}

WarpOptions options_for(const scenes::Scene& scene) {
  return {.output_grid = scene.output_grid,
          .backend = Backend::cuda,
          .expert = {.skip = {.unchanged_tets = false}}};
}

double seconds_to_construct(const scenes::Scene& scene, const VolumeView& source) {
  std::optional<Warper> warper;
  return seconds_of([&] { warper.emplace(std::span(&source, 1), scene.mesh, options_for(scene)); });
}

/// A Warper with outputs in three places.
class CopyJob {
 public:
  CopyJob(const scenes::Scene& scene, const VolumeView& source)
      : scene_(scene),
        bytes_(static_cast<std::size_t>(scene.output_grid.voxel_count()) * size_of(source.type)),
        warper_(std::span(&source, 1), scene.mesh, options_for(scene)),
        pageable_(bytes_),
        locked_(bytes_),
        resident_(bytes_) {}

  void to_pageable() { step(pageable_.data(), Memory::host); }
  void to_locked() { step(locked_.data(), Memory::host); }
  void to_device() { step(resident_.data(), Memory::device); }
  /// Touches the pages, too. @returns whether they are locked
  bool lock() {
    lock_ = PageLock(locked_.data(), bytes_);
    return lock_.is_locked();
  }

  std::size_t bytes() const { return bytes_; }
  const std::byte* output() const { return pageable_.data(); }
  bool is_same() const {
    std::vector<std::byte> resident(bytes_);
    resident_.get(resident.data());
    return std::memcmp(pageable_.data(), locked_.data(), bytes_) == 0 &&
           std::memcmp(pageable_.data(), resident.data(), bytes_) == 0;
  }

 private:
  void step(void* volume, Memory memory) {
    warper_.step(scene_.deformed, {.volumes = {&volume, 1}, .memory = memory});
  }

  const scenes::Scene& scene_;
  std::size_t bytes_;
  Warper warper_;
  Buffer pageable_, locked_;
  DeviceMemory resident_;
  PageLock lock_;
};

void run_step(benchmark::State& state, const Workload& workload) {
  const scenes::Scene& scene = inputs().scene(workload);
  const VolumeView source = inputs().image(workload);
  const std::size_t source_bytes =
      static_cast<std::size_t>(source.grid.voxel_count()) * size_of(source.type);
  const double construct = seconds_to_construct(scene, source);
  CopyJob job(scene, source);
  const double first_step = seconds_of([&] { job.to_pageable(); });
  bool is_locked = false;
  const double lock = seconds_of([&] { is_locked = job.lock(); });
  if (!is_locked) return refuse(state, "the output's pages cannot be locked");
  const std::function<void()> jobs[] = {[&] { job.to_pageable(); }, [&] { job.to_locked(); },
                                        [&] { job.to_device(); }};
  for (const auto& one : jobs) one();
  if (!job.is_same()) return refuse(state, "outputs in different memory differ");
  const std::vector<Timing> timings = time_in_turn(jobs, protocol_for(Backend::cuda, 0));
  const double resident = timings[2].median;
  const auto rate = [&](const Timing& timing) {
    return gigabytes_per_second(job.bytes(), std::max(1e-9, timing.median - resident));
  };
  count_timing(state, timings[0]);
  state.counters["locked"] = 1e3 * timings[1].median;
  state.counters["resident"] = 1e3 * resident;
  state.counters["rate"] = rate(timings[0]);
  state.counters["locked_rate"] = rate(timings[1]);
  state.counters["rate_share"] = rate(timings[0]) / rate(timings[1]);
  state.counters["construct"] = 1e3 * construct;
  state.counters["first_step"] = 1e3 * first_step;
  state.counters["lock"] = 1e3 * lock;
  const PageLock source_lock(const_cast<void*>(source.data), source_bytes);
  state.counters["construct_locked"] = 1e3 * seconds_to_construct(scene, source);
}

struct RingCase {
  std::size_t mebibytes;
  CopyDirection direction;
  RingShape shape;
  bool is_untouched = false;
};

std::string name_of(const RingCase& row) {
  const std::string direction = row.direction == CopyDirection::to_host ? "to_host" : "to_device";
  return "staging/" + direction + (row.is_untouched ? "_untouched_" : "_") +
         std::to_string(row.mebibytes) + "/" + std::to_string(row.shape.slots) + "x" +
         std::to_string(row.shape.slot_bytes / mebibyte) +
         "/cuda/threads:" + std::to_string(row.shape.threads);
}

void run_ring(benchmark::State& state, const RingCase& row) {
  const std::size_t bytes = row.mebibytes * mebibyte;
  CopyWays ways(bytes, row.direction, row.shape);
  if (!ways.is_right()) return refuse(state, "the ring copies other bytes");
  std::vector<std::function<void()>> jobs = {
      [&] { row.is_untouched ? ways.staged_untouched() : ways.staged(); },
      [&] { row.is_untouched ? ways.by_runtime_untouched() : ways.by_runtime(); },
      [&] { ways.locked(); }};
  const std::vector<Timing> timings = time_in_turn(jobs, {.attempts = 15, .seconds = 2});
  count_timing(state, timings[0]);
  const char* const names[] = {"rate", "runtime_rate", "locked_rate"};
  for (std::size_t way = 0; way < 3; ++way) {
    state.counters[names[way]] = gigabytes_per_second(bytes, timings[way].median);
  }
  state.counters["rate_share"] = timings[2].median / timings[0].median;
  state.counters["lock"] = 1e3 * seconds_of([&] { ways.lock(); });
}

/// The ring as it is, and other sizes and numbers of threads.
std::vector<RingCase> ring_cases(int threads) {
  const RingShape usual = usual_ring();
  std::vector<RingCase> cases;
  for (const CopyDirection direction : {CopyDirection::to_host, CopyDirection::to_device}) {
    for (const std::size_t mebibytes : {4, 8, 30, 512}) {
      cases.push_back({mebibytes, direction, usual});
    }
    for (const int count : {1, 2, 4, 6, 12, 16}) {
      if (count <= threads)
        cases.push_back({512, direction, {usual.slot_bytes, usual.slots, count}});
    }
    for (const auto& [slots, slot] :
         std::vector<std::pair<std::int64_t, std::size_t>>{{24, 1}, {8, 2}, {12, 2}, {12, 4}}) {
      cases.push_back({512, direction, {slot * mebibyte, slots, usual.threads}});
    }
  }
  cases.push_back({512, CopyDirection::to_host, usual, true});
  return cases;
}
}  // namespace

void add_copy_rows(const Selection& selection) {
  if (!selection.with_cuda) return;
  for (const Workload& workload : {torso_700(), rotated(256), rotated(384), waved(256, 5000)}) {
    add_row("copies/" + workload.name + "/linear/float32/cuda",
            [workload](benchmark::State& state) { run_step(state, workload); });
  }
  for (const RingCase& row : ring_cases(selection.threads)) {
    add_row(name_of(row), [row](benchmark::State& state) { run_ring(state, row); });
  }
}

}  // namespace tetwarp::bench
