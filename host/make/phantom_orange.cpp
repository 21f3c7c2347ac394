/// @file phantom_orange.cpp
/// An orange: rind, flesh in segments, seeds.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tetwarp/make.hpp>

#include "host/base/parallel.hpp"

namespace tetwarp {
namespace {
constexpr double fill = 0.95;        // of the grid, along each axis
constexpr double rind_start = 0.85;  // r^2
constexpr double rind_level = 0.14;  // where the rind starts
constexpr double skirt = 0.06;       // r^2 over which values outside fall to 0
constexpr int segment_count = 10;    // around k
constexpr double wall = 0.012;       // half thickness, in radii
constexpr double core = 0.07;        // radius of the core, in radii
constexpr double lowest_flesh = 0.15;
constexpr double seed_level = 1.0;
constexpr Point3 seed_middle{0.30, 0, 0};  // of each segment: outwards, around, along k
constexpr Point3 seed_radii{0.035, 0.03, 0.09};

/// @param p  in radii of the orange, from its center
double orange_at(const Point3& p) {
  const double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
  if (square > rind_start) {
    const double fall = rind_level - orange_phantom_threshold;
    if (square <= 1) return rind_level - fall * (square - rind_start) / (1 - rind_start);
    return std::max(0.0, orange_phantom_threshold * (1 - (square - 1) / skirt));
  }
  // The middle of the nearest segment is at angle 0, its walls are at +-turn / 2.
  const double turn = 2 * std::numbers::pi / segment_count;
  const double angle = std::remainder(std::atan2(p[1], p[0]), turn);
  const double radius = std::hypot(p[0], p[1]);
  const double from_wall = radius * std::sin(turn / 2 - std::abs(angle));
  const Point3 seed{(radius * std::cos(angle) - seed_middle[0]) / seed_radii[0],
                    radius * std::sin(angle) / seed_radii[1], p[2] / seed_radii[2]};
  if (seed[0] * seed[0] + seed[1] * seed[1] + seed[2] * seed[2] < 1) return seed_level;
  const double flesh = 1 - square;
  const bool is_wall = radius < core || from_wall < wall;
  return std::max(lowest_flesh, is_wall ? 0.6 * flesh : flesh);
}
}  // namespace

Volume make_orange_phantom(const std::array<std::int64_t, 3>& dims, const Point3& spacing) {
  Grid grid;
  grid.dims = dims;
  grid.spacing = spacing;
  Volume volume = make_volume(grid, PixelType::float32, 1, "orange");
  float* const samples = volume.samples<float>().data();
  const auto place = [&](std::size_t axis, std::int64_t index) {
    const auto count = static_cast<double>(dims[axis]);
    return (static_cast<double>(2 * index + 1) - count) / (fill * count);
  };
  parallel_tasks(thread_count(0), dims[2], [&](std::int64_t k) {
    float* sample = samples + k * dims[0] * dims[1];
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i) {
        *sample++ = static_cast<float>(orange_at({place(0, i), place(1, j), place(2, k)}));
      }
    }
  });
  return volume;
}

}  // namespace tetwarp
