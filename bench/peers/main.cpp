/// @file main.cpp
/// tetwarp_bench_peers: one warp step by tetwarp and by other programs, on the same inputs in the
/// same memory, float32, linear, all threads.
///
/// usage: tetwarp_bench_peers RESULTS.json [WORKLOAD]
/// WORKLOAD selects those whose name contains it. `bench/report tables` prints the file.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#include <tetwarp/tetwarp.hpp>

#include "bench/found.hpp"
#include "bench/measure/program.hpp"
#include "bench/measure/timing.hpp"
#include "bench/peers/peer.hpp"
#include "bench/warp/warp_job.hpp"

namespace {
using namespace tetwarp;
using namespace tetwarp::bench;

constexpr int rounds = 3;
constexpr std::int64_t field_voxels = 100'000'000;  ///< a larger dense field is left out

/// Median of `repetitions` after one call that is not timed; of one where a call takes seconds.
double milliseconds_of(const PeerStep& step, int repetitions) {
  if (seconds_of(step) > 5) repetitions = 1;
  const Protocol protocol{.repetitions = repetitions, .attempts = repetitions};
  return 1e3 * time_in_turn(std::span(&step, 1), protocol).front().median;
}

/// Difference of a program's output from the truth: its errors, holes and painted voxels. The
/// output has no owners; a voxel that is not zero counts as covered.
nlohmann::json difference(const Workload& workload, const VolumeView& source, const float* output) {
  const Truth& truth = inputs().truth(workload);
  std::int64_t holes = 0, painted = 0;
  double max_error = 0;
  for (std::size_t v = 0; v < truth.voxels.size(); ++v) {
    const float value = output[truth.voxels[v]];
    const bool is_covered = truth.owners[v] >= 0;
    holes += is_covered && value == 0;
    painted += !is_covered && value != 0;
    if (!is_covered || value == 0) continue;
    const auto expected = sample_truth(source, Filter::linear, truth.positions[v]);
    if (expected) max_error = std::max(max_error, error_between(value, *expected));
  }
  return {{"max_error", max_error},
          {"compared", truth.voxels.size()},
          {"holes", holes},
          {"painted", painted}};
}

/// Runs all programs on one workload.
class Row {
 public:
  Row(const Workload& workload, int threads)
      : workload_(workload),
        scene_(inputs().scene(workload)),
        source_(inputs().image(workload)),
        job_(scene_, source_, {.backend = Backend::cpu, .threads = threads}),
        output_(job_.output_bytes()),
        input_{scene_, static_cast<const float*>(source_.data),
               reinterpret_cast<float*>(output_.data()), threads, nullptr} {
    result_ = {{"workload", workload.name}, {"tetrahedra", workload.tet_count()}};
  }

  nlohmann::json measure() {
    step_beside_floor();
    add("scanline_probe", scanline_probe(input_));
    add("paper_method", paper_method(input_, false));
    const double whole = result_["paper_method_ms"];
    add("paper_method", paper_method(input_, true));
    result_["paper_method_ms"] = std::min<double>(whole, result_["paper_method_ms"]);
    if constexpr (has_vtk) add("vtk_locator", vtk_locator(input_));
    if (has_itk && scene_.output_grid.voxel_count() <= field_voxels) {
      const Buffer field = displacement_field();
      input_.displacement = reinterpret_cast<const float*>(field.data());
      if constexpr (has_itk) add("itk_warp_dense_field_given", itk_warp(input_));
    }
    return result_;
  }

 private:
  /// Rounds of floor and tetwarp in turn, so that both run in the same state of the machine.
  void step_beside_floor() {
    const AffineJob floor{PixelType::float32,      Filter::linear, scene_.source_grid.dims,
                          scene_.output_grid.dims, source_.data,   output_.data(),
                          floor_map(workload_)};
    const auto floor_in = [&](RowOrder order) {
      return milliseconds_of([&] { sample_affine_avx512(floor, order, input_.threads); }, 5);
    };
    for (int round = 0; round < rounds; ++round) {
      result_["floor_ms"].push_back(
          std::min(floor_in(RowOrder::lines), floor_in(RowOrder::bundles)));
      result_["tetwarp_ms"].push_back(milliseconds_of([&] { job_.step(); }, 9));
    }
    result_["covered"] = job_.covered();
    const auto* const output = reinterpret_cast<const float*>(job_.output());
    result_["differences"]["tetwarp"] = difference(workload_, source_, output);
  }

  void add(const std::string& name, const PeerStep& step) {
    result_[name + "_ms"] = milliseconds_of(step, 5);
    result_["differences"][name] = difference(workload_, source_, input_.output);
  }

  /// See PeerInput::displacement.
  Buffer displacement_field() {
    const auto voxels = static_cast<std::size_t>(scene_.output_grid.voxel_count());
    Buffer field(3 * voxels * sizeof(float));
    auto* const vectors = reinterpret_cast<float*>(field.data());
    std::vector<std::int32_t> owner(voxels);
    job_.step({.volumes = {}, .owner = owner.data(), .fields = {.displacement = vectors}});
    for (std::size_t v = 0; v < voxels; ++v) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto origin = static_cast<float>(scene_.output_grid.origin[axis]);
        float& d = vectors[3 * v + axis];
        d = owner[v] < 0 ? 1e6f : d + origin;
      }
    }
    return field;
  }

  const Workload& workload_;
  const scenes::Scene& scene_;
  VolumeView source_;
  WarpJob job_;
  Buffer output_;
  PeerInput input_;
  nlohmann::json result_;
};

std::string today() {
  const std::time_t now = std::time(nullptr);
  char text[16];
  std::strftime(text, sizeof text, "%F", std::localtime(&now));
  return text;
}
}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): an exception ends the program with its message
int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: tetwarp_bench_peers RESULTS.json [WORKLOAD]\n");
    return 2;
  }
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq") ||
      !__builtin_cpu_supports("avx512vl")) {
    std::fprintf(stderr, "floor and probe need a processor with AVX-512\n");
    return 2;
  }
  const std::string chosen = argc > 2 ? argv[2] : "";
  const int threads = processor_threads();
  const std::string processor = available_backends()[1].device;
  nlohmann::json results = {
      {"date", today()},
      {"processor", processor},
      {"threads", threads},
      {"pixels", "float32"},
      {"filter", "linear"},
      {"unit", "ms"},
      {"rows", nlohmann::json::array()},
      {"note",
       "three rounds of floor and tetwarp in turn (medians of 5 and 9 steps each), then "
       "the others (median of 5 steps, one where a step takes over 5 s)"}};
  for (const Workload& workload : {torso_700(), rotated(256), rotated(384), waved(256, 5000),
                                   waved(256, 50000), waved(256, 500000), fish_35()}) {
    if (workload.name.find(chosen) == std::string::npos) continue;
    results["rows"].push_back(Row(workload, threads).measure());
    std::printf("%s\n", results["rows"].back().dump().c_str());
    std::fflush(stdout);
    std::ofstream(argv[1]) << results.dump(1) << '\n';
  }
  return 0;
}
