#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
Volume warped(const Workload& workload, int threads) {
  WarpJob job(inputs().scene(workload), inputs().image(workload),
              {.backend = Backend::cpu, .threads = threads});
  job.step();
  return {.grid = job.grid(), .data = {job.output(), job.output() + job.output_bytes()}};
}

/// A temporary file that is written repeatedly and removed at the end.
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
  // Half of the time the processor waits for the disk, so all repetitions count.
  count_beside(state, time_in_turn(jobs, {.busy_threads = 0.0}), "whole");
  const auto megabytes = [](const WrittenFile& file) {
    return 1e-6 * static_cast<double>(file.bytes);
  };
  state.counters["background_share"] = static_cast<double>(sparse.written().chunks_background) /
                                       static_cast<double>(sparse.written().chunks);
  state.counters["megabytes"] = megabytes(sparse.written());
  state.counters["whole_megabytes"] = megabytes(whole.written());
}
}  // namespace

void add_chunk_rows(const Selection& selection) {
  add_row("chunks/" + rotated(256).name + "/linear/float32/cpu/threads:1",
          [threads = selection.threads](benchmark::State& state) {
            run(state, rotated(256), threads);
          });
}

}  // namespace tetwarp::bench
