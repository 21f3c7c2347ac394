#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "bench/measure/floors.hpp"
#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"
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

/// The largest error of a wave of height 1 whose phase grows by `slope` per voxel: slope / 2 for
/// the nearest sample, slope^2 / 8 between linear neighbors; for the others the leading terms of
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

/// Largest sum of |weights| along an axis. Rounding a sample by half a unit can change the result
/// by this factor to the third power.
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

/// Largest error of interpolating image_at().
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
      const double value = range_of(type) * image_at(position_of(at, grid), n);
      samples[at] = static_cast<T>(is_integer(type) ? std::nearbyint(value) : value);
    }
  });
  return buffer;
}

/// Largest and RMS error, collected slice by slice, so that the sum does not depend on threads.
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

/// Errors over the voxels whose source position lies at least `margin` [voxel] inside the outermost
/// samples.
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
        const std::int64_t voxel = k * grid.dims[0] * grid.dims[1] + row;
        const Point3 x = mapped(map, position_of(voxel, grid));
        const auto [low, high] = std::minmax({x[0], x[1], x[2]});
        if (low < margin || high > n - 1 - margin) continue;
        const T value = values[voxel];
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
  WarpJob job(scene, source, {.filter = filter, .backend = Backend::cpu, .threads = threads});
  const std::function<void()> step = [&] { job.step(); };
  step();  // first touch
  // Filters wider than linear continue the image beyond the rim in another way.
  const double margin = filter > Filter::linear ? static_cast<double>(n) / 4 : 0;
  const Errors errors = interpolation_errors(scene, type, margin, job.output());
  const double rounding = 0.5 * std::pow(amplification(filter), 3) + 0.5;  // of samples, of results
  const double bound = interpolation_bound(filter, static_cast<double>(n)) + 1e-5 +
                       (is_integer(type) ? rounding / range_of(type) : 0);
  if (!(errors.count > 0 && errors.max <= bound)) {
    return refuse(state, fmt::format("interpolation error {:.2g}, at most {:.2g} is right",
                                     errors.max, bound));
  }
  const Timing timing =
      time_in_turn(std::span(&step, 1), protocol_for(Backend::cpu, threads)).front();
  count_timing(state, timing);
  state.counters["n"] = static_cast<double>(n);
  state.counters["max_error"] = errors.max;
  state.counters["rms_error"] = errors.rms();
  state.counters["ns_per_covered"] = 1e9 * timing.median / static_cast<double>(job.covered());
}
}  // namespace

void add_analytic_rows(const Selection& selection) {
  const bool full = selection.is_full();
  const int threads = selection.threads;
  for (const std::int64_t n : {32, 64, 128, 256}) {
    if (n == 256 && !full) continue;
    for (const Filter filter :
         {Filter::nearest, Filter::linear, Filter::cubic, Filter::bspline, Filter::lanczos}) {
      for (const PixelType type :
           {PixelType::uint8, PixelType::int16, PixelType::float32, PixelType::float64}) {
        if (!full && is_integer(type) && filter > Filter::linear) continue;
        add_row(
            "analytic/" + std::to_string(n) + "/" + name_of(filter) + "/" + name_of(type) + "/" +
                place_of(Backend::cpu, threads),
            [=](benchmark::State& state) { run_interpolation(state, n, filter, type, threads); });
      }
    }
  }
}

}  // namespace tetwarp::bench
