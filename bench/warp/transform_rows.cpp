#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <set>
#include <string>
#include <tetwarp/resample.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "bench/measure/floors.hpp"
#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"
#include "host/base/point3.hpp"

namespace tetwarp::bench {
namespace {
using Links = std::vector<SingleTransform>;

/// Voxels of unit spacing around the origin.
Grid centered(std::int64_t n) {
  Grid grid;
  grid.dims = {n, n, n};
  grid.origin.fill(-0.5 * static_cast<double>(n - 1));
  return grid;
}

/// Of n^3 voxels as large as those of centered(), turned about two axes [radian].
Grid turned(std::int64_t n, double about_z, double about_x) {
  Grid grid = centered(n);
  const double c = std::cos(about_z), s = std::sin(about_z), d = std::cos(about_x),
               t = std::sin(about_x);
  grid.direction = {c, -s, 0, d * s, d * c, -t, t * s, t * c, d};
  grid.origin = {0, 0, 0};
  const double middle = 0.5 * static_cast<double>(n - 1);
  grid.origin = times(-1, grid.world_of({middle, middle, middle}));
  return grid;
}

/// The same place with voxels of another size.
Grid spaced(std::int64_t n, double spacing) {
  const auto count = static_cast<std::int64_t>(std::ceil(static_cast<double>(n) / spacing));
  Grid grid = centered(count);
  grid.spacing.fill(spacing);
  for (double& x : grid.origin) x *= spacing;
  return grid;
}

/// The position of voxel v of a grid.
Point3 place_in(const Grid& grid, std::int64_t v) {
  const auto& dims = grid.dims;
  return grid.world_of({static_cast<double>(v % dims[0]),
                        static_cast<double>(v / dims[0] % dims[1]),
                        static_cast<double>(v / dims[0] / dims[1])});
}

/// Waves of three voxels that span an image of n^3.
DisplacementField waves(const Grid& grid, std::int64_t n) {
  DisplacementField field{grid, {}};
  const double turn = 2 * std::numbers::pi / static_cast<double>(n);
  for (std::int64_t v = 0; v < grid.voxel_count(); ++v) {
    const Point3 x = place_in(grid, v);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      field.displacement.push_back(static_cast<float>(3 * std::sin(turn * x[(axis + 1) % 3])));
    }
  }
  return field;
}

AffineTransform turn(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {.matrix = {c, -s, 0, s, c, 0, 0, 0, 1}, .offset = {1.3, -0.7, 0.4}};
}

/// A transform by name.
struct Case {
  const char* name;
  std::function<Links(std::int64_t n)> links;
};

const std::array cases{
    Case{"field", [](std::int64_t n) { return Links{waves(centered(n), n)}; }},
    Case{"field_coarser_3", [](std::int64_t n) { return Links{waves(spaced(n, 3), n)}; }},
    Case{"field_finer_1.4", [](std::int64_t n) { return Links{waves(spaced(n, 1 / 1.4), n)}; }},
    Case{"field_turned", [](std::int64_t n) { return Links{waves(turned(n, 0.3, 0.2), n)}; }},
    Case{"affine,field",
         [](std::int64_t n) {
           return Links{turn(0.1), waves(centered(n), n)};
         }},
    Case{"field,affine",
         [](std::int64_t n) {
           return Links{waves(centered(n), n), turn(0.1)};
         }},
    Case{"field,field", [](std::int64_t n) {
           return Links{waves(centered(n), n), waves(centered(n), n)};
         }}};

double field_bytes(const Links& links) {
  double bytes = 0;
  for (const SingleTransform& link : links) {
    if (const auto* const field = std::get_if<DisplacementField>(&link)) {
      bytes += static_cast<double>(sizeof(float) * field->displacement.size());
    }
  }
  return bytes;
}

/// The largest difference of some voxels from linear samples in float64.
double largest_error(const Volume& source, const Transform& transform, const Volume& output) {
  const std::int64_t n = source.grid.dims[0];
  std::vector<std::int64_t> voxels;
  for (std::int64_t v = 0; v < output.grid.voxel_count(); v += 61) voxels.push_back(v);
  std::vector<Point3> points;
  for (const std::int64_t v : voxels) points.push_back(place_in(output.grid, v));
  points = transformed(transform, std::move(points));
  double largest = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    double sample = 0;
    const Point3 index = minus(points[p], source.grid.origin);
    const bool is_inside = std::ranges::all_of(
        index, [&](double x) { return x > 0 && x < static_cast<double>(n - 1); });
    if (!is_inside) continue;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::array<std::int64_t, 3> at{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double lower = std::floor(index[axis]), part = index[axis] - lower;
        const bool is_upper = (corner >> axis & 1) != 0;
        weight *= is_upper ? part : 1 - part;
        at[axis] = static_cast<std::int64_t>(lower) + (is_upper ? 1 : 0);
      }
      if (weight == 0) continue;
      const auto place = static_cast<std::size_t>(at[0] + n * (at[1] + n * at[2]));
      sample += weight * static_cast<double>(source.samples<float>()[place]);
    }
    const auto found = output.samples<float>()[static_cast<std::size_t>(voxels[p])];
    largest = std::max(largest, std::abs(static_cast<double>(found) - sample));
  }
  return largest;
}

void run(benchmark::State& state, const Case& chosen, std::int64_t n, int threads) {
  Volume source = make_volume(centered(n), PixelType::float32, 1);
  for (std::int64_t v = 0; v < source.grid.voxel_count(); ++v) {
    source.samples<float>()[static_cast<std::size_t>(v)] =
        static_cast<float>(scenes::uniform(3, static_cast<std::uint64_t>(v)));
  }
  const Links links = chosen.links(n);
  const Transform transform = TransformChain{links}, affine = turn(0.1);
  const ResampleOptions options{.threads = threads};
  const VolumeView view(source);
  Volume output = make_volume(source.grid, source.type, 1);
  void* const data = output.data.data();
  const auto resampled_by = [&](const Transform& by) {
    resample(std::span(&view, 1), by, options, std::span(&data, 1));
  };
  resampled_by(transform);
  const double error = largest_error(source, transform, output);
  if (!(error < 1e-4)) return refuse(state, fmt::format("a sample is {:.2g} off", error));

  const std::function<void()> jobs[] = {[&] { resampled_by(transform); },
                                        [&] { resampled_by(affine); }};
  const std::vector<Timing> timings = time_in_turn(jobs, protocol_for(Backend::cpu, threads));
  count_timing(state, timings[0]);
  static const double read_rate = copy_bandwidth(1);
  const auto voxels = static_cast<double>(source.grid.voxel_count());
  const double ns = 1e9 * timings[0].processor / voxels,
               affine_ns = 1e9 * timings[1].processor / voxels,
               read_ns = 1e9 * field_bytes(links) / read_rate / voxels;
  state.counters["processor_ns"] = ns;
  state.counters["affine_ns"] = affine_ns;
  state.counters["read_ns"] = read_ns;
  state.counters["bound_share"] = ns / (1.5 * affine_ns + read_ns);
  state.counters["max_error"] = error;
}
}  // namespace

void add_transform_rows(const Selection& selection) {
  for (const std::int64_t n : {128, 256}) {
    if (n == 256 && !selection.is_full()) continue;
    for (const Case& chosen : cases) {
      for (const int threads : std::set{1, selection.threads}) {
        if (threads > 1 && !selection.is_full()) continue;
        add_row(fmt::format("resample/{}/{}/{}", n, chosen.name, place_of(Backend::cpu, threads)),
                [=, &chosen](benchmark::State& state) { run(state, chosen, n, threads); });
      }
    }
  }
}

}  // namespace tetwarp::bench
