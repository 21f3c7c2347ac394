/// @file analytic.cpp
#include "bench/analytic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "bench/floors.hpp"
#include "bench/inputs.hpp"
#include "bench/measure.hpp"
#include "bench/truth.hpp"
#include "host/base/pixel_dispatch.hpp"

namespace tetwarp::bench {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double waves[3] = {3, 2, 4};  ///< per volume

/// The image at x [voxel of a grid of n per axis], between 0.1 and 0.9.
double image_at(const Point3& x, double n) {
  double phase[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    phase[axis] = 2 * pi * waves[axis] * (x[axis] + 0.5) / n;
  }
  return 0.5 + 0.2 * std::sin(phase[0]) * std::cos(phase[1]) + 0.2 * std::sin(phase[2]);
}

/// The largest error of a wave of height 1 that turns by `slope` from voxel to voxel: slope / 2 for
/// the nearest sample, slope^2 / 8 between linear neighbours; for the others the leading terms of
/// sum w_i exp(j slope (i - t)) - 1, rounded up.
double wave_bound(Filter filter, double slope) {
  switch (filter) {
    case Filter::nearest:
      return slope / 2;
    case Filter::linear:
      return slope * slope / 8;
    case Filter::cubic:
      return std::pow(slope, 3) / 60 + std::pow(slope, 4) / 40;
    case Filter::bspline:
      return std::pow(slope, 4) / 300;
    default:
      return slope / 50;
  }
}

/// Largest sum of |weights| along an axis: half a unit that a sample was rounded by can come out
/// this much larger, to the third power.
double amplification(Filter filter) {
  switch (filter) {
    case Filter::cubic:
      return 1.25;
    case Filter::bspline:
    case Filter::lanczos:
      return 1.55;
    default:
      return 1;
  }
}

/// What interpolation of image_at() can be off by at most.
double interpolation_bound(Filter filter, double n) {
  double bound = 0;
  for (const double count : waves) bound += 0.2 * wave_bound(filter, 2 * pi * count / n);
  return bound;
}

Buffer analytic_source(const Grid& grid, PixelType type) {
  Buffer buffer(static_cast<std::size_t>(grid.voxel_count()) * size_of(type));
  const auto n = static_cast<double>(grid.dims[0]);
  with_pixel_type(type, [&]<class T>(T) {
    T* const samples = reinterpret_cast<T*>(buffer.data());
#pragma omp parallel for schedule(static)
    for (std::int64_t at = 0; at < grid.voxel_count(); ++at) {
      const Point3 x{static_cast<double>(at % grid.dims[0]),
                     static_cast<double>(at / grid.dims[0] % grid.dims[1]),
                     static_cast<double>(at / (grid.dims[0] * grid.dims[1]))};
      const double value = range_of(type) * image_at(x, n);
      samples[at] = static_cast<T>(is_integer(type) ? std::nearbyint(value) : value);
    }
  });
  return buffer;
}

/// Largest and mean error, collected slice by slice so that the sum has one order.
struct Errors {
  double max = 0;
  double squares = 0;
  double count = 0;

  void add(double error) {
    max = std::max(max, error);
    squares += error * error;
    count += 1;
  }
  void add(const Errors& other) {
    max = std::max(max, other.max);
    squares += other.squares;
    count += other.count;
  }
  double rms() const { return std::sqrt(squares / std::max(count, 1.0)); }
};

/// Over the voxels whose source position lies between the outermost samples, and as far within as
/// `margin` [voxel].
Errors interpolation_errors(const scenes::Scene& scene,
                            PixelType type,
                            double margin,
                            const std::byte* output) {
  const Grid& grid = scene.output_grid;
  const AffineRows map = turned_about_middle(scene.source_grid, grid, pi / 4);
  const auto n = static_cast<double>(scene.source_grid.dims[0]);
  std::vector<Errors> slices(static_cast<std::size_t>(grid.dims[2]));
  with_pixel_type(type, [&]<class T>(T) {
    const T* const values = reinterpret_cast<const T*>(output);
#pragma omp parallel for schedule(dynamic)
    for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
      Errors& slice = slices[static_cast<std::size_t>(k)];
      for (std::int64_t row = 0; row < grid.dims[0] * grid.dims[1]; ++row) {
        Point3 x;
        bool is_inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          x[axis] = map[axis][0] * static_cast<double>(row % grid.dims[0]) +
                    map[axis][1] * static_cast<double>(row / grid.dims[0]) +
                    map[axis][2] * static_cast<double>(k) + map[axis][3];
          is_inside = is_inside && x[axis] >= margin && x[axis] <= n - 1 - margin;
        }
        if (!is_inside) continue;
        const T value = values[k * grid.dims[0] * grid.dims[1] + row];
        slice.add(error_between(static_cast<double>(value) / range_of(type), image_at(x, n)));
      }
    }
  });
  Errors sum;
  for (const Errors& slice : slices) sum.add(slice);
  return sum;
}

void run_interpolation(
    benchmark::State& state, std::int64_t n, Filter filter, PixelType type, int threads) {
  const Workload workload = rotated(n);
  const scenes::Scene& scene = inputs().scene(workload);
  const Buffer samples = analytic_source(scene.source_grid, type);
  const VolumeView source{scene.source_grid, type, 1, samples.data(), Memory::host};
  const auto voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
  const Buffer output(voxels * size_of(type));
  void* const out = output.data();
  Warper warper(std::span(&source, 1), scene.mesh,
                {.filter = filter,
                 .output_grid = scene.output_grid,
                 .backend = Backend::cpu,
                 .threads = threads});
  StepReport report;
  const std::function<void()> step = [&] {
    report = warper.step(scene.deformed, {.volumes = std::span(&out, 1)});
  };
  step();  // first touch
  // The image does not go on beyond the rim as wider filters have it.
  const double margin = filter > Filter::linear ? static_cast<double>(n) / 4 : 0;
  const Errors errors = interpolation_errors(scene, type, margin, output.data());
  const double rounding = 0.5 * std::pow(amplification(filter), 3) + 0.5;  // of samples, of results
  const double bound = interpolation_bound(filter, static_cast<double>(n)) + 1e-5 +
                       (is_integer(type) ? rounding / range_of(type) : 0);
  if (!(errors.count > 0 && errors.max <= bound)) {
    refuse(state,
           fmt::format("interpolation error {:.2g}, at most {:.2g} is right", errors.max, bound));
    return;
  }
  const Timing timing =
      time_in_turn(std::span(&step, 1), {.busy_threads = static_cast<double>(threads)}).front();
  count_timing(state, timing);
  state.counters["n"] = static_cast<double>(n);
  state.counters["max_error"] = errors.max;
  state.counters["rms_error"] = errors.rms();
  state.counters["ns_per_covered"] =
      1e9 * timing.median / static_cast<double>(report.counts.covered);
}

/// Samples that alternate between 0 and 1 along one axis.
Buffer alternating(const Grid& grid, PixelType type, std::size_t axis) {
  Buffer buffer(static_cast<std::size_t>(grid.voxel_count()) * size_of(type));
  const std::int64_t stride = axis == 0   ? 1
                              : axis == 1 ? grid.dims[0]
                                          : grid.dims[0] * grid.dims[1];
  with_pixel_type(type, [&]<class T>(T) {
    T* const samples = reinterpret_cast<T*>(buffer.data());
    for (std::int64_t at = 0; at < grid.voxel_count(); ++at) {
      samples[at] = static_cast<T>(at / stride % grid.dims[axis] & 1);
    }
  });
  return buffer;
}

/// The triangle wave through the samples of alternating().
double triangle_at(double x) {
  const double phase = x - 2 * std::floor(x / 2);
  return 1 - std::abs(phase - 1);
}

void run_position(benchmark::State& state, const Workload& workload, PixelType type, int threads) {
  const scenes::Scene& scene = inputs().scene(workload);
  const Truth& truth = inputs().truth(workload);
  const auto voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
  const auto tet = std::make_unique_for_overwrite<std::int32_t[]>(voxels);
  const Buffer output(voxels * size_of(type));
  void* const out = output.data();
  Errors errors;
  Accuracy accuracy;
  double seconds = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Buffer samples = alternating(scene.source_grid, type, axis);
    const VolumeView source{scene.source_grid, type, 1, samples.data(), Memory::host};
    Warper warper(std::span(&source, 1), scene.mesh,
                  {.output_grid = scene.output_grid, .backend = Backend::cpu, .threads = threads});
    seconds += seconds_of(
        [&] { warper.step(scene.deformed, {.volumes = std::span(&out, 1), .owner = tet.get()}); });
    accuracy = compare(truth, source, Filter::linear, out, tet.get());
    const double last = static_cast<double>(scene.source_grid.dims[axis] - 1);
    with_pixel_type(type, [&]<class T>(T) {
      for (std::size_t v = 0; v < truth.voxels.size(); ++v) {
        if (truth.owners[v] < 0) continue;
        const auto value = static_cast<double>(static_cast<const T*>(out)[truth.voxels[v]]);
        const double x = std::clamp(truth.positions[v][axis], 0.0, last);
        errors.add(error_between(value, triangle_at(x)));
      }
    });
  }
  const double bound = type == PixelType::float64 ? 1e-9 : 1e-5;
  const bool covers = accuracy.holes + accuracy.painted + accuracy.doubles == 0;
  if (!covers || !(errors.count > 0 && errors.max <= bound)) {
    refuse(state, fmt::format("position error {:.2g} voxel, {} holes, {} painted, {} doubles",
                              errors.max, accuracy.holes, accuracy.painted, accuracy.doubles));
    return;
  }
  for (auto _ : state) state.SetIterationTime(seconds / 3);
  state.counters["position_max"] = errors.max;
  state.counters["position_rms"] = errors.rms();
  state.counters["compared"] = static_cast<double>(accuracy.compared);
  state.counters["holes"] = static_cast<double>(accuracy.holes);
  state.counters["painted"] = static_cast<double>(accuracy.painted);
  state.counters["doubles"] = static_cast<double>(accuracy.doubles);
}

void register_one(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_analytic_rows(Extent extent, int threads) {
  const bool full = extent == Extent::full;
  for (const std::int64_t n : {32, 64, 128, 256}) {
    if (n == 256 && !full) continue;
    for (const Filter filter :
         {Filter::nearest, Filter::linear, Filter::cubic, Filter::bspline, Filter::lanczos}) {
      for (const PixelType type :
           {PixelType::uint8, PixelType::int16, PixelType::float32, PixelType::float64}) {
        const bool is_narrow = type == PixelType::uint8 || type == PixelType::int16;
        if (!full && is_narrow && filter > Filter::linear) continue;
        const std::string name = "analytic/" + std::to_string(n) + "/" + name_of(filter) + "/" +
                                 name_of(type) + "/cpu/threads:" + std::to_string(threads);
        register_one(name, [=](benchmark::State& state) {
          run_interpolation(state, n, filter, type, threads);
        });
      }
    }
  }
  std::vector<Workload> workloads = {torso_700(), waved(256, 500000)};
  if (full) {
    workloads.insert(workloads.end(),
                     {ties_128(), rotated(256), fish_35(), waved(256, 5000), waved(256, 50000)});
  }
  for (const Workload& workload : workloads) {
    for (const PixelType type : {PixelType::float32, PixelType::float64}) {
      register_one("position/" + workload.name + "/" + name_of(type) + "/cpu",
                   [=](benchmark::State& state) { run_position(state, workload, type, threads); });
    }
  }
}

}  // namespace tetwarp::bench
