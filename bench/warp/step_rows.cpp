#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "bench/measure/device_floors.hpp"
#include "bench/measure/floors.hpp"
#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
/// A job, and what its construction and first step cost.
struct Subject {
  std::optional<WarpJob> job;
  double construct = 0;   ///< [s]
  double first_step = 0;  ///< [s]
  int steps = 0;          ///< timed ones
  StepReport last;
  Timings sum;  ///< of the timed steps

  explicit Subject(const StepCase& row) {
    const scenes::Scene& scene = inputs().scene(row.workload);
    const VolumeView source = inputs().image(row.workload, row.type, row.image, row.components);
    const WarpOptions options{.filter = row.filter,
                              .backend = row.backend,
                              .threads = row.threads,
                              .stage_times = true,
                              .expert = {.skip = row.skip}};
    construct = seconds_of([&] { job.emplace(scene, source, options); });
    first_step = seconds_of([&] { job->step(); });
  }

  void timed_step() {
    last = job->step();
    sum += last.timings;
    ++steps;
  }
};

/// Owners and counters of one step, and the check of this and of later outputs against them.
class Checked {
 public:
  Checked(benchmark::State& state, const StepCase& row, Subject& subject)
      : state_(state), row_(row), job_(*subject.job) {
    const auto voxels = static_cast<std::size_t>(job_.grid().voxel_count());
    owner_ = std::make_unique_for_overwrite<std::int32_t[]>(voxels);
    // Bytes that the step does not write must differ from earlier results.
    std::memset(job_.output(), 0xa5, job_.output_bytes());
    std::memset(owner_.get(), 0xa5, voxels * sizeof(std::int32_t));
    counts_ = job_.step({.volumes = {}, .owner = owner_.get()}).counts;
  }

  /// Refuses the row if the output is wrong now.
  bool is_right() {
    const StepCheck check =
        check_step(row_.workload, job_.source(), row_.filter, job_.output(), owner_.get(), counts_);
    accuracy_ = check.accuracy;
    if (check.fault) refuse(state_, *check.fault);
    return !check.fault;
  }

  const Accuracy& accuracy() const { return accuracy_; }

 private:
  benchmark::State& state_;
  const StepCase& row_;
  WarpJob& job_;
  std::unique_ptr<std::int32_t[]> owner_;
  Counts counts_;
  Accuracy accuracy_;
};

double copy_rate(int threads) {
  static std::map<int, double> rates;
  const auto [rate, is_new] = rates.try_emplace(threads, 0);
  if (is_new) rate->second = copy_bandwidth(threads);
  return rate->second;
}

void count_stages(benchmark::State& state, const Subject& subject) {
  const double scale = 1e3 / subject.steps;
  const Timings& sum = subject.sum;
  state.counters["construct"] = 1e3 * subject.construct;
  state.counters["first_step"] = 1e3 * subject.first_step;
  state.counters["mean"] = scale * sum.total;
  state.counters["upload"] = scale * sum.upload;
  state.counters["setup"] = scale * sum.setup;
  state.counters["mask"] = scale * sum.mask;
  state.counters["cull"] = scale * sum.cull;
  state.counters["raster"] = scale * sum.raster;
  state.counters["download"] = scale * sum.download;
  state.counters["kernel"] = scale * (sum.setup + sum.mask + sum.cull + sum.raster);
}

void count_work(benchmark::State& state, const Subject& subject, double median) {
  const Counts& counts = subject.last.counts;
  const auto covered = static_cast<double>(counts.covered);
  const auto voxels = static_cast<double>(counts.voxels);
  const auto pairs = std::max(1.0, static_cast<double>(counts.candidate_pairs));
  state.counters["components"] = subject.job->source().components;
  state.counters["ns_per_covered"] = 1e9 * median / covered;
  state.counters["ns_per_voxel"] = 1e9 * median / voxels;
  state.counters["tets"] = static_cast<double>(counts.tetrahedra);
  state.counters["voxels"] = voxels;
  state.counters["covered"] = covered;
  state.counters["tests_per_covered"] = static_cast<double>(counts.inside_tests) / covered;
  state.counters["rejected_share"] = static_cast<double>(counts.pairs_rejected) / pairs;
  state.counters["accepted_share"] = static_cast<double>(counts.pairs_accepted) / pairs;
  state.counters["exact_tests"] = static_cast<double>(counts.exact_tests);
  state.counters["constant_share"] =
      static_cast<double>(counts.cells_constant) / static_cast<double>(counts.cells);
  state.counters["copied"] = static_cast<double>(counts.voxels_copied);
}

void count_accuracy(benchmark::State& state, const Accuracy& accuracy) {
  state.counters["max_error"] = accuracy.max_error;
  state.counters["rms_error"] = accuracy.rms_error;
  state.counters["compared"] = static_cast<double>(accuracy.compared);
  state.counters["holes"] = static_cast<double>(accuracy.holes);
  state.counters["painted"] = static_cast<double>(accuracy.painted);
  state.counters["doubles"] = static_cast<double>(accuracy.doubles);
}

AffineJob floor_of(const StepCase& row, const Subject& subject, const Buffer& output) {
  const VolumeView& image = subject.job->source();
  return {row.type,   row.filter,    image.grid.dims,        subject.job->grid().dims,
          image.data, output.data(), floor_map(row.workload)};
}

/// Compares with the counters of the stages, which are mean times on the device.
void count_device_floor(benchmark::State& state, const AffineJob& job, double bytes) {
  static const double bandwidth = device_copy_bandwidth(0);
  const DeviceFloor floor = measure_device_floor(job, 0);
  const double kernel = state.counters["kernel"];
  state.counters["kernel_copies"] = kernel + state.counters["upload"] + state.counters["download"];
  state.counters["floor"] = 1e3 * floor.kernel;
  state.counters["floor_copies"] = 1e3 * floor.with_copies;
  state.counters["floor_ratio"] = kernel / (1e3 * floor.kernel);
  state.counters["copy_ratio"] = kernel * 1e-3 * bandwidth / bytes;
  state.SetLabel(floor.layout);
}

void count_row(benchmark::State& state, const Subject& subject, const Timing& timing) {
  count_timing(state, timing);
  count_stages(state, subject);
  count_work(state, subject, timing.median);
}

/// Times steps in turn with the same steps with all switches on.
void run_beside_whole(benchmark::State& state, const StepCase& row, Subject& subject) {
  StepCase with = row;
  with.skip = {};
  Subject whole(with);
  if (std::memcmp(whole.job->output(), subject.job->output(), subject.job->output_bytes()) != 0) {
    return refuse(state, "a switch changes the output");
  }
  const std::function<void()> jobs[] = {[&] { subject.timed_step(); }, [&] { whole.timed_step(); }};
  const std::vector<Timing> timings =
      time_in_turn(jobs, protocol_for(row.backend, row.threads, subject.first_step));
  count_row(state, subject, timings[0]);
  state.counters["with"] = 1e3 * timings[1].median;
  state.counters["saved"] = 1 - timings[1].median / timings[0].median;
}

/// Times steps in turn with the sampling floor; on a device the floor is timed after the steps.
void run_beside_floor(benchmark::State& state, const StepCase& row, Subject& subject) {
  std::vector<std::function<void()>> jobs = {[&] { subject.timed_step(); }};
  const bool has_floor = row.backend != Backend::reference && row.components == 1;
  const Buffer floor_output(has_floor ? subject.job->output_bytes() : 0);
  const AffineJob floor = floor_of(row, subject, floor_output);
  if (has_floor && row.backend == Backend::cpu) {
    for (const RowOrder order : {RowOrder::lines, RowOrder::bundles}) {
      jobs.emplace_back([&, order] { sample_affine(floor, order, row.threads); });
      jobs.back()();  // first touch
    }
  }
  const std::vector<Timing> timings =
      time_in_turn(jobs, protocol_for(row.backend, row.threads, subject.first_step));
  count_row(state, subject, timings[0]);
  if (!has_floor) return;
  const auto bytes = static_cast<double>(subject.job->output_bytes()) +
                     static_cast<double>(subject.job->source().grid.voxel_count()) *
                         static_cast<double>(size_of(row.type));
  if (row.backend == Backend::cuda) return count_device_floor(state, floor, bytes);
  const double median = timings[0].median;
  const double sampling = std::min(timings[1].median, timings[2].median);
  state.counters["floor"] = 1e3 * sampling;
  state.counters["floor_ratio"] = median / sampling;
  state.counters["copy_ratio"] = median * copy_rate(row.threads) / bytes;
}

void run(benchmark::State& state, const StepCase& row) {
  Subject subject(row);
  Checked checked(state, row, subject);
  if (!checked.is_right()) return;
  (row.without.empty() ? run_beside_floor : run_beside_whole)(state, row, subject);
  if (!checked.is_right()) return;
  count_accuracy(state, checked.accuracy());
}
}  // namespace

void add_step_rows(const Selection& selection) {
  for (const StepCase& row : step_cases(selection)) {
    add_row(name_of(row), [row](benchmark::State& state) { run(state, row); });
  }
}

}  // namespace tetwarp::bench
