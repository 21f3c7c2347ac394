/// @file measure.cpp
#include "bench/measure.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "bench/device_floors.hpp"
#include "bench/floors.hpp"
#include "bench/inputs.hpp"
#include "bench/timing.hpp"
#include "bench/truth.hpp"

namespace tetwarp::bench {

namespace {

/// A warper, its output, and what its first steps cost.
struct Subject {
  const scenes::Scene& scene;
  VolumeView source;
  Buffer output;
  std::optional<Warper> warper;
  double construct = 0;   ///< [s]
  double first_step = 0;  ///< [s]
  int steps = 0;          ///< timed ones
  StepReport last;
  Timings sum;  ///< of the timed steps

  explicit Subject(const WarpCase& row)
      : scene(inputs().scene(row.workload)),
        source(inputs().image(row.workload, row.type, row.image, row.components)),
        output(output_bytes()) {
    WarpOptions options{.filter = row.filter,
                        .output_grid = scene.output_grid,
                        .backend = row.backend,
                        .threads = row.threads,
                        .skip = row.skip};
    // The same positions again and again must be a whole step each time.
    options.skip.unchanged_tets = false;
    construct = seconds_of([&] { warper.emplace(std::span(&source, 1), scene.mesh, options); });
    first_step = seconds_of([&] { step(); });
  }

  std::size_t output_bytes() const {
    return static_cast<std::size_t>(scene.output_grid.voxel_count() * source.components) *
           size_of(source.type);
  }

  StepReport step(std::int32_t* tet = nullptr) {
    void* const out = output.data();
    return warper->step(scene.deformed, {.volumes = std::span(&out, 1), .owner = tet});
  }

  void timed_step() {
    last = step();
    sum += last.timings;
    ++steps;
  }
};

/// Refuses a wrong result, before it is timed and after; the accuracy of a right one.
class Checked {
 public:
  Checked(benchmark::State& state, const WarpCase& row, Subject& subject)
      : state_(state), row_(row), subject_(subject) {
    const auto voxels = static_cast<std::size_t>(subject.scene.output_grid.voxel_count());
    tet_ = std::make_unique_for_overwrite<std::int32_t[]>(voxels);
    // What the step leaves unwritten must not look like an earlier result.
    std::memset(subject.output.data(), 0xa5, subject.output_bytes());
    std::memset(tet_.get(), 0xa5, voxels * sizeof(std::int32_t));
    counts_ = subject.step(tet_.get()).counts;
  }

  bool is_right() {
    const Truth& truth = inputs().truth(row_.workload);
    accuracy_ = compare(truth, subject_.source, row_.filter, subject_.output.data(), tet_.get());
    const auto fault = fault_of(accuracy_, error_bound(row_.type, row_.filter), counts_,
                                subject_.scene, tet_.get());
    if (!fault) return true;
    refuse(state_, *fault);
    return false;
  }

  const Accuracy& accuracy() const { return accuracy_; }

 private:
  benchmark::State& state_;
  const WarpCase& row_;
  Subject& subject_;
  std::unique_ptr<std::int32_t[]> tet_;
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
  state.counters["components"] = subject.source.components;
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

/// The floor's map: the workload's own where it is one map, else a turn by five degrees.
AffineJob floor_of(const WarpCase& row, const Subject& subject, const Buffer& output) {
  const bool turned = row.workload.deformation == Deformation::rotation;
  const double angle = turned ? std::numbers::pi / 4 : std::numbers::pi / 36;
  const Grid &source = subject.source.grid, &target = subject.scene.output_grid;
  return {row.type,
          row.filter,
          source.dims,
          target.dims,
          subject.source.data,
          output.data(),
          turned_about_middle(source, target, angle)};
}

/// Beside the counters of the stages, which are mean times on the device.
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

Protocol protocol_of(const WarpCase& row) {
  return {.busy_threads = row.backend == Backend::cpu ? static_cast<double>(row.threads) : 0.0};
}

/// In turn with the same step, everything on: what the switch saves.
void run_beside_whole(benchmark::State& state, const WarpCase& row, Subject& subject) {
  WarpCase with = row;
  with.skip = {};
  Subject whole(with);
  if (std::memcmp(whole.output.data(), subject.output.data(), subject.output_bytes()) != 0) {
    return refuse(state, "a switch changes the output");
  }
  const std::function<void()> jobs[] = {[&] { subject.timed_step(); }, [&] { whole.timed_step(); }};
  const std::vector<Timing> timings = time_in_turn(jobs, protocol_of(row));
  count_row(state, subject, timings[0]);
  state.counters["with"] = 1e3 * timings[1].median;
  state.counters["saved"] = 1 - timings[1].median / timings[0].median;
}

/// In turn with the sampling floor; on a device, and of one component, the floor comes after.
void run_beside_floor(benchmark::State& state, const WarpCase& row, Subject& subject) {
  std::vector<std::function<void()>> jobs = {[&] { subject.timed_step(); }};
  const bool has_floor = row.backend != Backend::reference && row.components == 1;
  const Buffer floor_output(has_floor ? subject.output_bytes() : 0);
  const AffineJob floor = floor_of(row, subject, floor_output);
  if (has_floor && row.backend == Backend::cpu) {
    for (const RowOrder order : {RowOrder::lines, RowOrder::bundles}) {
      jobs.emplace_back([&, order] { sample_affine(floor, order, row.threads); });
      jobs.back()();  // first touch
    }
  }
  const std::vector<Timing> timings = time_in_turn(jobs, protocol_of(row));
  count_row(state, subject, timings[0]);
  if (!has_floor) return;
  const auto bytes = static_cast<double>(subject.output_bytes()) +
                     static_cast<double>(subject.source.grid.voxel_count()) *
                         static_cast<double>(size_of(row.type));
  if (row.backend == Backend::cuda) return count_device_floor(state, floor, bytes);
  const double median = timings[0].median;
  const double sampling = std::min(timings[1].median, timings[2].median);
  state.counters["floor"] = 1e3 * sampling;
  state.counters["floor_ratio"] = median / sampling;
  state.counters["copy_ratio"] = median * copy_rate(row.threads) / bytes;
}

void run(benchmark::State& state, const WarpCase& row) {
  Subject subject(row);
  Checked checked(state, row, subject);
  if (!checked.is_right()) return;
  (row.without.empty() ? run_beside_floor : run_beside_whole)(state, row, subject);
  if (!checked.is_right()) return;
  count_accuracy(state, checked.accuracy());
}

}  // namespace

void register_row(const WarpCase& row) {
  benchmark::RegisterBenchmark(name_of(row).c_str(),
                               [row](benchmark::State& state) { run(state, row); })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace tetwarp::bench
