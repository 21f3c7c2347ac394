#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <tetwarp/map_points.hpp>
#include <utility>
#include <vector>

#include "bench/warp/rows.hpp"
#include "bench/warp/warp_job.hpp"
#include "host/base/point3.hpp"

namespace tetwarp::bench {
namespace {
/// Points that fill the box of the nodes, in no order.
std::vector<Point3> points_in(const Mesh& mesh, std::int64_t count) {
  constexpr std::uint64_t seed = 49;
  const Bounds box = bounds_of(mesh.rest_positions);
  std::vector<Point3> points(static_cast<std::size_t>(count));
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double share = scenes::uniform(seed, 3 * p + axis);
      points[p][axis] = box.low[axis] + share * (box.high[axis] - box.low[axis]);
    }
  }
  return points;
}

double largest_difference(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double largest = 0;
  for (std::size_t p = 0; p < a.size(); ++p) largest = std::max(largest, norm(minus(a[p], b[p])));
  return largest;
}

void run(benchmark::State& state, const Workload& workload, std::int64_t count, int threads) {
  const scenes::Scene& scene = inputs().scene(workload);
  const std::vector<Point3> start = points_in(scene.mesh, count);
  std::vector<Point3> points = start;
  std::int64_t outside = 0;
  const std::function<void()> round_trip = [&] {
    for (const bool inverse : {false, true}) {
      MappedPoints moved =
          map_points(scene.mesh, scene.deformed, std::move(points),
                     {.inverse = inverse, .backend = Backend::cpu, .threads = threads});
      points = std::move(moved.points);
      outside += moved.outside;
    }
  };
  round_trip();
  const double error = largest_difference(points, start);
  if (outside > 0 || !(error < 1e-9)) {
    return refuse(state, fmt::format("{} points in no tetrahedron, {:.2g} off where they began",
                                     outside, error));
  }
  const Timing timing =
      time_in_turn(std::span(&round_trip, 1), protocol_for(Backend::cpu, threads)).front();
  count_timing(state, timing);
  const auto moves = static_cast<double>(2 * count);
  state.counters["max_error"] = error;
  state.counters["points_per_second"] = moves / timing.median;
  state.counters["processor_ns"] = 1e9 * timing.processor / moves;
}
}  // namespace

void add_point_rows(const Selection& selection) {
  for (const Workload& workload : {torso_700(), waved(256, 50000)}) {
    for (const std::int64_t count : {1'000'000, 10'000'000}) {
      if (!selection.is_full() && (count > 1'000'000 || workload.tet_count() > 5000)) continue;
      for (const int threads : std::set{1, selection.threads}) {
        add_row(
            fmt::format("points/{}/{}/{}", workload.name, count, place_of(Backend::cpu, threads)),
            [=](benchmark::State& state) { run(state, workload, count, threads); });
      }
    }
  }
}

}  // namespace tetwarp::bench
