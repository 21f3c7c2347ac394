#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include "bench/peers/paper_device.hpp"
#include "bench/peers/peer.hpp"
#include "bench/warp/figure_cases.hpp"
#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"

namespace tetwarp::bench {
namespace {
/// Why a result is not one of float32 tests without exact decisions, or nothing. A voxel that is
/// zero counts as not covered.
std::optional<std::string> fault_in(const Workload& workload,
                                    const VolumeView& source,
                                    const float* output,
                                    Accuracy& found) {
  const Truth& truth = inputs().truth(workload);
  for (std::size_t v = 0; v < truth.voxels.size(); ++v) {
    const float value = output[truth.voxels[v]];
    const bool is_covered = truth.owners[v] >= 0;
    found.holes += is_covered && value == 0;
    found.painted += !is_covered && value != 0;
    ++found.compared;
    if (!is_covered || value == 0) continue;
    const auto expected = sample_truth(source, Filter::linear, truth.positions[v]);
    if (expected) found.max_error = std::max(found.max_error, error_between(value, *expected));
  }
  // Of 56 million covered voxels 42 thousand were holes; a neighbor's map was off by 0.009.
  if (found.holes + found.painted > found.compared / 200) return "too many holes";
  if (!(found.max_error < 0.02)) return "samples at wrong places";
  return std::nullopt;
}

void run(benchmark::State& state, const PaperCase& row) {
  const scenes::Scene& scene = inputs().scene(row.workload);
  const VolumeView source = inputs().image(row.workload);
  Buffer output(static_cast<std::size_t>(scene.output_grid.voxel_count()) * sizeof(float));
  auto* const samples = reinterpret_cast<float*>(output.data());
  const PeerInput input{scene, static_cast<const float*>(source.data), samples, row.threads,
                        nullptr};
  const bool on_device = row.backend == Backend::cuda;
  PaperCounts counts;
  PaperDeviceSteps steps{on_device ? PeerStep() : paper_method(input, row.with_cells, &counts),
                         [] {}};
  if (on_device) steps = paper_method_on_device(input, row.with_cells);
  const double first = seconds_of(steps.step);
  steps.fetch();
  Accuracy accuracy;
  if (const auto fault = fault_in(row.workload, source, samples, accuracy)) {
    return refuse(state, *fault);
  }
  const Protocol protocol = on_device ? Protocol{.repetitions = 51, .attempts = 51, .seconds = 5}
                                      : protocol_for(row.backend, row.threads, first);
  count_timing(state, time_in_turn(std::span(&steps.step, 1), protocol).front());
  state.counters["voxels"] = static_cast<double>(scene.output_grid.voxel_count());
  state.counters["tets"] = static_cast<double>(row.workload.tet_count());
  state.counters["holes"] = static_cast<double>(accuracy.holes);
  state.counters["painted"] = static_cast<double>(accuracy.painted);
  state.counters["compared"] = static_cast<double>(accuracy.compared);
  state.counters["max_error"] = accuracy.max_error;
  if (on_device) return;
  const auto tested = static_cast<double>(counts.tested);
  state.counters["tested"] = tested;
  state.counters["pass_share"] = static_cast<double>(counts.passed) / tested;
  if (!row.with_cells) return;
  state.counters["culled_share"] =
      1 - static_cast<double>(counts.drawn) / static_cast<double>(counts.cells);
}
}  // namespace

void add_paper_rows(const Selection& selection) {
  for (const PaperCase& row : paper_cases(selection)) {
    add_row(name_of(row), [row](benchmark::State& state) { run(state, row); });
  }
}

}  // namespace tetwarp::bench
