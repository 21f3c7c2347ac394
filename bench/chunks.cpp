/// @file chunks.cpp
#include "bench/chunks.hpp"

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "bench/inputs.hpp"
#include "bench/measure.hpp"
#include "bench/timing.hpp"

namespace tetwarp::bench {

namespace {

Volume warped(const Workload& workload, int threads) {
  const scenes::Scene& scene = inputs().scene(workload);
  const VolumeView source = inputs().image(workload, PixelType::float32, Image::textured);
  Volume volume{.grid = scene.output_grid, .data = {}};
  volume.data.resize(volume.byte_count());
  Warper warper(std::span(&source, 1), scene.mesh,
                {.output_grid = scene.output_grid, .backend = Backend::cpu, .threads = threads});
  void* const out = volume.data.data();
  warper.step(scene.deformed, {.volumes = std::span(&out, 1)});
  return volume;
}

/// A file that is written again and again, and goes in the end.
class ChunkedFile {
 public:
  ChunkedFile(const std::string& name, const Volume& volume, bool skips)
      : path_(std::filesystem::temp_directory_path() / name), volume_(volume), skips_(skips) {}
  ~ChunkedFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ChunkedFile(const ChunkedFile&) = delete;
  ChunkedFile& operator=(const ChunkedFile&) = delete;

  void write() {
    written_ = write_volumes(path_.string(), {&volume_}, {.skip_background_chunks = skips_});
  }
  bool holds_the_volume() const { return read_volume(path_.string()).data == volume_.data; }
  const WrittenFile& written() const { return written_; }

 private:
  std::filesystem::path path_;
  const Volume& volume_;
  bool skips_;
  WrittenFile written_;
};

void run(benchmark::State& state, const Workload& workload, int threads) {
  const Volume volume = warped(workload, threads);
  ChunkedFile sparse("tetwarp_bench_sparse.vtkhdf", volume, true);
  ChunkedFile whole("tetwarp_bench_whole.vtkhdf", volume, false);
  const std::function<void()> jobs[] = {[&] { sparse.write(); }, [&] { whole.write(); }};
  for (const auto& job : jobs) job();
  if (!sparse.holds_the_volume() || !whole.holds_the_volume()) {
    return refuse(state, "a file differs from the volume written to it");
  }
  // Half of the time is waiting for the disk.
  const std::vector<Timing> timings = time_in_turn(jobs, {.busy_threads = 0.0});
  count_timing(state, timings[0]);
  const auto megabytes = [](const WrittenFile& file) {
    return 1e-6 * static_cast<double>(file.bytes);
  };
  state.counters["whole"] = 1e3 * timings[1].median;
  state.counters["cost_share"] = timings[0].median / timings[1].median;
  state.counters["background_share"] = static_cast<double>(sparse.written().chunks_background) /
                                       static_cast<double>(sparse.written().chunks);
  state.counters["megabytes"] = megabytes(sparse.written());
  state.counters["whole_megabytes"] = megabytes(whole.written());
}

}  // namespace

void register_chunk_rows(int threads) {
  const Workload workload = rotated(256);
  const std::string name = "chunks/" + workload.name + "/linear/float32/cpu/threads:1";
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) { run(state, workload, threads); })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace tetwarp::bench
